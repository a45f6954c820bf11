#include "core/anatomy/detail/canal_wall.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/anatomy/detail/lattice_ray.h"

namespace spinaltap {
namespace {

constexpr double kMaxReachMm = 25.0;

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

/// Tells the canal's wall from the rest of the surface.
class CanalWall {
 public:
  CanalWall(const BoneShape& bone, const Landmarks& landmarks)
      : bone_(bone),
        landmarks_(landmarks),
        top_mm_(height_of(landmarks.body.upper.centre_mm) + kAboveMm),
        bottom_mm_(height_of(landmarks.body.lower.centre_mm) - kBelowMm),
        half_width_mm_(0.5 * landmarks.canal.width_mm + kBesideMm),
        half_depth_mm_(0.5 * std::max(landmarks.canal.depth_mm, landmarks.canal.width_mm) + kBehindMm) {}

  bool holds(const Vec3& p_mm, const Vec3& normal) const {
    constexpr double kMinFacing = 0.2;  // cosine: flatter, a place looks up or down and not at the canal
    const double height_mm = height_of(p_mm);
    if (height_mm > top_mm_ || height_mm < bottom_mm_) return false;
    const Landmarks::Canal& canal = landmarks_.canal;
    const Vec3 axis_mm = canal.centre_mm + canal.axis * (p_mm - canal.centre_mm).dot(canal.axis);
    const Vec3 to_axis_mm = axis_mm - p_mm;
    if (std::abs(to_axis_mm.dot(landmarks_.left())) > half_width_mm_) return false;
    if (std::abs(to_axis_mm.dot(landmarks_.posterior())) > half_depth_mm_) return false;
    if (!(normal.dot(to_axis_mm) > kMinFacing * to_axis_mm.norm())) return false;
    return sees(bone_, p_mm, axis_mm);
  }

 private:
  static constexpr double kBesideMm = 2.0, kAboveMm = 4.0, kBelowMm = 10.0, kBehindMm = 6.0;

  double height_of(const Vec3& p_mm) const { return landmarks_.superior().dot(p_mm - landmarks_.canal.centre_mm); }

  const BoneShape& bone_;
  const Landmarks& landmarks_;
  double top_mm_, bottom_mm_, half_width_mm_, half_depth_mm_;
};

}  // namespace

Vec3 direction_of_canal(const BoneShape& bone, const SurfaceSample& surface, const Landmarks& landmarks) {
  constexpr double kLevelsMm = 10.0, kReach = 0.35;
  constexpr int kRounds = 6;
  const CanalWall wall(bone, landmarks);
  std::vector<Vec3> normals;
  for (std::size_t n = 0; n < surface.points_mm.size(); ++n) {
    const Vec3& p_mm = surface.points_mm[n];
    if (std::abs(landmarks.superior().dot(p_mm - landmarks.canal.centre_mm)) > kLevelsMm) continue;
    if (wall.holds(p_mm, surface.normals[n])) normals.push_back(surface.normals[n]);
  }
  Vec3 axis = landmarks.canal.axis;
  for (int round = 0; round < kRounds; ++round) {
    Mat3 spread = Mat3::Zero();
    for (const Vec3& normal : normals) {
      const double ratio = normal.dot(axis) / kReach;
      if (std::abs(ratio) < 1.0) spread += (1.0 - ratio * ratio) * (1.0 - ratio * ratio) * normal * normal.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
    // Walls of one direction only do not tell.
    if (!(solver.eigenvalues()[1] > 0.05 * solver.eigenvalues()[2])) return landmarks.canal.axis;
    axis = solver.eigenvectors().col(0);
    if (axis.dot(landmarks.superior()) < 0.0) axis = -axis;
  }
  return axis;
}

std::vector<std::uint8_t> canal_wall_flags(const BoneShape& bone, const Landmarks& landmarks) {
  const CanalWall wall(bone, landmarks);
  std::vector<std::uint8_t> flags(bone.points_mm().size(), 0);
  tbb::parallel_for(std::size_t{0}, flags.size(), [&](std::size_t n) {
    if (wall.holds(bone.points_mm()[n], bone.normals()[n])) flags[n] = 1;
  });
  return flags;
}

Landmarks::Canal measure_canal(const BoneShape& bone, const Vec3& at_mm, const Vec3& canal_axis, const Mat3& axes) {
  constexpr double kLevelsMm = 12.0, kStepMm = 1.0;
  constexpr int kRays = 48;
  const auto way_mm = [&](const Vec3& from_mm, const Vec3& direction) {
    return way_to_surface_mm(bone, from_mm, direction, kMaxReachMm);
  };
  Landmarks::Canal canal;
  canal.axis = canal_axis;
  double depth_mm = std::numeric_limits<double>::infinity();
  for (double level = -kLevelsMm; level <= kLevelsMm; level += kStepMm) {
    const Vec3 p_mm = at_mm + level * canal_axis;
    if (bone.lattice_mm(p_mm) < 0.0) continue;
    const double front_mm = way_mm(p_mm, -axes.col(1)), back_mm = way_mm(p_mm, axes.col(1));
    if (front_mm >= kMaxReachMm || back_mm >= kMaxReachMm) continue;
    depth_mm = std::min(depth_mm, front_mm + back_mm);
  }
  if (std::isfinite(depth_mm)) canal.depth_mm = depth_mm;
  canal.centre_mm = at_mm;
  const double front_mm = way_mm(at_mm, -axes.col(1));
  if (canal.depth_mm > 0.0 && front_mm < kMaxReachMm) {
    canal.centre_mm += (0.5 * canal.depth_mm - front_mm) * axes.col(1);
  }
  // The widest of the level, between the pedicles: rays from several places of the midline, in front of the middle.
  double left_mm = 0.0, right_mm = 0.0;
  for (int n = -kRays; n <= kRays; ++n) {
    const double y_mm = 0.5 * canal.depth_mm * n / kRays;
    const Vec3 p_mm = canal.centre_mm + y_mm * axes.col(1);
    if (bone.lattice_mm(p_mm) < 0.0) continue;
    const double left = way_mm(p_mm, axes.col(0)), right = way_mm(p_mm, -axes.col(0));
    if (left < kMaxReachMm) left_mm = std::max(left_mm, left);
    if (right < kMaxReachMm) right_mm = std::max(right_mm, right);
  }
  canal.width_mm = left_mm + right_mm;
  return canal;
}

}  // namespace spinaltap
