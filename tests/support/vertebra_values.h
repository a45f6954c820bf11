#pragma once

#include <algorithm>
#include <numeric>

#include "core/base/random.h"
#include "core/phantom/vertebra.h"
#include "core/rbf/fit_rbf.h"
#include "tests/support/surface_distance.h"

namespace spinaltap::test {

/// About `count` values of the phantom vertebra's distance: a third on its surface, spread evenly, and for each a point
/// 1 mm off it on either side.
inline RbfValues vertebra_values(std::size_t count) {
  const Vertebra vertebra;
  const std::vector<Vec3> all_mm = true_surface_points(vertebra, 0.5, 0.01);
  std::vector<std::size_t> order(all_mm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return mix_bits(a) < mix_bits(b); });
  order.resize(std::min(order.size(), count / 3));
  RbfValues data;
  for (const std::size_t i : order) data.points_mm.push_back(all_mm[i]);
  std::vector<double> values_mm(order.size());
  std::vector<Vec3> normals(order.size());
  vertebra.evaluate(data.points_mm, values_mm, normals);
  for (const double side : {1.0, -1.0}) {
    for (std::size_t i = 0; i < order.size(); ++i) {
      data.points_mm.emplace_back(data.points_mm[i] + side * normals[i].normalized());
    }
  }
  data.values_mm.resize(data.points_mm.size());
  vertebra.evaluate(data.points_mm, data.values_mm, {});
  return data;
}

}  // namespace spinaltap::test
