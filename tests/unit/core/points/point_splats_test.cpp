// Compiled with optimisation: long loops of its own.

#include "core/points/point_splats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/engine/drill_engine.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using test::Ball;

const Ball kFarBall{Vec3(-31.0, 40.0, 212.0), 8.0};
constexpr double kSplatStepMm = 0.2;
const DrillBit kSplatBit{3.0, 40.0, 5.0};

DrillPath radial_path() {
  const Vec3 direction = Vec3(0.36, 0.48, -0.8);
  return {"p", kFarBall.centre_mm - kFarBall.radius_mm * direction, kFarBall.centre_mm + 3.0 * direction, kSplatBit};
}

PointVolume ball_volume() {
  PointVolume volume(radial_path(), {.radius_mm = 3.0, .spacing_mm = kSplatStepMm, .lead_in_mm = 1.0});
  fill_volume(volume, [](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      distance_mm[n] = static_cast<float>(kFarBall.distance_mm(points_mm[n]));
      hu[n] = 400.0F;
    }
  });
  return volume;
}

/// The true distance, not r² - R².
test::FormulaField distance_field() {
  return {[](const Vec3& p) { return kFarBall.distance_mm(p); },
          [](const Vec3& p) -> Vec3 { return (p - kFarBall.centre_mm).normalized(); }};
}

void drill_to(PointVolume& volume, const Pose& pose) {
  const auto engine = make_ring_engine(volume, kSplatBit, Material());
  engine->step(pose);
}

TEST(PointSplats, ShowTheBonesSurfaceFirst) {
  const PointVolume volume = ball_volume();
  const PointSplats splats(volume, distance_field());
  ASSERT_EQ(splats.splats().size(), volume.point_count());
  std::size_t shown = 0;
  for (std::size_t n = 0; n < volume.point_count(); ++n) {
    const PointSplat& splat = splats.splats()[n];
    const auto disc = static_cast<int>(n / volume.pattern().point_count());
    const std::size_t index = n % volume.pattern().point_count();
    const Vec3 p_mm = splat.position_mm.cast<double>();
    ASSERT_LT((p_mm - volume.frame().to_patient(volume.point_in_path_mm(disc, index))).norm(), 2e-5);
    const double depth_mm = -kFarBall.distance_mm(p_mm);
    if (std::abs(depth_mm) < 1e-4 || std::abs(depth_mm - kSplatStepMm) < 1e-4) continue;
    ASSERT_EQ(splat.alpha > 0.0F, depth_mm > 0.0 && depth_mm < kSplatStepMm) << depth_mm;
    if (splat.alpha == 0.0F) continue;
    ++shown;
    ASSERT_GT(splat.normal.cast<double>().dot((p_mm - kFarBall.centre_mm).normalized()), 0.9999);
    ASSERT_EQ(splat.hu, 400);
  }
  // A cap of 3 mm within a layer of one spacing.
  EXPECT_GT(shown, 500U);
}

TEST(PointSplats, LeaveNoGapsInTheSurface) {
  const PointVolume volume = ball_volume();
  const PointSplats splats(volume, distance_field());
  const DrillPath planned = radial_path();
  for (const Vec3& p_mm : kFarBall.surface_points(0.1)) {
    const Vec3 p = volume.frame().to_path(p_mm);
    // The points end at 2.8 mm: 15 rings, the centre counted.
    if (p.head<2>().norm() > 2.7 || p.z() > 4.0) continue;
    const Vec3 normal = (p_mm - kFarBall.centre_mm).normalized();
    double nearest_mm = 1e9;  // as seen along the normal
    for (const PointSplat& splat : splats.splats()) {
      const Vec3 off_mm = splat.position_mm.cast<double>() - p_mm;
      if (splat.alpha == 0.0F || off_mm.norm() > 0.5) continue;
      nearest_mm = std::min(nearest_mm, (off_mm - off_mm.dot(normal) * normal).norm());
    }
    ASSERT_LT(nearest_mm, static_cast<double>(splats.splats()[0].radius_mm));
  }
}

TEST(PointSplats, BringToLightWhatLiesBesideTheHoleAndHideWhatIsGone) {
  PointVolume volume = ball_volume();
  PointSplats splats(volume, distance_field());
  const Pose pose{kFarBall.centre_mm, radial_path().direction()};
  drill_to(volume, pose);
  EXPECT_GT(splats.update(volume, kSplatBit, pose), 1000U);
  const BitProfile bit(kSplatBit);
  std::size_t wall = 0;
  for (std::size_t n = 0; n < volume.point_count(); ++n) {
    const PointSplat& splat = splats.splats()[n];
    const auto disc = static_cast<int>(n / volume.pattern().point_count());
    const bool is_occupied = volume.is_occupied(disc, n % volume.pattern().point_count());
    if (!is_occupied) {
      ASSERT_EQ(splat.alpha, 0.0F);
      continue;
    }
    const Vec3 p_mm = splat.position_mm.cast<double>();
    const double from_bit_mm = bit_distance_mm(bit, pose, p_mm);
    const bool is_surface = kFarBall.distance_mm(p_mm) > -kSplatStepMm - 1e-4;
    // A neighbour lies within 1.5 spacings in its disc, or in the next disc above or below such a place.
    if (from_bit_mm < 0.6 * kSplatStepMm && p_mm.dot(pose.axis) < (pose.tip_mm - 0.3 * pose.axis).dot(pose.axis)) {
      ASSERT_EQ(splat.alpha, 1.0F) << from_bit_mm;
    }
    if (!is_surface && from_bit_mm > 2.0 * kSplatStepMm) {
      ASSERT_EQ(splat.alpha, 0.0F) << from_bit_mm;
    }
    if (splat.alpha == 0.0F || is_surface) continue;
    ++wall;
    const Vec3 off = p_mm - pose.tip_mm;
    const Vec3 outward = off - off.dot(pose.axis) * pose.axis;
    ASSERT_NEAR(splat.normal.norm(), 1.0F, 1e-5F);
    // Faces the hole; before the tip it faces the tip.
    if (off.dot(pose.axis) > -0.5) continue;
    ASSERT_LT(splat.normal.cast<double>().dot(outward.normalized()), -0.9);
  }
  // 8 mm of a hole of 3 mm, less the cone's half.
  EXPECT_GT(wall, 1000U);
  EXPECT_EQ(splats.update(volume, kSplatBit, pose), 0U) << "nothing new";
}

TEST(PointSplats, AreTheSameInOneGoAndInManySteps) {
  PointVolume volume = ball_volume();
  PointSplats stepwise(volume, distance_field());
  const PointSplats start = stepwise;
  for (double back_mm = 8.0; back_mm >= 0.0; back_mm -= 0.5) {
    const Pose pose{kFarBall.centre_mm - back_mm * radial_path().direction(), radial_path().direction()};
    drill_to(volume, pose);
    stepwise.update(volume, kSplatBit, pose);
  }
  PointSplats at_once = start;
  at_once.update(volume, kSplatBit, {kFarBall.centre_mm, radial_path().direction()});
  for (std::size_t n = 0; n < volume.point_count(); ++n) {
    ASSERT_EQ(stepwise.splats()[n].alpha, at_once.splats()[n].alpha);
  }
}

TEST(PointSplats, RejectAnotherVolume) {
  PointSplats splats(ball_volume(), distance_field());
  const PointVolume other(radial_path(), {.radius_mm = 2.0, .spacing_mm = kSplatStepMm});
  EXPECT_THROW(splats.update(other, kSplatBit, {}), Error);
}

TEST(SplatsPly, HoldsWhatIsShown) {
  std::vector<PointSplat> splats(3);
  splats[0] = {{1.0F, 2.0F, 3.0F}, {0.0F, 0.0F, 1.0F}, 0.25F, 1.0F, 800};
  splats[2] = {{4.0F, 5.0F, 6.0F}, {1.0F, 0.0F, 0.0F}, 0.5F, 0.5F, -700};
  const std::string ply = splats_ply(splats);
  const std::size_t end = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("element vertex 2\n"), std::string::npos);
  constexpr std::size_t kRow = 7 * sizeof(float) + 4 + sizeof(std::int16_t);
  ASSERT_EQ(ply.size(), end + 2 * kRow);
  float numbers[7];
  std::memcpy(numbers, ply.data() + end + kRow, sizeof numbers);
  EXPECT_EQ(std::vector<float>(numbers, numbers + 7), (std::vector<float>{4.0F, 5.0F, 6.0F, 1.0F, 0.0F, 0.0F, 0.5F}));
  const auto byte = [&](std::size_t row, std::size_t n) {
    return static_cast<int>(static_cast<unsigned char>(ply[end + row * kRow + sizeof numbers + n]));
  };
  EXPECT_EQ(byte(0, 0), 255);  // cortex is white
  EXPECT_EQ(byte(0, 3), 255);
  EXPECT_GT(byte(1, 0), 2 * byte(1, 1));  // cancellous bone is red
  EXPECT_EQ(byte(1, 3), 128);
  std::int16_t hu = 0;
  std::memcpy(&hu, ply.data() + end + kRow + sizeof numbers + 4, sizeof hu);
  EXPECT_EQ(hu, -700);
}

}  // namespace
}  // namespace spinaltap
