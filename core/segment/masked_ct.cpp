#include "core/segment/masked_ct.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/segment/detail/connected_parts.h"
#include "core/segment/detail/median.h"

namespace spinaltap {
namespace {

constexpr double kMarginMm = 20.0;

/// The value that all but a part of the CT was set to.
std::optional<std::int16_t> set_value(const CtVolume& ct) {
  constexpr std::size_t kMaxSamples = 1 << 18;
  constexpr int kAirHu = -200;  // a mask's outside is air or 0; soft tissue of a made CT may be one value too
  constexpr int kSurelyAirHu = -300;
  constexpr double kLeastSet = 0.5, kMostAir = 0.05;
  std::vector<std::int16_t> samples;
  // An odd stride meets all columns of a slice in turn.
  const std::size_t stride = (ct.hu.size() / kMaxSamples) | 1;
  samples.reserve(ct.hu.size() / stride + 1);
  for (std::size_t n = 0; n < ct.hu.size(); n += stride) samples.push_back(ct.hu[n]);
  if (samples.empty()) return std::nullopt;
  // What fills half of all is, or stands beside, the median.
  const std::int16_t value = detail::upper_median(samples);
  if (value != 0 && value > kAirHu) return std::nullopt;
  const auto set = static_cast<double>(std::count(samples.begin(), samples.end(), value));
  const auto all = static_cast<double>(samples.size());
  if (set < kLeastSet * all || set == all) return std::nullopt;
  const auto air = static_cast<double>(
      std::count_if(samples.begin(), samples.end(), [&](std::int16_t hu) { return hu != value && hu < kSurelyAirHu; }));
  if (air > kMostAir * (all - set)) return std::nullopt;
  return value;
}

/// What was kept, alone: the largest part, with hollows where the value happens to be the set one.
void find_kept(const CtVolume& ct, std::int16_t set_hu, MaskedCt& masked) {
  std::vector<std::uint8_t> inside(ct.hu.size());
  std::transform(ct.hu.begin(), ct.hu.end(), inside.begin(),
                 [&](std::int16_t hu) { return static_cast<std::uint8_t>(hu != set_hu ? 1 : 0); });
  const auto count = [](const std::vector<std::uint8_t>& mask) {
    return static_cast<double>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
  };
  const double all = count(inside);
  masked.kept = {ct.geometry, largest_part(inside, ct.geometry)};
  const double largest = count(masked.kept.inside);
  masked.kept.inside = fill_hollows(masked.kept.inside, ct.geometry, 0.0);
  constexpr double kNearlyAll = 0.9, kMinMm3 = 3000.0, kMaxMm3 = 150'000.0;
  masked.kept_mm3 = count(masked.kept.inside) * ct.geometry.spacing_mm.prod();
  masked.is_one = largest > kNearlyAll * all && masked.kept_mm3 > kMinMm3 && masked.kept_mm3 < kMaxMm3;
  if (!masked.is_one) return;
  // Along the patient's height a vertebra with its processes is lower than two bodies with theirs.
  const Vec3 kMaxMm(150.0, 150.0, 95.0);
  const VoxelBlock block = block_around(masked.kept, 0.0);
  Vec3 size_mm;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<Eigen::Index>(axis);
    size_mm[n] = (block.last[axis] - block.first[axis] + 1) * ct.geometry.spacing_mm[n];
  }
  const Vec3 in_patient_mm = ct.geometry.directions.cwiseAbs() * size_mm;
  masked.is_one = (in_patient_mm.array() < kMaxMm.array()).all();
}

/// The voxels around the given ones at an axis' first and last end.
std::array<int, 2> margins(const BoneMask& kept, std::size_t axis) {
  constexpr double kCutMm2 = 200.0;  // less are tips of processes, more is a body
  const GridGeometry& geometry = kept.geometry;
  const auto n = static_cast<Eigen::Index>(axis);
  const int margin = static_cast<int>(std::ceil(kMarginMm / geometry.spacing_mm[n]));
  Eigen::Index upright = 0;
  geometry.directions.row(2).cwiseAbs().maxCoeff(&upright);
  if (n != upright) return {margin, margin};
  std::array<double, 2> mm2{};
  const double face_mm2 = geometry.spacing_mm.prod() / geometry.spacing_mm[n];
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const int at = std::array{i, j, k}[axis];
        if (at == 0 && kept.at(i, j, k)) mm2[0] += face_mm2;
        if (at == geometry.size[axis] - 1 && kept.at(i, j, k)) mm2[1] += face_mm2;
      }
    }
  }
  return {mm2[0] > kCutMm2 ? 0 : margin, mm2[1] > kCutMm2 ? 0 : margin};
}

}  // namespace

std::optional<MaskedCt> as_masked(const CtVolume& ct) {
  const std::optional<std::int16_t> set_hu = set_value(ct);
  if (!set_hu) return std::nullopt;
  MaskedCt masked;
  find_kept(ct, *set_hu, masked);
  GridGeometry geometry = ct.geometry;
  Vec3 first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<Eigen::Index>(axis);
    const auto [before, behind] = margins(masked.kept, axis);
    first[n] = -before;
    geometry.size[axis] += before + behind;
    masked.original.first[axis] = before;
    masked.original.last[axis] = before + ct.geometry.size[axis] - 1;
  }
  geometry.origin_mm = ct.geometry.to_patient(first);
  std::vector<std::int16_t> hu(geometry.voxel_count(), 0);
  std::size_t from = 0;
  for (int k = masked.original.first[2]; k <= masked.original.last[2]; ++k) {
    for (int j = masked.original.first[1]; j <= masked.original.last[1]; ++j) {
      const std::size_t to = geometry.offset(masked.original.first[0], j, k);
      for (int i = 0; i < ct.geometry.size[0]; ++i, ++from) {
        const auto n = static_cast<std::size_t>(i);
        hu[to + n] = ct.hu[from] == *set_hu ? std::int16_t{0} : ct.hu[from];
      }
    }
  }
  masked.ct = make_ct_volume(geometry, std::move(hu));
  return masked;
}

}  // namespace spinaltap
