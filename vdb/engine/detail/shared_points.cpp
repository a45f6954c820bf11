#include "vdb/engine/detail/shared_points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/error.h"
#include "core/points/occupied_bits.h"

namespace spinaltap {
namespace {

/// The bone that a volume's points stand for.
class Reach {
 public:
  explicit Reach(const PointVolume& volume)
      : frame_(volume.frame()), is_hexagon_(volume.pattern().subdivision() == DiscSubdivision::hexagons) {
    const double spacing_mm = volume.pattern().spacing_mm();
    const double rows = volume.pattern().ring_count() - 0.5;
    // Hexagons' flats, and their rows, lie nearer than their corners.
    radius_mm_ = rows * spacing_mm * (is_hexagon_ ? 0.5 * std::numbers::sqrt3 : 1.0);
    first_mm_ = -0.5 * spacing_mm;
    last_mm_ = volume.disc_depth_mm(volume.disc_count() - 1) + 0.5 * spacing_mm;
  }

  bool holds(const Vec3& p_patient) const {
    const Vec3 p = frame_.to_path(p_patient);
    if (!(p.z() >= first_mm_ && p.z() <= last_mm_)) return false;
    if (!is_hexagon_) return p.x() * p.x() + p.y() * p.y() <= radius_mm_ * radius_mm_;
    // Corners at 0, 60, ... degrees, so flats at 30, 90 and 150.
    const double half_x = 0.5 * std::numbers::sqrt3 * p.x();
    const double half_y = 0.5 * p.y();
    return std::max({std::abs(p.y()), std::abs(half_x + half_y), std::abs(half_x - half_y)}) <= radius_mm_;
  }

 private:
  PathFrame frame_;
  bool is_hexagon_;
  double radius_mm_, first_mm_, last_mm_;
};

}  // namespace

std::size_t drop_shared_points(std::span<PointVolume* const> volumes) {
  std::size_t dropped = 0;
  std::vector<Reach> earlier;
  for (std::size_t n = 0; n < volumes.size(); ++n) {
    if (volumes[n] == nullptr || std::find(volumes.begin(), volumes.begin() + static_cast<std::ptrdiff_t>(n),
                                           volumes[n]) != volumes.begin() + static_cast<std::ptrdiff_t>(n)) {
      fail("shared points: expected different volumes, found none or the same again as number ", n + 1);
    }
    PointVolume& volume = *volumes[n];
    dropped += tbb::parallel_reduce(
        tbb::blocked_range<int>(0, earlier.empty() ? 0 : volume.disc_count()), std::size_t{0},
        [&](const tbb::blocked_range<int>& discs, std::size_t count) {
          for (int disc = discs.begin(); disc < discs.end(); ++disc) {
            visit_up(volume.occupancy_words(disc).data(), 0, volume.pattern().point_count(), [&](std::size_t index) {
              const Vec3 p = volume.frame().to_patient(volume.point_in_path_mm(disc, index));
              if (std::ranges::any_of(earlier, [&](const Reach& reach) { return reach.holds(p); })) {
                volume.set_occupied(disc, index, false);
                ++count;
              }
              return true;
            });
          }
          return count;
        },
        std::plus<>());
    earlier.emplace_back(volume);
  }
  return dropped;
}

}  // namespace spinaltap
