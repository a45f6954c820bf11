#include "core/points/neighbour_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap {
namespace {

constexpr std::size_t kSampledPoints = 4096;

}  // namespace

NeighbourDistances neighbour_distances(const PointVolume& volume, bool in_plane) {
  const DiscPattern& pattern = volume.pattern();
  const int disc = volume.disc_count() / 2;
  const int first_disc = in_plane ? disc : std::max(0, disc - 1);
  const int last_disc = in_plane ? disc : std::min(volume.disc_count() - 1, disc + 1);
  const int rings = pattern.ring_count();
  const int inner = std::max(1, rings - 2);
  NeighbourDistances result;
  result.min_mm = std::numeric_limits<double>::infinity();
  double sum_mm = 0.0;
  double sum_squares = 0.0;
  const std::size_t count = DiscPattern::ring_start(inner);
  const std::size_t stride = 1 + count / kSampledPoints;
  for (std::size_t i = 0; i < count; i += stride) {
    const Vec3 p = volume.point_in_path_mm(disc, i);
    const int ring = DiscPattern::ring_of(i);
    // Neighbours lie at most two rings away, whatever the pattern and its jitter.
    const std::size_t begin = DiscPattern::ring_start(std::max(0, ring - 2));
    const std::size_t end = DiscPattern::ring_start(std::min(rings, ring + 3));
    double nearest = std::numeric_limits<double>::infinity();
    for (int other = first_disc; other <= last_disc; ++other) {
      for (std::size_t n = begin; n < end; ++n) {
        if (other == disc && n == i) continue;
        nearest = std::min(nearest, (volume.point_in_path_mm(other, n) - p).squaredNorm());
      }
    }
    if (!std::isfinite(nearest)) continue;  // a disc of one point
    const double distance_mm = std::sqrt(nearest);
    ++result.points;
    sum_mm += distance_mm;
    sum_squares += nearest;
    result.min_mm = std::min(result.min_mm, distance_mm);
    result.max_mm = std::max(result.max_mm, distance_mm);
  }
  if (result.points == 0) return {};
  const auto points = static_cast<double>(result.points);
  result.mean_mm = sum_mm / points;
  result.deviation_mm = std::sqrt(std::max(0.0, sum_squares / points - result.mean_mm * result.mean_mm));
  return result;
}

}  // namespace spinaltap
