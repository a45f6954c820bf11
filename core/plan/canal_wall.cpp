#include "core/plan/canal_wall.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/plan/lattice_ray.h"

namespace spinaltap {
namespace {

constexpr double kMostReachMm = 25.0;

/// Whether a straight way from a point of the surface to a place meets no bone once it has left the surface.
bool sees(const BoneShape& bone, const Vec3& point_mm, const Vec3& place_mm) {
  constexpr double kSkipMm = 0.75, kStepMm = 0.5;
  const Vec3 way_mm = place_mm - point_mm;
  const double length_mm = way_mm.norm();
  for (double at_mm = kSkipMm; at_mm < length_mm; at_mm += kStepMm) {
    if (bone.lattice_mm(point_mm + at_mm / length_mm * way_mm) < 0.0) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> canal_wall_flags(const BoneShape& bone, const Landmarks& landmarks) {
  constexpr double kBesideMm = 2.0, kAboveMm = 4.0, kBelowMm = 10.0, kBehindMm = 6.0;
  constexpr double kLeastFacing = 0.2;  // cosine: flatter, a place looks up or down and not at the canal
  const Landmarks::Canal& canal = landmarks.canal;
  const double top_mm = landmarks.to_own(landmarks.body.upper.centre_mm).z() + kAboveMm;
  const double bottom_mm = landmarks.to_own(landmarks.body.lower.centre_mm).z() - kBelowMm;
  const double half_width_mm = 0.5 * canal.width_mm + kBesideMm;
  const double half_depth_mm = 0.5 * std::max(canal.depth_mm, canal.width_mm) + kBehindMm;
  std::vector<std::uint8_t> flags(bone.points_mm().size(), 0);
  tbb::parallel_for(std::size_t{0}, flags.size(), [&](std::size_t n) {
    const Vec3& p_mm = bone.points_mm()[n];
    const double height_mm = landmarks.to_own(p_mm).z();
    if (height_mm > top_mm || height_mm < bottom_mm) return;
    const Vec3 axis_mm = canal.centre_mm + canal.axis * (p_mm - canal.centre_mm).dot(canal.axis);
    const Vec3 to_axis_mm = axis_mm - p_mm;
    if (std::abs(to_axis_mm.dot(landmarks.left())) > half_width_mm) return;
    if (std::abs(to_axis_mm.dot(landmarks.posterior())) > half_depth_mm) return;
    if (!(bone.normals()[n].dot(to_axis_mm) > kLeastFacing * to_axis_mm.norm())) return;
    if (sees(bone, p_mm, axis_mm)) flags[n] = 1;
  });
  return flags;
}

Landmarks::Canal measure_canal(const BoneShape& bone, const Vec3& at_mm, const Vec3& canal_axis, const Mat3& axes) {
  constexpr double kLevelsMm = 12.0, kStepMm = 1.0;
  constexpr int kRays = 48;
  const auto way_mm = [&](const Vec3& from_mm, const Vec3& direction) {
    return way_to_surface_mm(bone, from_mm, direction, kMostReachMm);
  };
  Landmarks::Canal canal;
  canal.axis = canal_axis;
  double depth_mm = std::numeric_limits<double>::infinity();
  for (double level = -kLevelsMm; level <= kLevelsMm; level += kStepMm) {
    const Vec3 p_mm = at_mm + level * canal_axis;
    if (bone.lattice_mm(p_mm) < 0.0) continue;
    const double front_mm = way_mm(p_mm, -axes.col(1)), back_mm = way_mm(p_mm, axes.col(1));
    if (front_mm >= kMostReachMm || back_mm >= kMostReachMm) continue;
    depth_mm = std::min(depth_mm, front_mm + back_mm);
  }
  if (std::isfinite(depth_mm)) canal.depth_mm = depth_mm;
  canal.centre_mm = at_mm;
  const double front_mm = way_mm(at_mm, -axes.col(1));
  if (canal.depth_mm > 0.0 && front_mm < kMostReachMm) {
    canal.centre_mm += (0.5 * canal.depth_mm - front_mm) * axes.col(1);
  }
  // The widest of the level, between the pedicles: rays from several places of the midline, in front of the middle.
  double left_mm = 0.0, right_mm = 0.0;
  for (int n = -kRays; n <= kRays; ++n) {
    const double y_mm = 0.5 * canal.depth_mm * n / kRays;
    const Vec3 p_mm = canal.centre_mm + y_mm * axes.col(1);
    if (bone.lattice_mm(p_mm) < 0.0) continue;
    const double left = way_mm(p_mm, axes.col(0)), right = way_mm(p_mm, -axes.col(0));
    if (left < kMostReachMm) left_mm = std::max(left_mm, left);
    if (right < kMostReachMm) right_mm = std::max(right_mm, right);
  }
  canal.width_mm = left_mm + right_mm;
  return canal;
}

}  // namespace spinaltap
