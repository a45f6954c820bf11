#include "core/base/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3 kEye(30.0, 80.0, -20.0);
const Vec3 kTarget(1.0, -2.0, 3.0);

/// Where a place falls in the picture (column, row) and its depth.
Vec3 seen_at(const Camera& camera, const Vec3& p_mm) {
  const Eigen::Vector4d own = camera.to_patient.inverse() * p_mm.homogeneous();
  const Vec3 pixel = camera.matrix() * own.head<3>();
  return {pixel.x() / pixel.z(), pixel.y() / pixel.z(), own.z()};
}

TEST(Camera, LooksAtItsTargetWithUpUpwardsAndRightToTheRight) {
  const Camera camera = look_at(kEye, kTarget, Vec3::UnitZ(), 0.7, 320, 240);
  EXPECT_NEAR((seen_at(camera, kTarget) - Vec3(159.5, 119.5, (kTarget - kEye).norm())).norm(), 0.0, 1e-9);
  EXPECT_LT(seen_at(camera, kTarget + Vec3::UnitZ()).y(), 119.0) << "rows run downwards";
  const Vec3 right = (kTarget - kEye).cross(Vec3::UnitZ()).normalized();
  EXPECT_GT(seen_at(camera, kTarget + right).x(), 160.0);
}

TEST(Camera, HasItsFieldOfViewFromEdgeToEdge) {
  const Camera camera = look_at(kEye, kTarget, Vec3::UnitZ(), 0.7, 320, 240);
  // Edges are half a pixel beyond the outermost pixels' middles.
  const Vec3 left = (camera.point_mm(-0.5, 119.5, 1.0) - kEye).normalized();
  const Vec3 right = (camera.point_mm(319.5, 119.5, 1.0) - kEye).normalized();
  EXPECT_NEAR(std::acos(left.dot(right)), 0.7, 1e-12);
}

TEST(Camera, TakesDepthsBackToThePlacesTheyAreOf) {
  const Camera camera = look_at(kEye, kTarget, Vec3(0.1, 0.2, 0.9), 0.7, 321, 200);
  for (const Vec3& p_mm : {Vec3(0.0, 0.0, 0.0), Vec3(5.0, -8.0, 12.0), Vec3(-20.0, 10.0, 3.0)}) {
    const Vec3 seen = seen_at(camera, p_mm);
    EXPECT_NEAR((camera.point_mm(seen.x(), seen.y(), seen.z()) - p_mm).norm(), 0.0, 1e-10);
  }
}

TEST(Camera, IsRejectedWhereItIsNone) {
  const auto changed = [](const auto& change) {
    Camera camera = look_at(kEye, kTarget, Vec3::UnitZ(), 0.7, 320, 240);
    change(camera);
    return [camera] { check_camera(camera); };
  };
  const double none = std::nan("");
  EXPECT_THAT(changed([](Camera& c) { c.width = 0; }), ThrowsMessage<Error>(HasSubstr("found 0 x 240")));
  EXPECT_THAT(changed([](Camera& c) { c.height = 20000; }), ThrowsMessage<Error>(HasSubstr("320 x 20000")));
  for (const double f : {none, 0.0, -300.0, 1e300}) {
    EXPECT_THAT(changed([f](Camera& c) { c.fy = f; }), ThrowsMessage<Error>(HasSubstr("focal lengths")));
  }
  EXPECT_THAT(changed([none](Camera& c) { c.cx = none; }), ThrowsMessage<Error>(HasSubstr("middle of the picture")));
  EXPECT_THAT(changed([none](Camera& c) { c.to_patient(0, 3) = none; }), ThrowsMessage<Error>(HasSubstr("an eye")));
  EXPECT_THAT(changed([](Camera& c) { c.to_patient(2, 3) = 1e6; }), ThrowsMessage<Error>(HasSubstr("within 10000 mm")));
  EXPECT_THAT(changed([none](Camera& c) { c.to_patient(1, 1) = none; }), ThrowsMessage<Error>(HasSubstr("a turn")));
  EXPECT_THAT(changed([](Camera& c) { c.to_patient.col(0) *= -1.0; }), ThrowsMessage<Error>(HasSubstr("a turn")))
      << "a mirror is no turn";
  EXPECT_THAT(changed([](Camera& c) { c.to_patient(3, 0) = 0.5; }), ThrowsMessage<Error>(HasSubstr("a turn")));
  EXPECT_THROW(look_at(kEye, kEye, Vec3::UnitZ(), 0.7, 320, 240), Error);
  EXPECT_THROW(look_at(kEye, kEye + Vec3::UnitZ(), Vec3::UnitZ(), 0.7, 320, 240), Error);
  for (const double angle : {0.0, 3.2, none}) EXPECT_THROW(look_at(kEye, kTarget, Vec3::UnitZ(), angle, 9, 9), Error);
}

}  // namespace
}  // namespace spinaltap
