#pragma once

#include <cstddef>
#include <span>

#include "core/points/point_volume.h"

namespace spinaltap {

/// Makes overlapping volumes one set of points in which no bone counts twice: kills every point of a later volume that
/// lies in an earlier one's cylinder, which reaches half a spacing beyond its outer rings and its first and last disc
/// (a prism with hexagons). Returns how many points it killed; a second call kills none.
/// Throws Error on a volume that is null or given twice.
std::size_t drop_shared_points(std::span<PointVolume* const> volumes);

}  // namespace spinaltap
