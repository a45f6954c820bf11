#include "apps/report/slice_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

const Box3 kCrop(Vec3(-40, -30, 100), Vec3(45, 50, 140));

/// A random path in the crop's middle.
DrillPath random_path(std::uint64_t seed) {
  const auto number = [&](std::uint64_t i) { return 2.0 * random_uniform(seed, i) - 1.0; };
  DrillPath path;
  path.entry_mm = Vec3(10 * number(0), 20 + 10 * number(1), 120 + 10 * number(2));
  path.target_mm = Vec3(10 * number(3), -10 + 10 * number(4), 120 + 10 * number(5));
  return path;
}

void expect_right_handed(const SliceFrame& frame) {
  EXPECT_NEAR(frame.right.norm(), 1.0, 1e-12);
  EXPECT_NEAR(frame.down.norm(), 1.0, 1e-12);
  EXPECT_NEAR(frame.right.dot(frame.down), 0.0, 1e-12);
}

TEST(SliceFrame, MapsThereAndBack) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const DrillPath path = random_path(seed);
    for (const SliceFrame& frame :
         {plane_frame(Plane::kAxial, path.entry_mm, kCrop), plane_frame(Plane::kCoronal, path.entry_mm, kCrop),
          plane_frame(Plane::kSagittal, path.entry_mm, kCrop), path_frame(path, kCrop)}) {
      expect_right_handed(frame);
      // 1e-9 mm: rounding of values near 100.
      EXPECT_LT((frame.to_patient(frame.to_pixel(path.target_mm)) - path.target_mm).norm(), 1e-9) << "seed " << seed;
      EXPECT_LT((frame.to_pixel(frame.to_patient(Vec3(7, 9, 11))) - Vec3(7, 9, 11)).norm(), 1e-8) << "seed " << seed;
    }
  }
}

TEST(SliceFrame, CoversTheCropWithLessThanAPixelToSpare) {
  const SliceFrame frame = plane_frame(Plane::kAxial, {0, 0, 120}, kCrop, 0.2);
  EXPECT_EQ(frame.width, 425);   // 85 mm
  EXPECT_EQ(frame.height, 400);  // 80 mm
  const Vec3 corner = frame.to_pixel(Vec3(-40, -30, 120));
  EXPECT_NEAR(corner.x(), -0.5, 1e-9);  // the first pixel's outer edge
  EXPECT_NEAR(corner.y(), -0.5, 1e-9);
  EXPECT_NEAR(frame.origin_mm.z(), 120.0, 1e-12);
}

TEST(SliceFrame, HoldsTheWholePathAndIsTheClosestToAxial) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const DrillPath path = random_path(seed);
    const SliceFrame frame = path_frame(path, kCrop);
    EXPECT_NEAR(frame.to_pixel(path.entry_mm).z(), 0.0, 1e-8) << "seed " << seed;
    EXPECT_NEAR(frame.to_pixel(path.target_mm).z(), 0.0, 1e-8) << "seed " << seed;
    // The tilt of the steepest line in the plane cannot be less than the path's own, and need not be more.
    EXPECT_NEAR(std::abs(frame.into().z()), std::sqrt(1.0 - std::pow(path.direction().z(), 2)), 1e-9)
        << "seed " << seed;
    EXPECT_GT(frame.right.x(), 0.0) << "the patient's left is on the right, seed " << seed;
    EXPECT_GT(frame.down.y(), 0.0) << "posterior is below, seed " << seed;
  }
}

TEST(SliceFrame, ShowsAPathAlongTheBodyInTheSagittalPlane) {
  DrillPath path;
  path.entry_mm = {1, 2, 130};
  path.target_mm = {1, 2, 110};
  const SliceFrame frame = path_frame(path, kCrop);
  EXPECT_TRUE(frame.right.isApprox(Vec3::UnitY(), 1e-12));
  EXPECT_TRUE(frame.down.isApprox(-Vec3::UnitZ(), 1e-12));
}

TEST(SliceFrame, GrowsEvenlyAndStaysInItsPlane) {
  const SliceFrame frame = plane_frame(Plane::kCoronal, {0, 7, 120}, kCrop, 0.5);
  const SliceFrame grown = grown_to(frame, frame.width + 10, frame.height - 5);
  EXPECT_EQ(grown.width, frame.width + 10);
  EXPECT_EQ(grown.height, frame.height);
  const Vec3 p_patient(3, 7, 111);
  EXPECT_TRUE((grown.to_pixel(p_patient) - frame.to_pixel(p_patient)).isApprox(Vec3(5, 0, 0), 1e-9));
}

TEST(SliceFrame, NamesDirectionsInThePatient) {
  EXPECT_EQ(orientation_letters(Vec3::UnitX()), "L");
  EXPECT_EQ(orientation_letters(-Vec3::UnitX()), "R");
  EXPECT_EQ(orientation_letters(Vec3::UnitY()), "P");
  EXPECT_EQ(orientation_letters(-Vec3::UnitY()), "A");
  EXPECT_EQ(orientation_letters(Vec3::UnitZ()), "S");
  EXPECT_EQ(orientation_letters(-Vec3::UnitZ()), "I");
  EXPECT_EQ(orientation_letters(Vec3(0.3, -0.95, 0.0)), "A");
  EXPECT_EQ(orientation_letters(Vec3(0.6, -0.8, 0.0)), "AL");
}

TEST(SliceFrame, RefusesCropsThatMakeNoPicture) {
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), Box3()), Error);
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), kCrop, 0.0), Error);
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), kCrop, 0.001), Error);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(plane_frame(Plane::kAxial, Vec3::Zero(), Box3(Vec3(0, 0, 0), Vec3(1, nan, 1))), Error);
}

}  // namespace
}  // namespace spinaltap
