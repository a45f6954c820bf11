#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/phantom/surface_seeds.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap::test {

struct DistanceFigures {
  double mean_mm = 0.0;
  double p99_mm = 0.0;
  double max_mm = 0.0;
};

inline DistanceFigures figures_of(std::vector<double> distances_mm) {
  DistanceFigures figures;
  for (double& value : distances_mm) {
    value = std::abs(value);
    figures.mean_mm += value / static_cast<double>(distances_mm.size());
  }
  std::sort(distances_mm.begin(), distances_mm.end());
  figures.p99_mm = distances_mm[(distances_mm.size() - 1) * 99 / 100];
  figures.max_mm = distances_mm.back();
  return figures;
}

/// Points on the zero set of a solid, about `spacing_mm` apart: its seeds, drawn onto it by Newton's method. Where that
/// does not arrive, a seed is left out.
inline std::vector<Vec3> true_surface_points(const Solid& solid, double spacing_mm, double tolerance_mm) {
  std::vector<Vec3> points_mm = surface_seeds(solid, spacing_mm);
  std::vector<double> values_mm(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    solid.evaluate(points_mm, values_mm, gradients);
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      points_mm[i] -= values_mm[i] * gradients[i] / std::max(gradients[i].squaredNorm(), 0.25);
    }
  }
  solid.evaluate(points_mm, values_mm, {});
  std::vector<Vec3> on_surface;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (std::abs(values_mm[i]) < tolerance_mm) on_surface.push_back(points_mm[i]);
  }
  return on_surface;
}

/// How far points lie from a baked bone's surface; beyond its band the distance counts as the band's width.
inline DistanceFigures distance_to_bone(const BoneModel& bone, const std::vector<Vec3>& points_mm) {
  std::vector<float> sampled(points_mm.size());
  bone.sample(points_mm, sampled, {});
  return figures_of({sampled.begin(), sampled.end()});
}

}  // namespace spinaltap::test
