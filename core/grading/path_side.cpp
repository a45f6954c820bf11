#include "core/grading/path_side.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

double distance_to_path_mm(const Vec3& p_mm, const PathCurve& curve) {
  return (curve.at_mm(std::clamp(curve.nearest_mm(p_mm), 0.0, curve.length_mm())) - p_mm).norm();
}

bool is_mostly_anterior(const Vec3& own) { return -own.y() > std::max(std::abs(own.x()), std::abs(own.z())); }

}  // namespace

PathAngles path_angles(const Vec3& direction, const Mat3& axes, bool is_left) {
  const Vec3 own = axes.transpose() * direction;
  const double inward = is_left ? -own.x() : own.x();
  return {std::atan2(inward, -own.y()) / kDegree, std::atan2(own.z(), std::hypot(own.x(), own.y())) / kDegree};
}

const char* name_of(PathSide side) {
  switch (side) {
    case PathSide::medial:
      return "medial";
    case PathSide::lateral:
      return "lateral";
    case PathSide::cranial:
      return "cranial";
    case PathSide::caudal:
      return "caudal";
    case PathSide::anterior:
      break;
  }
  return "anterior";
}

SideNames::SideNames(const Landmarks& landmarks, const DrillPath& path)
    : landmarks_(landmarks),
      curve_(path),
      pedicle_(distance_to_path_mm(landmarks.left_pedicle.isthmus_mm, curve_) <=
                       distance_to_path_mm(landmarks.right_pedicle.isthmus_mm, curve_)
                   ? &landmarks.left_pedicle
                   : &landmarks.right_pedicle) {}

Vec3 SideNames::towards(const Vec3& p_mm, const WallDistance::Wall& wall) {
  constexpr double kNearMm = 0.5;
  if (!(std::abs(wall.distance_mm) > kNearMm)) return wall.normal;
  const Vec3 way_mm = wall.distance_mm > 0.0 ? wall.nearest_mm - p_mm : p_mm - wall.nearest_mm;
  const double length_mm = way_mm.norm();
  return length_mm > 0.0 ? Vec3(way_mm / length_mm) : wall.normal;
}

PathSide SideNames::of(const Vec3& p_mm, const WallDistance::Wall& wall) const {
  constexpr double kAhead = 0.5;  // cosine of 60 degrees
  const Vec3 way = towards(p_mm, wall);
  const Vec3 own = landmarks_.axes.transpose() * way;
  if (is_mostly_anterior(own) || is_mostly_anterior(landmarks_.axes.transpose() * wall.normal)) {
    return PathSide::anterior;
  }
  const Vec3 direction = curve_.direction_at(curve_.nearest_mm(p_mm));
  const bool runs_forward = -direction.dot(landmarks_.posterior()) > kAhead;
  const double length_mm = curve_.length_mm();
  const bool is_ahead =
      wall.distance_mm <= 0.0 || (wall.nearest_mm - curve_.at_mm(length_mm)).dot(curve_.direction_at(length_mm)) > 0.0;
  if (runs_forward && is_ahead && way.dot(direction) > kAhead) return PathSide::anterior;
  if (std::abs(own.x()) < std::abs(own.z())) return own.z() > 0.0 ? PathSide::cranial : PathSide::caudal;
  return (own.x() < 0.0) == is_left() ? PathSide::medial : PathSide::lateral;
}

}  // namespace spinaltap
