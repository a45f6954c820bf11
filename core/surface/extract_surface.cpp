#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/segment/float_grid.h"
#include "core/surface/point_grid.h"
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

/// Finds how far along its normal a point lies from where the CT number is halfway between the tissue outside and the
/// peak of the cortex.
class EdgeFinder {
 public:
  EdgeFinder(const FloatGrid& hu, double reach_mm) : hu_(hu), reach_mm_(reach_mm) {}

  /// mm, at most `reach_mm` either way; NaN where there is no such edge.
  double offset_mm(const Vec3& p_mm, const Vec3& normal) const {
    constexpr int kSamples = 61;
    constexpr double kLowestContrastHu = 100.0;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const double span_mm = 3.0 * reach_mm_;
    std::array<double, kSamples> profile{};
    const auto way_mm = [&](std::ptrdiff_t i) {
      return span_mm * (2.0 * static_cast<double>(i) / (kSamples - 1) - 1.0);
    };
    for (int i = 0; i < kSamples; ++i) {
      profile[static_cast<std::size_t>(i)] = sample_clamped(hu_, hu_.geometry.to_index(p_mm + way_mm(i) * normal));
    }
    // The cortex peaks within reach of the mask's surface or further in; the tissue outside is lowest further out.
    const auto peak = std::max_element(profile.begin(), profile.begin() + 3 * kSamples / 4);
    const auto outside = std::min_element(peak, profile.end());
    if (*peak - *outside < kLowestContrastHu) return kNone;
    const double level = 0.5 * (*peak + *outside);
    for (auto next = peak + 1; next <= outside; ++next) {
      if (*next > level) continue;
      const double t = (*(next - 1) - level) / (*(next - 1) - *next);
      const auto index = next - profile.begin();
      return std::clamp(std::lerp(way_mm(index - 1), way_mm(index), t), -reach_mm_, reach_mm_);
    }
    return kNone;
  }

 private:
  const FloatGrid& hu_;
  double reach_mm_;
};

/// Moves every point along its normal by the mean of what its neighbours within `radius_mm` ask for, itself included:
/// noise in the CT moves single points, the bone's edge moves them together.
void move_to_edges(SurfacePoints& surface, const EdgeFinder& edges, double radius_mm) {
  const std::size_t count = surface.positions_mm.size();
  std::vector<double> offset_mm(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    offset_mm[i] = edges.offset_mm(surface.positions_mm[i], surface.normals[i]);
  });
  const PointGrid grid(surface.positions_mm, radius_mm);
  std::vector<Vec3> moved_mm(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    double sum_mm = 0.0;
    int found = 0;
    grid.for_each_within(surface.positions_mm[i], radius_mm, [&](std::size_t near) {
      // Points of another side of a thin part face elsewhere.
      if (std::isnan(offset_mm[near]) || surface.normals[near].dot(surface.normals[i]) < 0.5) return;
      sum_mm += offset_mm[near];
      ++found;
    });
    moved_mm[i] = surface.positions_mm[i] + (found > 0 ? sum_mm / found : 0.0) * surface.normals[i];
  });
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
  const double reach_mm = largest_step_mm;
  const VoxelBox work_box = grow_box(box, 3.0 * smooth_mm + 3.0 * largest_step_mm, ct.geometry);

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
  if (options.refine_by_hu) move_to_edges(all, EdgeFinder(hu, reach_mm), std::max(1.0, 2.0 * largest_step_mm));
  return all;
}

}  // namespace spinaltap
