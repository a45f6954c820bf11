#pragma once

#include <span>
#include <vector>

#include "core/session/operator/straight_ways.h"
#include "core/tool/bit_ray.h"

namespace spinaltap {

/// What a bit took on a way along its own axis: the bit where it was deepest, lengthened backwards by the way. Throws
/// Error on a bad bit, and where the way is not along the axis.
BitBody swept_along(const DrillBit& bit, const BitWay& way);
/// Of many ways, in their order.
std::vector<BitBody> swept_along(const DrillBit& bit, std::span<const BitWay> ways);

}  // namespace spinaltap
