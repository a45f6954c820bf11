#include "core/segment/bone_levels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/segment/detail/median.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMaxSamples = 1'000'000;

double threshold_for(double noise_hu) {
  constexpr double kQuietHu = 150.0;
  constexpr double kNoisyHu = 115.0;
  constexpr double kQuietNoise = 30.0;
  constexpr double kNoisyNoise = 70.0;
  const double share = std::clamp((noise_hu - kQuietNoise) / (kNoisyNoise - kQuietNoise), 0.0, 1.0);
  return lerp(kQuietHu, kNoisyHu, share);
}

}  // namespace

double estimate_noise_hu(const CtVolume& ct) {
  const auto soft = [](std::int16_t hu) { return hu > -200 && hu < 300; };
  const auto columns = static_cast<std::size_t>(ct.geometry.size[0]);
  const std::size_t stride = std::max<std::size_t>(1, ct.hu.size() / kMaxSamples);
  std::vector<float> differences;
  for (std::size_t i = 0; i + 1 < ct.hu.size(); i += stride) {
    if ((i + 1) % columns == 0 || !soft(ct.hu[i]) || !soft(ct.hu[i + 1])) continue;
    differences.push_back(static_cast<float>(std::abs(ct.hu[i + 1] - ct.hu[i])));
  }
  if (differences.empty()) return 0.0;
  // The median of |a - b| of two normal numbers is 0.6745 * sqrt(2) deviations.
  return static_cast<double>(detail::upper_median(std::move(differences))) / (0.6745 * std::sqrt(2.0));
}

BoneLevels choose_bone_levels(const CtVolume& ct, std::optional<double> threshold_hu) {
  if (threshold_hu && !std::isfinite(*threshold_hu)) {
    fail("bone threshold: expected a number of HU, found ", *threshold_hu);
  }
  BoneLevels levels;
  levels.noise_hu = estimate_noise_hu(ct);
  levels.low_hu = threshold_hu ? *threshold_hu : threshold_for(levels.noise_hu);
  // A blur of 0.7 voxels tames noise of 85 HU; a quiet CT keeps its thin cortex.
  constexpr double kNoisePerBlurredVoxel = 120.0;
  levels.blur_voxels = std::min(levels.noise_hu / kNoisePerBlurredVoxel, 0.8);
  std::vector<std::int16_t> bone;
  const std::size_t stride = std::max<std::size_t>(1, ct.hu.size() / (16 * kMaxSamples));
  for (std::size_t i = 0; i < ct.hu.size(); i += stride) {
    if (ct.hu[i] >= levels.low_hu) bone.push_back(ct.hu[i]);
  }
  if (bone.empty()) {
    const auto [lowest, highest] = std::minmax_element(ct.hu.begin(), ct.hu.end());
    fail_as(ErrorKind::geometry, "no voxel over the bone threshold of ", levels.low_hu, " HU; the CT holds ", *lowest,
            " to ", *highest, " HU");
  }
  const auto dense = bone.begin() + static_cast<std::ptrdiff_t>((bone.size() - 1) * 95 / 100);
  std::nth_element(bone.begin(), dense, bone.end());
  levels.sure_hu = levels.low_hu + (*dense - levels.low_hu) / 3.0;
  return levels;
}

FloatGrid blurred_as_asked(FloatGrid hu, const BoneLevels& levels, const CtVolume& ct) {
  constexpr double kMinVoxels = 0.25;  // less changes nothing
  if (levels.blur_voxels < kMinVoxels) return hu;
  return gaussian_blur(hu, levels.blur_voxels * ct.geometry.smallest_spacing_mm());
}

}  // namespace spinaltap
