#pragma once

#include "core/base/geometry.h"

namespace spinaltap {

/// The eye of the 3D pane: looks at a focus from a direction, in perspective, the patient's head up whenever it can be.
/// Pixels are those of the window system, from the pane's upper left corner, whatever the display's pixel ratio.
class SceneCamera {
 public:
  static constexpr double kViewAngle = 25.0 * kDegree;  ///< over the pane's height

  void set_size(double width_px, double height_px);

  /// Looks from a direction, from the focus to the eye; `up` (patient LPS) decides what is up where that is straight
  /// from the head or the feet.
  void look_from(const Vec3& from, const Vec3& up);
  /// Puts a box (patient LPS, mm) into the middle, as large as fits.
  void show(const Box3& box_mm);
  /// Turns about the focus: the scene goes to the right and up for positive angles (rad).
  void orbit(double right, double up);
  /// Moves the scene along with the pointer, in the plane of the focus.
  void pan(const Eigen::Vector2d& pixels);
  /// Above 1: nearer. Stops before the focus and far away.
  void zoom(double factor);

  const Vec3& focus_mm() const { return focus_mm_; }
  Vec3 eye_mm() const { return focus_mm_ - distance_mm_ * forward(); }
  double distance_mm() const { return distance_mm_; }
  Vec3 forward() const;  ///< unit, away from the eye
  Vec3 right() const;    ///< unit
  Vec3 up() const;       ///< unit

  /// How far before the eye, mm.
  double depth_mm(const Vec3& p_mm) const { return (p_mm - eye_mm()).dot(forward()); }
  /// Meaningful before the eye only.
  Eigen::Vector2d to_pixel(const Vec3& p_mm) const;
  /// Unit direction from the eye through a pixel.
  Vec3 ray(const Eigen::Vector2d& pixel) const;
  /// Where the ray through a pixel has got to at a depth before the eye.
  Vec3 at_depth(const Eigen::Vector2d& pixel, double depth) const;
  double mm_per_pixel(double depth) const;

 private:
  Vec3 focus_mm_ = Vec3::Zero();
  double distance_mm_ = 300.0;
  double azimuth_ = 0.0;    ///< of the eye, from behind to the patient's left, rad
  double elevation_ = 0.0;  ///< of the eye, to the head, rad
  double width_px_ = 1.0;
  double height_px_ = 1.0;
};

}  // namespace spinaltap
