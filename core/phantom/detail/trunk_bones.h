#pragma once

#include <vector>

#include "core/phantom/spine.h"

namespace spinaltap {

/// Adds the hip bones, with sockets around the heads of the thighs, and the thighs beside the sacrum. They are bones
/// without a level; the hip bones keep `rib_gap_mm` from the sacrum.
void add_pelvis(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::vector<SpinePart>& parts);

/// Adds the scapulae, upper arms, collarbones and breastbone, placed about T2. The scapulae keep off the ribs.
void add_shoulders(const SpineOptions& options, const std::vector<PlacedLevel>& placed, std::vector<SpinePart>& parts);

}  // namespace spinaltap
