#include "apps/spinaltap-planner/scene/scene_camera.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {

void SceneCamera::set_size(double width_px, double height_px) {
  width_px_ = std::max(1.0, width_px);
  height_px_ = std::max(1.0, height_px);
}

void SceneCamera::look_from(const Vec3& from, const Vec3& up) {
  constexpr double kUpright = 1e-6;
  const Vec3 direction = from.normalized();
  const Eigen::Vector2d level = direction.head<2>();
  elevation_ = std::atan2(direction.z(), level.norm());
  if (level.norm() > kUpright) {
    azimuth_ = std::atan2(level.x(), level.y());
  } else {
    // Straight from the head what is up in the picture lies away from the eye's side, from the feet on it.
    const double side = direction.z() > 0.0 ? -1.0 : 1.0;
    azimuth_ = std::atan2(side * up.x(), side * up.y());
  }
}

void SceneCamera::show(const Box3& box_mm) {
  constexpr double kMargin = 1.06;
  focus_mm_ = box_mm.center();
  const double half_height = std::tan(0.5 * kViewAngle);
  const double half_width = half_height * width_px_ / height_px_;
  distance_mm_ = 0.0;
  for (int n = 0; n < 8; ++n) {
    const Vec3 from_focus_mm = box_mm.corner(static_cast<Box3::CornerType>(n)) - focus_mm_;
    const double wide_mm =
        std::max(std::abs(from_focus_mm.dot(right())) / half_width, std::abs(from_focus_mm.dot(up())) / half_height);
    distance_mm_ = std::max(distance_mm_, kMargin * wide_mm - from_focus_mm.dot(forward()));
  }
}

void SceneCamera::orbit(double right, double up) {
  constexpr double kStraightUp = 90.0 * kDegree;
  // The scene goes to the right as the eye goes to the left.
  azimuth_ = std::remainder(azimuth_ - right, 360.0 * kDegree);
  elevation_ = std::clamp(elevation_ - up, -kStraightUp, kStraightUp);
}

void SceneCamera::pan(const Eigen::Vector2d& pixels) {
  focus_mm_ -= mm_per_pixel(distance_mm_) * (pixels.x() * right() - pixels.y() * up());
}

void SceneCamera::zoom(double factor) {
  constexpr double kNearestMm = 8.0;
  constexpr double kFarthestMm = 3000.0;
  distance_mm_ = std::clamp(distance_mm_ / factor, kNearestMm, kFarthestMm);
}

Vec3 SceneCamera::forward() const {
  return -Vec3(std::cos(elevation_) * std::sin(azimuth_), std::cos(elevation_) * std::cos(azimuth_),
               std::sin(elevation_));
}

Vec3 SceneCamera::right() const { return forward().cross(up()); }

Vec3 SceneCamera::up() const {
  return {-std::sin(elevation_) * std::sin(azimuth_), -std::sin(elevation_) * std::cos(azimuth_), std::cos(elevation_)};
}

Eigen::Vector2d SceneCamera::to_pixel(const Vec3& p_mm) const {
  const Vec3 from_eye_mm = p_mm - eye_mm();
  const double mm = mm_per_pixel(from_eye_mm.dot(forward()));
  return {0.5 * width_px_ + from_eye_mm.dot(right()) / mm, 0.5 * height_px_ - from_eye_mm.dot(up()) / mm};
}

Vec3 SceneCamera::ray(const Eigen::Vector2d& pixel) const { return (at_depth(pixel, 1.0) - eye_mm()).normalized(); }

Vec3 SceneCamera::at_depth(const Eigen::Vector2d& pixel, double depth) const {
  const double mm = mm_per_pixel(depth);
  return eye_mm() + depth * forward() +
         mm * ((pixel.x() - 0.5 * width_px_) * right() + (0.5 * height_px_ - pixel.y()) * up());
}

double SceneCamera::mm_per_pixel(double depth) const { return 2.0 * depth * std::tan(0.5 * kViewAngle) / height_px_; }

}  // namespace spinaltap
