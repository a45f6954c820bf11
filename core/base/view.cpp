#include "core/base/view.h"

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr int kLargestSide = 16384;

void check_size(int width, int height) {
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide) {
    fail("camera: expected 1 to ", kLargestSide, " pixels a side, found ", width, " x ", height);
  }
}

}  // namespace

Mat3 Camera::matrix() const {
  Mat3 k = Mat3::Identity();
  k(0, 0) = fx;
  k(1, 1) = fy;
  k(0, 2) = cx;
  k(1, 2) = cy;
  return k;
}

Vec3 Camera::point_mm(double u, double v, double depth_mm) const {
  const Vec3 seen_mm(depth_mm * (u - cx) / fx, depth_mm * (v - cy) / fy, depth_mm);
  return to_patient.topLeftCorner<3, 3>() * seen_mm + eye_mm();
}

Camera look_at(const Vec3& eye_mm, const Vec3& target_mm, const Vec3& up, double field_of_view_rad, int width,
               int height) {
  constexpr double kParallel = 1e-9;
  check_size(width, height);
  if (!(field_of_view_rad > 0.0 && field_of_view_rad < std::numbers::pi)) {
    fail("camera: expected a field of view above 0 and below pi rad, found ", field_of_view_rad);
  }
  const Vec3 forward = (target_mm - eye_mm).normalized();
  const Vec3 right = forward.cross(up.normalized());
  if (!(right.norm() > kParallel)) {
    fail("camera: expected an eye apart from its target and an up direction across the view, found eye ",
         eye_mm.transpose(), ", target ", target_mm.transpose(), ", up ", up.transpose());
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.5 * width / std::tan(0.5 * field_of_view_rad);
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.to_patient.block<3, 1>(0, 0) = right.normalized();
  camera.to_patient.block<3, 1>(0, 1) = forward.cross(right.normalized());
  camera.to_patient.block<3, 1>(0, 2) = forward;
  camera.to_patient.block<3, 1>(0, 3) = eye_mm;
  check_camera(camera);
  return camera;
}

void check_camera(const Camera& camera) {
  constexpr double kShortest = 1e-3;
  constexpr double kLongest = 1e9;
  constexpr double kFurthestMm = 1e4;
  constexpr double kNotATurn = 1e-6;
  check_size(camera.width, camera.height);
  const auto is_focal = [&](double f) { return f >= kShortest && f <= kLongest; };
  if (!is_focal(camera.fx) || !is_focal(camera.fy)) {
    fail("camera: expected focal lengths from ", kShortest, " to ", kLongest, " pixels, found fx ", camera.fx, ", fy ",
         camera.fy);
  }
  if (!(std::abs(camera.cx) <= kLongest && std::abs(camera.cy) <= kLongest)) {
    fail("camera: expected a finite middle of the picture, found cx ", camera.cx, ", cy ", camera.cy);
  }
  const Mat3 turn = camera.to_patient.topLeftCorner<3, 3>();
  const bool is_turn =
      turn.allFinite() && (turn * turn.transpose() - Mat3::Identity()).norm() < kNotATurn && turn.determinant() > 0.0;
  if (!is_turn || camera.to_patient.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    fail("camera: expected a pose [R t; 0 0 0 1] with a turn R, found\n", camera.to_patient);
  }
  if (!(camera.eye_mm().norm() <= kFurthestMm)) {
    fail("camera: expected an eye within ", kFurthestMm, " mm of the patient's origin, found ",
         camera.eye_mm().transpose());
  }
}

}  // namespace spinaltap
