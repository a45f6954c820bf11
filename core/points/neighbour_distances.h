#pragma once

#include <cstddef>

#include "core/points/point_volume.h"

namespace spinaltap {

/// How evenly points lie: the distances from points to their nearest neighbours, mm.
struct NeighbourDistances {
  std::size_t points = 0;
  double min_mm = 0.0;
  double mean_mm = 0.0;
  double deviation_mm = 0.0;  ///< standard
  double max_mm = 0.0;
};

/// Of all points of a disc half-way along the volume, but those of its outermost two rings, whose neighbours lie
/// beyond; with the discs before and after where there are any. The paper's section 6.4 left this unanalysed.
/// `in_plane`: among the disc's own points only.
NeighbourDistances neighbour_distances(const PointVolume& volume, bool in_plane);

}  // namespace spinaltap
