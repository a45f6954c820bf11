#pragma once

#include <optional>

#include "core/ct/crop.h"

namespace spinaltap {

/// A CT of which a bone or a spine was kept, and all else set to one value, as masks are applied.
struct MaskedCt {
  /// As a spine is looked for in it: water where nothing was kept, and 20 mm of it around, but not above or below where
  /// the CT cuts what was kept: there it ends as the given one does.
  CtVolume ct;
  VoxelBlock original;  ///< the given CT's voxels in it
  BoneMask kept;        ///< on the given grid: the largest part that was kept, its hollows filled
  double kept_mm3 = 0.0;
  bool is_one = false;  ///< that part is nearly all that was kept, and of a vertebra's size
};

/// Nothing for a CT that was not masked: one value, 0 HU or air, fills at least half of a masked one, and of the other
/// voxels hardly any is air.
std::optional<MaskedCt> as_masked(const CtVolume& ct);

}  // namespace spinaltap
