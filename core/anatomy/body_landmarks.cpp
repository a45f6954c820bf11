#include "core/anatomy/body_landmarks.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/anatomy/detail/lattice_ray.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kMaxMm = 60.0;

/// The place half way between where the two ways along +-direction leave the bone, and how far those are apart.
struct Span {
  Vec3 middle_mm;
  double length_mm;
};

Span span_along(const BoneShape& bone, const Vec3& p_mm, const Vec3& direction) {
  const double ahead_mm = way_to_surface_mm(bone, p_mm, direction, kMaxMm);
  const double behind_mm = way_to_surface_mm(bone, p_mm, -direction, kMaxMm);
  return {p_mm + 0.5 * (ahead_mm - behind_mm) * direction, ahead_mm + behind_mm};
}

/// A plane z = c0 + c1 x + c2 y by least squares with Tukey's biweight, in coordinates of the vertebra around a centre.
Vec3 robust_plane(const std::vector<Vec3>& points) {
  constexpr int kRounds = 12;
  constexpr double kWideMm = 6.0, kNarrowMm = 2.5;
  Vec3 plane = Vec3::Zero();
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const Vec3& p : points) heights.push_back(p.z());
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  plane[0] = *middle;
  for (int round = 0; round < kRounds; ++round) {
    const double reach_mm = std::max(kNarrowMm, kWideMm * (1.0 - round / (0.5 * kRounds)));
    Mat3 matrix = 1e-9 * Mat3::Identity();
    Vec3 right = Vec3::Zero();
    for (const Vec3& p : points) {
      const Vec3 row(1.0, p.x(), p.y());
      const double ratio = (p.z() - row.dot(plane)) / reach_mm;
      if (!(std::abs(ratio) < 1.0)) continue;
      const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
      matrix += weight * row * row.transpose();
      right += weight * p.z() * row;
    }
    const Vec3 next = matrix.ldlt().solve(right);
    if (next.allFinite()) plane = next;
  }
  return plane;
}

/// `up`: 1 for the upper endplate, -1 for the lower one.
EndplateLandmarks endplate(const BoneShape& bone, const Vec3& centre_mm, const Mat3& axes, double up,
                           double half_width_mm, double half_depth_mm) {
  constexpr int kSteps = 8;
  constexpr double kShare = 0.8;  // of the body's half sizes; beyond is the rim, rounded or with spurs
  std::vector<Vec3> points;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      if (i * i + j * j > kSteps * kSteps) continue;
      const double x = kShare * half_width_mm * i / kSteps, y = kShare * half_depth_mm * j / kSteps;
      const Vec3 start_mm = centre_mm + axes * Vec3(x, y, 0.0);
      if (!(bone.lattice_mm(start_mm) < 0.0)) continue;
      const double way_mm = way_to_surface_mm(bone, start_mm, up * axes.col(2), kMaxMm);
      if (way_mm < kMaxMm) points.emplace_back(x, y, up * way_mm);
    }
  }
  constexpr std::size_t kMin = 20;
  if (points.size() < kMin) {
    fail("landmarks: the vertebral body has no ", up > 0.0 ? "upper" : "lower", " end within ", kMaxMm,
         " mm of its middle");
  }
  const Vec3 plane = robust_plane(points);
  EndplateLandmarks result;
  result.centre_mm = centre_mm + plane[0] * axes.col(2);
  result.normal = up * (axes * Vec3(-plane[1], -plane[2], 1.0)).normalized();
  return result;
}

}  // namespace

Core find_core(const BoneShape& bone) {
  const FloatGrid& lattice = bone.lattice();
  const auto deepest = std::min_element(lattice.values.begin(), lattice.values.end());
  const double deepest_mm = static_cast<double>(*deepest);
  const auto offset = static_cast<std::size_t>(deepest - lattice.values.begin());
  const auto [width, height, depth] = lattice.geometry.size;
  const auto in_row = static_cast<std::size_t>(width), in_layer = in_row * static_cast<std::size_t>(height);
  const std::size_t column = offset % in_row, row = offset % in_layer / in_row, layer = offset / in_layer;
  const Vec3 deepest_index(static_cast<double>(column), static_cast<double>(row), static_cast<double>(layer));
  // Its neighbourhood's mean moves less with noise. A second body lies further away than this.
  constexpr double kShare = 0.85, kReachMm = 10.0;
  const int reach = static_cast<int>(kReachMm / BoneShape::kLatticeMm);
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const Eigen::Vector3i at = deepest_index.cast<int>() + Eigen::Vector3i(i, j, k);
        if (!lattice.geometry.contains(at.x(), at.y(), at.z())) continue;
        const double weight =
            std::max(0.0, kShare * deepest_mm - static_cast<double>(lattice.at(at.x(), at.y(), at.z())));
        sum += weight * at.cast<double>();
        weights += weight;
      }
    }
  }
  const Vec3 index = weights > 0.0 ? Vec3(sum / weights) : deepest_index;
  return {lattice.geometry.to_patient(index), -deepest_mm};
}

Landmarks::Body measure_body(const BoneShape& bone, const Vec3& inside_mm, const Mat3& axes) {
  constexpr int kRounds = 3;
  constexpr double kMinMm = 5.0;
  Vec3 centre_mm = inside_mm;
  Span width{}, depth{}, height{};
  for (int round = 0; round < kRounds; ++round) {
    height = span_along(bone, centre_mm, axes.col(2));
    centre_mm = height.middle_mm;
    width = span_along(bone, centre_mm, axes.col(0));
    centre_mm = width.middle_mm;
    depth = span_along(bone, centre_mm, axes.col(1));
    centre_mm = depth.middle_mm;
  }
  if (!(std::min({height.length_mm, width.length_mm, depth.length_mm}) >= kMinMm)) {
    fail("landmarks: expected a vertebral body of at least ", kMinMm, " mm, found ", width.length_mm, " x ",
         depth.length_mm, " x ", height.length_mm, " mm");
  }
  Landmarks::Body body;
  body.width_mm = width.length_mm;
  body.depth_mm = depth.length_mm;
  body.upper = endplate(bone, centre_mm, axes, 1.0, 0.5 * width.length_mm, 0.5 * depth.length_mm);
  body.lower = endplate(bone, centre_mm, axes, -1.0, 0.5 * width.length_mm, 0.5 * depth.length_mm);
  body.centre_mm = 0.5 * (body.upper.centre_mm + body.lower.centre_mm);
  body.height_mm = (body.upper.centre_mm - body.lower.centre_mm).norm();
  return body;
}

int count_bodies(const BoneShape& bone, const Vec3& inside_mm, const Mat3& axes) {
  constexpr double kReachMm = 120.0, kStepMm = 0.5, kMinMm = 10.0, kApartMm = 6.0;
  constexpr int kSteps = 2;
  std::vector<int> counts;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const Vec3 middle_mm = inside_mm + 0.5 * kApartMm * (i * axes.col(0) + j * axes.col(1));
      int bodies = 0;
      double run_mm = 0.0;
      for (double way_mm = -kReachMm; way_mm <= kReachMm; way_mm += kStepMm) {
        const bool inside = bone.lattice_mm(middle_mm + way_mm * axes.col(2)) < 0.0;
        if (inside) run_mm += kStepMm;
        if (inside && run_mm == kMinMm) ++bodies;
        if (!inside) run_mm = 0.0;
      }
      counts.push_back(bodies);
    }
  }
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return *middle;
}

}  // namespace spinaltap
