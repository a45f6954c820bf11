#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "core/segment/float_grid.h"
#include "core/surface/detail/edge_model.h"
#include "core/surface/detail/local_normals.h"
#include "core/surface/surface_points.h"

namespace spinaltap {
namespace {

constexpr double kSurfaceLevel = 0.5;

/// Gradient of the tri-linear grid at index coordinates, per mm, in patient LPS.
Vec3 gradient(const FloatGrid& grid, const Vec3& p_index) {
  Vec3 per_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 half = 0.5 * Vec3::Unit(axis);
    per_mm[axis] =
        (sample_clamped(grid, p_index + half) - sample_clamped(grid, p_index - half)) / grid.geometry.spacing_mm[axis];
  }
  return grid.geometry.directions * per_mm;
}

/// Moves every point along its normal to the bone's edge: by the median of what its neighbours within `radius_mm` ask
/// for, itself included. Noise in the CT moves single points, the edge moves them together, in and across slices.
/// No point moves further than `max_mm`: whoever drew the mask meant this bone.
void move_to_edges(SurfacePoints& surface, const FloatGrid& hu, double reach_mm, double max_mm, double radius_mm) {
  constexpr double kSameSide = 0.8;  // cosine; points of another side of a thin part face elsewhere
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::size_t count = surface.positions_mm.size();
  const double step_mm = 1.5 * reach_mm / EdgeProfile::kInside;
  std::vector<EdgeProfile> profiles(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    profiles[i] = sample_profile(hu, surface.positions_mm[i], surface.normals[i], step_mm);
  });
  const EdgeModel model = estimate_edge_model(profiles, hu.geometry, reach_mm);
  std::vector<double> offset_mm(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const std::optional<EdgeFit> fit = fit_edge(profiles[i], model, hu.geometry, reach_mm);
    offset_mm[i] = fit ? fit->offset_mm : kNone;
  });
  const PointGrid grid(surface.positions_mm, radius_mm);
  std::vector<Vec3> moved_mm(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    std::vector<double> asked_mm;
    grid.for_each_within(surface.positions_mm[i], radius_mm, [&](std::size_t near) {
      if (std::isnan(offset_mm[near]) || surface.normals[near].dot(surface.normals[i]) < kSameSide) return;
      asked_mm.push_back(offset_mm[near]);
    });
    moved_mm[i] = surface.positions_mm[i];
    if (asked_mm.empty()) return;
    const auto middle = asked_mm.begin() + static_cast<std::ptrdiff_t>(asked_mm.size() / 2);
    std::nth_element(asked_mm.begin(), middle, asked_mm.end());
    moved_mm[i] += std::clamp(*middle, -max_mm, max_mm) * surface.normals[i];
  });
  surface.normals = local_normals(moved_mm, surface.normals, radius_mm);
  surface.positions_mm = std::move(moved_mm);
}

}  // namespace

SurfacePoints extract_surface(const CtVolume& ct, const BoneMask& mask, const SurfaceOptions& options,
                              const Progress& progress) {
  if (mask.geometry.size != ct.geometry.size) fail("surface: expected the mask on the CT's grid, found another size");
  if (mask.geometry.origin_mm != ct.geometry.origin_mm || mask.geometry.spacing_mm != ct.geometry.spacing_mm ||
      mask.geometry.directions != ct.geometry.directions) {
    fail("surface: expected the mask on the CT's grid, found one that lies elsewhere");
  }
  if (!(options.smooth_mm >= 0.0 && options.smooth_mm <= 20.0)) {
    fail("surface: expected smoothing of 0 to 20 mm, found ", options.smooth_mm, " mm");
  }
  const VoxelBox box = mask_box(mask);
  if (box.empty()) fail("surface: the mask holds no voxel");
  const double largest_step_mm = ct.geometry.spacing_mm.maxCoeff();
  const double smooth_mm = options.smooth_mm > 0.0 ? options.smooth_mm : std::max(0.5, 0.7 * largest_step_mm);
  const double reach_mm = std::max(2.0, 1.5 * largest_step_mm);
  const VoxelBox work_box = grow_box(box, 3.0 * smooth_mm + 2.0 * reach_mm, ct.geometry);

  progress.report("surface points", 0.0);
  const FloatGrid smooth = gaussian_blur(crop_mask(mask, work_box), smooth_mm);
  const FloatGrid hu = crop_hu(ct, work_box);
  const auto& size = smooth.geometry.size;
  const Mat3 to_patient = smooth.geometry.index_to_patient_matrix();

  // One list a slice, joined in order: the same points at any thread count.
  std::vector<SurfacePoints> of_slice(static_cast<std::size_t>(size[2]));
  ProgressCounter counter(progress, "surface points", of_slice.size());
  tbb::parallel_for(0, size[2], [&](int k) {
    SurfacePoints& points = of_slice[static_cast<std::size_t>(k)];
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const double here = smooth.at(i, j, k);
        for (int axis = 0; axis < 3; ++axis) {
          const std::array<int, 3> next{i + (axis == 0), j + (axis == 1), k + (axis == 2)};
          if (next[static_cast<std::size_t>(axis)] >= size[static_cast<std::size_t>(axis)]) continue;
          const double there = smooth.at(next[0], next[1], next[2]);
          if ((here < kSurfaceLevel) == (there < kSurfaceLevel)) continue;
          const double t = (kSurfaceLevel - here) / (there - here);
          const Vec3 p_index = Vec3(i, j, k) + t * Vec3::Unit(axis);
          const Vec3 inward = gradient(smooth, p_index);
          if (!(inward.norm() > 1e-6)) continue;
          const Vec3 normal = -inward.normalized();
          const Vec3 p_mm = smooth.geometry.origin_mm + to_patient * p_index;
          points.positions_mm.push_back(p_mm);
          points.normals.push_back(normal);
        }
      }
    }
    counter.add();
  });
  SurfacePoints all;
  for (const SurfacePoints& points : of_slice) {
    all.positions_mm.insert(all.positions_mm.end(), points.positions_mm.begin(), points.positions_mm.end());
    all.normals.insert(all.normals.end(), points.normals.begin(), points.normals.end());
  }
  if (all.positions_mm.empty()) fail("surface: the smoothed mask has no surface; is the bone thinner than a voxel?");
  if (options.refine_by_hu)
    move_to_edges(all, hu, reach_mm, std::max(1.0, 0.8 * largest_step_mm), std::max(1.0, 2.0 * largest_step_mm));
  return all;
}

}  // namespace spinaltap
