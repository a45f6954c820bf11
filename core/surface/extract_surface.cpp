#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/segment/float_grid.h"
#include "core/surface/surface_points.h"

namespace spinaltap {
namespace {

constexpr double kSurfaceLevel = 0.5;

/// Gradient of the tri-linear grid at index coordinates, per mm, in patient LPS.
Vec3 gradient(const FloatGrid& grid, const Vec3& p_index) {
  Vec3 per_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 half = 0.5 * Vec3::Unit(axis);
    per_mm[axis] = (sample_clamped(grid, p_index + half) - sample_clamped(grid, p_index - half)) /
                   grid.geometry.spacing_mm[axis];
  }
  return grid.geometry.directions * per_mm;
}

/// Moves a point along its normal to where the CT number is halfway between the tissue outside and the peak of the
/// cortex, if there is such a place within `reach_mm`.
class HuRefiner {
 public:
  HuRefiner(const FloatGrid& hu, double reach_mm) : hu_(hu), reach_mm_(reach_mm) {}

  Vec3 refine(const Vec3& p_mm, const Vec3& normal) const {
    constexpr int kSamples = 41;
    constexpr double kLowestContrastHu = 100.0;
    const double span_mm = 2.0 * reach_mm_;
    std::array<double, kSamples> profile{};
    const auto way_mm = [&](int i) { return span_mm * (2.0 * i / (kSamples - 1) - 1.0); };
    for (int i = 0; i < kSamples; ++i) {
      profile[static_cast<std::size_t>(i)] =
          sample_clamped(hu_, hu_.geometry.to_index(p_mm + way_mm(i) * normal));
    }
    // The cortex peaks within reach of the mask's surface or further in; the tissue outside is lowest further out.
    const auto peak = std::max_element(profile.begin(), profile.begin() + 3 * kSamples / 4);
    const auto outside = std::min_element(peak, profile.end());
    if (*peak - *outside < kLowestContrastHu) return p_mm;
    const double level = 0.5 * (*peak + *outside);
    for (auto next = peak + 1; next <= outside && next != profile.end(); ++next) {
      if (*next > level) continue;
      const double t = (*(next - 1) - level) / (*(next - 1) - *next);
      const double moved_mm = std::lerp(way_mm(static_cast<int>(next - profile.begin()) - 1),
                                        way_mm(static_cast<int>(next - profile.begin())), t);
      return p_mm + std::clamp(moved_mm, -reach_mm_, reach_mm_) * normal;
    }
    return p_mm;
  }

 private:
  const FloatGrid& hu_;
  double reach_mm_;
};

}  // namespace

SurfacePoints extract_surface(const CtVolume& ct, const BoneMask& mask, const SurfaceOptions& options,
                              const Progress& progress) {
  if (mask.geometry.size != ct.geometry.size) fail("surface: expected the mask on the CT's grid, found another size");
  const VoxelBox box = mask_box(mask);
  if (box.empty()) fail("surface: the mask holds no voxel");
  const double largest_step_mm = ct.geometry.spacing_mm.maxCoeff();
  const double smooth_mm = options.smooth_mm > 0.0 ? options.smooth_mm : std::max(0.5, 0.7 * largest_step_mm);
  const double reach_mm = largest_step_mm;
  const VoxelBox work_box = grow_box(box, 3.0 * smooth_mm + 3.0 * largest_step_mm, ct.geometry);

  progress.report("surface points", 0.0);
  const FloatGrid smooth = gaussian_blur(crop_mask(mask, work_box), smooth_mm);
  const FloatGrid hu = crop_hu(ct, work_box);
  const HuRefiner refiner(hu, reach_mm);
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
          points.positions_mm.push_back(options.refine_by_hu ? refiner.refine(p_mm, normal) : p_mm);
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
  return all;
}

}  // namespace spinaltap
