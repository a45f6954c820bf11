#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/base/point_grid.h"
#include "core/base/scalar_field.h"

namespace spinaltap::test {

/// How far surface points lie from a true surface, mm.
struct PointError {
  double mean_mm = 0.0;  ///< of the absolute distances
  double p99_mm = 0.0;
  double max_mm = 0.0;
  double bias_mm = 0.0;                ///< mean of the signed distances
  double inter_slice_jitter_mm = 0.0;  ///< root mean square change of the signed distance from a point to the nearest
                                       ///< one in the next slice: what makes a surface wiggle from slice to slice
};

inline PointError point_error(std::span<const Vec3> points_mm, const ScalarField& ground_truth, double slice_step_mm) {
  PointError error;
  std::vector<double> values_mm(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  ground_truth.evaluate(points_mm, values_mm, gradients);
  std::vector<double> distance_mm;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    values_mm[i] /= std::max(gradients[i].norm(), 0.25);
    distance_mm.push_back(std::abs(values_mm[i]));
    error.mean_mm += distance_mm.back() / static_cast<double>(points_mm.size());
    error.bias_mm += values_mm[i] / static_cast<double>(points_mm.size());
  }
  const PointGrid grid(points_mm, 2.0 * slice_step_mm);
  double squares_mm2 = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    double nearest_mm2 = INFINITY;
    std::size_t next = i;
    grid.for_each_within(points_mm[i], 2.0 * slice_step_mm, [&](std::size_t j) {
      const Vec3 way = points_mm[j] - points_mm[i];
      if (!(way.z() > 0.5 * slice_step_mm && way.z() < 1.5 * slice_step_mm)) return;
      const double across_mm2 = way.head<2>().squaredNorm();
      if (across_mm2 < nearest_mm2) nearest_mm2 = across_mm2, next = j;
    });
    if (next == i) continue;
    squares_mm2 += std::pow(values_mm[next] - values_mm[i], 2);
    ++pairs;
  }
  error.inter_slice_jitter_mm = pairs > 0 ? std::sqrt(squares_mm2 / static_cast<double>(pairs)) : 0.0;
  std::sort(distance_mm.begin(), distance_mm.end());
  error.p99_mm = distance_mm[(distance_mm.size() - 1) * 99 / 100];
  error.max_mm = distance_mm.back();
  return error;
}

}  // namespace spinaltap::test
