#pragma once

#include <cmath>

#include "core/phantom/surface_seeds.h"
#include "core/phantom/vertebra.h"
#include "core/rbf/fit_rbf.h"
#include "core/surface/surface_points.h"

namespace spinaltap::test {

/// Points on the phantom vertebra's surface, at most about `spacing_mm` apart, with outward normals.
inline SurfacePoints vertebra_points(double spacing_mm) {
  const Vertebra vertebra;
  SurfacePoints surface;
  surface.positions_mm = surface_seeds(vertebra, spacing_mm);
  const std::size_t count = surface.positions_mm.size();
  std::vector<double> values_mm(count);
  surface.normals.resize(count);
  for (int step = 0; step < 6; ++step) {
    vertebra.evaluate(surface.positions_mm, values_mm, surface.normals);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& gradient = surface.normals[i];
      surface.positions_mm[i] -= values_mm[i] * gradient / std::max(gradient.squaredNorm(), 0.2);
    }
  }
  vertebra.evaluate(surface.positions_mm, values_mm, surface.normals);
  for (Vec3& normal : surface.normals) normal.normalize();
  return surface;
}

/// The same moved onto a CT's pixels and slices (0.35 mm, 1.25 mm), so that rows, columns and slices hold many points
/// with the same coordinates and some points fall together, each with two off-surface points: what a fit is given.
inline RbfValues vertebra_values(double spacing_mm) {
  const SurfacePoints surface = vertebra_points(spacing_mm);
  const Vec3 voxel_mm(0.35, 0.35, 1.25);
  RbfValues data;
  for (const double off_mm : {0.0, 1.0, -1.0}) {
    for (std::size_t i = 0; i < surface.positions_mm.size(); ++i) {
      const Vec3 steps = surface.positions_mm[i].cwiseQuotient(voxel_mm).array().round();
      data.points_mm.emplace_back(steps.cwiseProduct(voxel_mm) + off_mm * surface.normals[i]);
      data.values_mm.push_back(off_mm);
    }
  }
  return data;
}

}  // namespace spinaltap::test
