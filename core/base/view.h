#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// A pinhole camera without distortion, in OpenCV's convention: x to the right of the picture, y down, z forward, along
/// the optical axis. The middle of the pixel in column u and row v, both from 0, upper left, is (u, v); a point
/// (x, y, z) mm of the camera's frame falls on u = fx x / z + cx, v = fy y / z + cy.
struct Camera {
  int width = 640;  ///< pixels
  int height = 480;
  double fx = 600.0;  ///< focal lengths, pixels
  double fy = 600.0;
  double cx = 319.5;  ///< where the optical axis meets the picture, pixels; (width - 1) / 2: its middle
  double cy = 239.5;
  /// From the camera's frame to patient LPS, mm: a turn and a shift, [R t; 0 0 0 1]. OpenCV's extrinsic matrix is its
  /// inverse.
  Eigen::Matrix4d to_patient = Eigen::Matrix4d::Identity();

  /// The intrinsic matrix K: [fx 0 cx; 0 fy cy; 0 0 1].
  Mat3 matrix() const;
  /// Where it stands, patient LPS, mm.
  Vec3 eye_mm() const { return to_patient.topRightCorner<3, 1>(); }
  /// The optical axis, patient LPS, unit.
  Vec3 forward() const { return to_patient.block<3, 1>(0, 2); }
  /// What lies at depth `depth_mm` (along the optical axis) in column u and row v, patient LPS, mm.
  Vec3 point_mm(double u, double v, double depth_mm) const;
};

/// A camera at `eye_mm` that has `target_mm` (patient LPS) in the middle of its picture, and `up` upwards in it; square
/// pixels, and `field_of_view_rad` from the left edge of the picture to the right. Throws Error where that is no
/// camera.
Camera look_at(const Vec3& eye_mm, const Vec3& target_mm, const Vec3& up, double field_of_view_rad, int width,
               int height);

/// Rejects sizes that are not 1 to 16384 pixels, focal lengths that are not above 0 or absurd, numbers that are none,
/// and poses that are no turn and shift, or over 10 m away.
void check_camera(const Camera& camera);

/// What a pixel of a view shows, as its mask has it.
enum class Seen : std::uint8_t {
  nothing = 0,
  bone = 1,  ///< the bone's own surface
  wall = 2,  ///< of removed bone: what a bit has laid open
  bit = 3
};

/// What a camera sees: arrays with a number a pixel, or three, rows from the top, C order.
struct View {
  Camera camera;
  /// Height x width: along the optical axis, mm, as depth cameras give it; 0 where there is nothing.
  std::vector<float> depth_mm;
  /// Height x width x 3: of the surface, unit, outward, patient LPS; zeros where there is nothing.
  std::vector<float> normals;
  /// Height x width: Seen.
  std::vector<std::uint8_t> mask;

  /// Where a pixel is in the arrays. `column` from the left, `row` from the top, both from 0.
  std::size_t pixel(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(column);
  }
  /// What is seen there, patient LPS, mm; the eye itself where there is nothing.
  Vec3 point_mm(int column, int row) const {
    return camera.point_mm(column, row, static_cast<double>(depth_mm[pixel(column, row)]));
  }
};

}  // namespace spinaltap
