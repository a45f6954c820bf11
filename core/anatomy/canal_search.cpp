#include "core/anatomy/canal_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

constexpr double kPixelMm = 1.0;
constexpr double kMinRadiusMm = 3.0;

/// The widest hole in the silhouette along one direction.
struct Hole {
  double radius_mm = 0.0;
  Vec3 centre_mm = Vec3::Zero();
};

/// Marks what the border reaches without coming within a pixel of bone; what remains at that distance are holes.
std::vector<std::uint8_t> reached_from_border(const std::vector<float>& squared_mm2, const GridGeometry& image) {
  constexpr auto kClosedMm2 = static_cast<float>(1.01 * kPixelMm * kPixelMm);
  std::vector<std::uint8_t> reached(squared_mm2.size(), 0);
  std::vector<std::array<int, 2>> front;
  const auto visit = [&](int i, int j) {
    if (!image.contains(i, j, 0)) return;
    const std::size_t at = image.offset(i, j, 0);
    if (reached[at] != 0 || squared_mm2[at] <= kClosedMm2) return;
    reached[at] = 1;
    front.push_back({i, j});
  };
  visit(0, 0);  // the image has a margin, so its border is all of one piece
  while (!front.empty()) {
    const auto [i, j] = front.back();
    front.pop_back();
    visit(i + 1, j);
    visit(i - 1, j);
    visit(i, j + 1);
    visit(i, j - 1);
  }
  return reached;
}

Hole widest_hole(const SurfaceSample& surface, const Vec3& axis) {
  const Vec3 u = Vec3::UnitY().cross(axis).normalized(), v = axis.cross(u);
  Eigen::AlignedBox2d box;
  std::vector<Eigen::Vector2d> seen;
  seen.reserve(surface.points_mm.size());
  for (const Vec3& p_mm : surface.points_mm) {
    seen.emplace_back(u.dot(p_mm), v.dot(p_mm));
    box.extend(seen.back());
  }
  constexpr double kMarginMm = 3.0 * kPixelMm;
  const Eigen::Vector2d low_mm = box.min().array() - kMarginMm;
  GridGeometry image;
  image.spacing_mm = Vec3::Constant(kPixelMm);
  image.size = {static_cast<int>((box.sizes().x() + 2.0 * kMarginMm) / kPixelMm) + 1,
                static_cast<int>((box.sizes().y() + 2.0 * kMarginMm) / kPixelMm) + 1, 1};
  std::vector<std::uint8_t> bone(image.voxel_count(), 0);
  for (const Eigen::Vector2d& p_mm : seen) {
    const Eigen::Vector2i pixel = ((p_mm - low_mm) / kPixelMm).array().round().cast<int>();
    bone[image.offset(pixel.x(), pixel.y(), 0)] = 1;
  }
  const std::vector<float> squared_mm2 = squared_distance_to(bone, image);
  const std::vector<std::uint8_t> outside = reached_from_border(squared_mm2, image);
  Hole hole;
  for (int j = 0; j < image.size[1]; ++j) {
    for (int i = 0; i < image.size[0]; ++i) {
      const std::size_t at = image.offset(i, j, 0);
      if (outside[at] != 0) continue;
      const double radius_mm = std::sqrt(static_cast<double>(squared_mm2[at]));
      if (!(radius_mm > hole.radius_mm)) continue;
      hole.radius_mm = radius_mm;
      hole.centre_mm = (low_mm.x() + kPixelMm * i) * u + (low_mm.y() + kPixelMm * j) * v;
    }
  }
  return hole;
}

struct CandidateAxis {
  Vec3 axis;
  Hole hole;
};

/// Directions at `step` around `middle`, up to `reach` away along each of two turns.
std::vector<CandidateAxis> candidates_around(const Vec3& middle, double reach, double step,
                                             const SurfaceSample& surface) {
  constexpr double kMaxTilt = 45.0 * kDegree;
  const Vec3 u = Vec3::UnitY().cross(middle).normalized(), v = middle.cross(u);
  std::vector<CandidateAxis> all;
  const int steps = static_cast<int>(std::lround(reach / step));
  for (int a = -steps; a <= steps; ++a) {
    for (int b = -steps; b <= steps; ++b) {
      const Vec3 axis = (middle + std::tan(step * a) * u + std::tan(step * b) * v).normalized();
      if (axis.z() >= std::cos(kMaxTilt)) all.push_back({axis, {}});
    }
  }
  tbb::parallel_for(std::size_t{0}, all.size(),
                    [&](std::size_t n) { all[n].hole = widest_hole(surface, all[n].axis); });
  return all;
}

double widest_of(const std::vector<CandidateAxis>& all) {
  double widest_mm = 0.0;
  for (const CandidateAxis& one : all) widest_mm = std::max(widest_mm, one.hole.radius_mm);
  return widest_mm;
}

/// The mean of the candidates from which the hole is almost as wide as from the best: its middle is surer than the
/// best, which the pixels choose.
CandidateAxis middle_of_best(const std::vector<CandidateAxis>& all) {
  constexpr double kAlmost = 0.9;
  const double min_mm = kAlmost * widest_of(all);
  Vec3 axis = Vec3::Zero(), centre_mm = Vec3::Zero();
  double weights = 0.0, radius_mm = 0.0;
  for (const CandidateAxis& one : all) {
    const double weight = std::max(0.0, one.hole.radius_mm - min_mm);
    axis += weight * one.axis;
    centre_mm += weight * one.hole.centre_mm;
    weights += weight;
    radius_mm = std::max(radius_mm, one.hole.radius_mm);
  }
  return {axis.normalized(), {radius_mm, weights > 0.0 ? Vec3(centre_mm / weights) : centre_mm}};
}

}  // namespace

std::optional<CanalView> find_canal(const SurfaceSample& surface) {
  const std::vector<CandidateAxis> coarse = candidates_around(Vec3::UnitZ(), 45.0 * kDegree, 5.0 * kDegree, surface);
  if (!(widest_of(coarse) >= kMinRadiusMm)) return std::nullopt;
  const Vec3 start = middle_of_best(coarse).axis;
  const std::vector<CandidateAxis> fine = candidates_around(start, 8.0 * kDegree, 2.0 * kDegree, surface);
  if (!(widest_of(fine) >= kMinRadiusMm)) return std::nullopt;
  const Vec3 axis = middle_of_best(fine).axis;
  const Hole hole = widest_hole(surface, axis);
  if (!(hole.radius_mm >= kMinRadiusMm)) return std::nullopt;
  const Vec3 middle_mm = bounds_of(surface.points_mm).center();
  return CanalView{hole.centre_mm + axis.dot(middle_mm) * axis, axis, hole.radius_mm};
}

}  // namespace spinaltap
