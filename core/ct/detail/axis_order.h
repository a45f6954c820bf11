#pragma once

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// The same voxels with i, j and k as near as they come to the patient's left, posterior and superior (LPS), and a
/// right-handed grid. Nothing is interpolated: axes change places or turn round.
CtVolume ordered_as_lps(const CtVolume& ct);

}  // namespace spinaltap
