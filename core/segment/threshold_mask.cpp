#include "core/segment/threshold_mask.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/segment/connected_parts.h"
#include "core/segment/distance_transform.h"
#include "core/segment/float_grid.h"

namespace spinaltap {
namespace {

VoxelBox whole_grid(const GridGeometry& geometry) {
  return {{0, 0, 0}, {geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1}};
}

std::vector<std::uint8_t> voxels_over(const CtVolume& ct, double threshold_hu, double smooth_voxels) {
  std::vector<std::uint8_t> over(ct.hu.size());
  // Below a quarter of a voxel a blur changes nothing that matters.
  if (smooth_voxels < 0.25) {
    std::transform(ct.hu.begin(), ct.hu.end(), over.begin(),
                   [&](std::int16_t hu) { return static_cast<std::uint8_t>(hu >= threshold_hu ? 1 : 0); });
    return over;
  }
  const FloatGrid smooth =
      gaussian_blur(crop_hu(ct, whole_grid(ct.geometry)), smooth_voxels * ct.geometry.smallest_spacing_mm());
  std::transform(smooth.values.begin(), smooth.values.end(), over.begin(),
                 [&](float hu) { return static_cast<std::uint8_t>(static_cast<double>(hu) >= threshold_hu ? 1 : 0); });
  return over;
}

/// The bone and what a ball of radius `seal_mm` cannot reach from the border without touching it.
std::vector<std::uint8_t> fill_marrow(const FloatGrid& bone, double seal_mm) {
  std::vector<std::uint8_t> inside(bone.values.size());
  std::transform(bone.values.begin(), bone.values.end(), inside.begin(),
                 [](float value) { return static_cast<std::uint8_t>(value > 0.5F ? 1 : 0); });
  const auto limit = static_cast<float>(seal_mm * seal_mm);
  const std::vector<float> to_bone = squared_distance_to(inside, bone.geometry);
  std::vector<std::uint8_t> roomy(inside.size());
  std::transform(to_bone.begin(), to_bone.end(), roomy.begin(),
                 [&](float squared) { return static_cast<std::uint8_t>(squared > limit ? 1 : 0); });
  const std::vector<std::uint8_t> reached = connected_to_border(roomy, bone.geometry);
  const std::vector<float> to_reached = squared_distance_to(reached, bone.geometry);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (to_reached[i] > limit) inside[i] = 1;
  }
  return inside;
}

}  // namespace

double choose_threshold_hu(const CtVolume& ct) {
  constexpr double kQuietHu = 150.0;
  constexpr double kNoisyHu = 115.0;
  constexpr double kQuietNoise = 30.0;
  constexpr double kNoisyNoise = 70.0;
  const double share = std::clamp((estimate_noise_hu(ct) - kQuietNoise) / (kNoisyNoise - kQuietNoise), 0.0, 1.0);
  return std::lerp(kQuietHu, kNoisyHu, share);
}

double estimate_noise_hu(const CtVolume& ct) {
  constexpr std::size_t kMaxSamples = 1'000'000;
  const auto soft = [](std::int16_t hu) { return hu > -200 && hu < 300; };
  const auto columns = static_cast<std::size_t>(ct.geometry.size[0]);
  const std::size_t stride = std::max<std::size_t>(1, ct.hu.size() / kMaxSamples);
  std::vector<float> differences;
  for (std::size_t i = 0; i + 1 < ct.hu.size(); i += stride) {
    if ((i + 1) % columns == 0 || !soft(ct.hu[i]) || !soft(ct.hu[i + 1])) continue;
    differences.push_back(static_cast<float>(std::abs(ct.hu[i + 1] - ct.hu[i])));
  }
  if (differences.empty()) return 0.0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  // The median of |a - b| of two normal numbers is 0.6745 * sqrt(2) deviations.
  return static_cast<double>(*middle) / (0.6745 * std::sqrt(2.0));
}

BoneMask threshold_mask(const CtVolume& ct, const ThresholdOptions& options, const Progress& progress) {
  const GridGeometry& geometry = ct.geometry;
  const double threshold_hu = options.threshold_hu ? *options.threshold_hu : choose_threshold_hu(ct);
  if (!std::isfinite(threshold_hu)) fail("bone threshold: expected a number of HU, found ", threshold_hu);
  if (!(options.smooth_voxels <= 10.0)) {
    fail("bone threshold: expected a blur of at most 10 voxels, found ", options.smooth_voxels);
  }
  if (!(options.seal_mm >= 0.0 && options.seal_mm <= 50.0)) {
    fail("bone threshold: expected gaps of 0 to 50 mm to seal, found ", options.seal_mm, " mm");
  }
  // A blur of 0.7 voxels tames noise of 85 HU; a quiet CT keeps its thin cortex.
  constexpr double kNoisePerBlurredVoxel = 120.0;
  const double smooth_voxels = options.smooth_voxels >= 0.0
                                   ? options.smooth_voxels
                                   : std::min(estimate_noise_hu(ct) / kNoisePerBlurredVoxel, 0.8);
  progress.report("finding bone", 0.0);
  BoneMask mask{geometry, largest_part(voxels_over(ct, threshold_hu, smooth_voxels), geometry)};
  progress.report("finding bone", 0.5);
  const VoxelBox box = mask_box(mask);
  if (box.empty()) {
    const auto [lowest, highest] = std::minmax_element(ct.hu.begin(), ct.hu.end());
    fail("no voxel over the bone threshold of ", threshold_hu, " HU; the CT holds ", *lowest, " to ", *highest, " HU");
  }
  const double largest_step_mm = geometry.spacing_mm.maxCoeff();
  const double seal_mm = options.seal_mm > 0.0 ? options.seal_mm : std::max(1.0, 2.0 * largest_step_mm);
  // The margin leaves room for the ball to roll around the bone.
  const VoxelBox work_box = grow_box(box, 2.0 * seal_mm + 2.0 * largest_step_mm, geometry);
  const FloatGrid bone = crop_mask(mask, work_box);
  const std::vector<std::uint8_t> filled = fill_marrow(bone, seal_mm);
  for (int k = 0; k < bone.geometry.size[2]; ++k) {
    for (int j = 0; j < bone.geometry.size[1]; ++j) {
      for (int i = 0; i < bone.geometry.size[0]; ++i) {
        const int ci = work_box.low[0] + i;
        const int cj = work_box.low[1] + j;
        const int ck = work_box.low[2] + k;
        if (!geometry.contains(ci, cj, ck)) continue;
        mask.inside[geometry.offset(ci, cj, ck)] = filled[bone.geometry.offset(i, j, k)];
      }
    }
  }
  progress.report("finding bone", 1.0);
  return mask;
}

}  // namespace spinaltap
