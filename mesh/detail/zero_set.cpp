#include "mesh/detail/zero_set.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap::detail {
namespace {

constexpr std::size_t kBlock = 1024;
constexpr double kFlat = 0.05;  // of a distance's gradient: at ridges of the distance, and beyond a band

template <class Work>
void in_blocks(std::size_t count, const Work& work) {
  if (count <= kBlock) {
    work(0, count);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlock),
                    [&](const auto& range) { work(range.begin(), range.end()); });
}

}  // namespace

void ZeroSet::project(std::span<const Vec3> points_mm, std::span<const double> reach_mm,
                      std::span<Place> places) const {
  in_blocks(points_mm.size(), [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    std::vector<Vec3> at_mm(points_mm.begin() + static_cast<std::ptrdiff_t>(begin),
                            points_mm.begin() + static_cast<std::ptrdiff_t>(end));
    std::vector<double> values(count);
    std::vector<Vec3> gradients(count);
    constexpr int kSteps = 3;
    for (int step = 0;; ++step) {
      field_.evaluate(at_mm, values, gradients);
      if (step == kSteps) break;
      for (std::size_t i = 0; i < count; ++i) {
        const double slope_squared = gradients[i].squaredNorm();
        if (!(slope_squared > kFlat * kFlat)) continue;
        Vec3 move = -values[i] / slope_squared * gradients[i];
        const double longest = 0.5 * reach_mm[begin + i];
        if (move.squaredNorm() > longest * longest) move *= longest / move.norm();
        at_mm[i] += move;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      Place& place = places[begin + i];
      const double slope = gradients[i].norm();
      const double reach = reach_mm[begin + i];
      place.position_mm = at_mm[i];
      place.distance_mm = slope > kFlat ? values[i] / slope : values[i];
      place.normal = slope > kFlat ? Vec3(gradients[i] / slope) : Vec3::Zero();
      place.found = slope > kFlat && (at_mm[i] - points_mm[begin + i]).squaredNorm() <= reach * reach;
    }
  });
}

std::vector<double> ZeroSet::distances_mm(std::span<const Vec3> points_mm) const {
  std::vector<double> distances(points_mm.size());
  in_blocks(points_mm.size(), [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    std::vector<Vec3> gradients(count);
    const std::span<double> values(distances.data() + begin, count);
    field_.evaluate(points_mm.subspan(begin, count), values, gradients);
    for (std::size_t i = 0; i < count; ++i) {
      // Near a ridge of the distance the gradient is small though the value is the distance.
      const double slope = gradients[i].norm();
      if (slope > 0.5) values[i] /= slope;
    }
  });
  return distances;
}

}  // namespace spinaltap::detail
