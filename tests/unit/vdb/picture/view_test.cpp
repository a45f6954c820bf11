#include "vdb/picture/view.h"
#include "core/tool/bit_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/made_bone.h"

namespace spinaltap {
namespace {

using test::kBall;

constexpr double kViewedVoxelMm = 0.25;
/// How far the zero of tri-linear values may lie from the ball: voxel² (1/r + 1/r) / 8.
constexpr double kOffBallMm = kViewedVoxelMm * kViewedVoxelMm * 0.2 / 8.0;

/// The ball's own distances, not baked.
const BoneModel& viewed_ball() {
  static const BoneModel bone = test::made_bone([](const Vec3& p) { return kBall.distance_mm(p); },
                                                test::grown(kBall.bounds_mm(), 2.0), kViewedVoxelMm);
  return bone;
}

Camera camera_from(const Vec3& from, double away_mm = 60.0, int width = 160, int height = 120) {
  return look_at(kBall.centre_mm + away_mm * from.normalized(), kBall.centre_mm, Vec3(0.1, 0.2, 1.0), 0.5, width,
                 height);
}

const Vec3 kAskew(0.6, 0.7, 0.2);
const DrillBit kViewedBit{4.0, 30.0, 3.0};

/// Into the ball, 4 mm beside the middle, 8 mm deep.
struct StraightWay {
  Pose start, end;
};
StraightWay way_into_ball() {
  const Vec3 axis = -Vec3(0.5, 0.8, 0.3).normalized();
  const Vec3 aside = axis.cross(Vec3::UnitZ()).normalized();
  const Vec3 entry_mm = kBall.centre_mm - 10.0 * axis + 3.0 * aside;
  return {{entry_mm - 3.0 * axis, axis}, {entry_mm + 8.0 * axis, axis}};
}

/// The ball without what the bit took on that way.
const BoneModel& drilled_view_ball() {
  static const BoneModel bone =
      test::without_hole(viewed_ball(), kViewedBit, way_into_ball().start, way_into_ball().end);
  return bone;
}

/// Distance along a ray to a ball, from outside; infinite where it is missed.
double to_ball_mm(const Vec3& start_mm, const Vec3& direction) {
  const Vec3 from = start_mm - kBall.centre_mm;
  const double b = from.dot(direction);
  const double discriminant = b * b - from.squaredNorm() + kBall.radius_mm * kBall.radius_mm;
  return discriminant < 0.0 ? std::numeric_limits<double>::infinity() : -b - std::sqrt(discriminant);
}

Vec3 normal_at(const View& view, std::size_t pixel) {
  return Vec3(static_cast<double>(view.normals[3 * pixel]), static_cast<double>(view.normals[3 * pixel + 1]),
              static_cast<double>(view.normals[3 * pixel + 2]));
}

template <class Visit>
void for_each_pixel(const View& view, const Visit& visit) {
  for (int row = 0; row < view.camera.height; ++row) {
    for (int column = 0; column < view.camera.width; ++column) visit(column, row, view.pixel(column, row));
  }
}

TEST(ViewBone, SeesABallWhereItIs) {
  const View view = view_bone(viewed_ball(), camera_from(kAskew));
  const Vec3 eye_mm = view.camera.eye_mm();
  std::size_t seen = 0;
  for_each_pixel(view, [&](int column, int row, std::size_t pixel) {
    const Vec3 direction = (view.camera.point_mm(column, row, 1.0) - eye_mm).normalized();
    const double way_mm = to_ball_mm(eye_mm, direction);
    const Vec3 normal = (eye_mm + way_mm * direction - kBall.centre_mm).normalized();
    const double facing = std::isfinite(way_mm) ? -normal.dot(direction) : 0.0;
    // Rays that graze the ball may miss that of the voxels.
    constexpr double kGrazing = 0.1;
    if (facing == 0.0 && view.mask[pixel] == 0) {
      EXPECT_EQ(view.depth_mm[pixel], 0.0F);
      EXPECT_EQ(normal_at(view, pixel), Vec3::Zero());
    }
    if (facing < kGrazing) return;
    ++seen;
    ASSERT_EQ(view.mask[pixel], static_cast<std::uint8_t>(Seen::bone));
    const double depth_mm = way_mm * direction.dot(view.camera.forward());
    EXPECT_NEAR(static_cast<double>(view.depth_mm[pixel]), depth_mm, 1.5 * kOffBallMm / facing + 1e-5);
    EXPECT_LT(std::acos(std::min(1.0, normal_at(view, pixel).dot(normal))), 0.5 * kDegree);
  });
  // A ball of radius 10 at 60 mm: its outline is a circle of f r / sqrt(d² - r²).
  const double outline_px = view.camera.fx * 10.0 / std::sqrt(3500.0);
  EXPECT_NEAR(static_cast<double>(seen), std::numbers::pi * outline_px * outline_px, 0.03 * static_cast<double>(seen));
}

TEST(ViewBone, ReprojectsOntoTheGridsOwnSurface) {
  const View view = view_bone(viewed_ball(), camera_from(kAskew));
  std::vector<Vec3> points_mm;
  for_each_pixel(view, [&](int column, int row, std::size_t pixel) {
    if (view.mask[pixel] != 0) points_mm.push_back(view.point_mm(column, row));
  });
  std::vector<float> distance_mm(points_mm.size());
  viewed_ball().sample(points_mm, distance_mm, {});
  double sum_mm = 0.0;
  for (const float one : distance_mm) sum_mm += std::abs(static_cast<double>(one));
  // Depths are floats: 4 µm / 1000 at 60 mm.
  EXPECT_LT(sum_mm / static_cast<double>(points_mm.size()), 1e-5);
}

TEST(ViewBone, SeesTheWallsOfAHoleAndNothingThatWasRemoved) {
  const StraightWay way = way_into_ball();
  const Camera eye = camera_from(-way.end.axis + 0.15 * Vec3::UnitZ());
  const View view = view_bone(drilled_view_ball(), eye);
  // The grid is tri-linear: half a voxel off where the tip and the edge behind it bend within a voxel, and
  // voxel² / 8 r elsewhere, with r = 2 mm.
  const double wall_mm = 0.006;
  const double edge_mm = 0.5 * kViewedVoxelMm;
  const BitProfile profile = BitProfile(kViewedBit).lengthened((way.end.tip_mm - way.start.tip_mm).norm());
  std::size_t walls = 0, beside = 0;
  double worst = 1.0;
  for_each_pixel(view, [&](int column, int row, std::size_t pixel) {
    if (view.mask[pixel] == 0) return;
    const Vec3 p_mm = view.point_mm(column, row);
    const double bit_mm = bit_distance_mm(profile, way.end, p_mm);
    ASSERT_GT(bit_mm, -edge_mm) << "what was removed is not seen";
    if (view.mask[pixel] == static_cast<std::uint8_t>(Seen::bone)) {
      EXPECT_NEAR(kBall.distance_mm(p_mm), 0.0, 2.0 * kOffBallMm + 0.001);
      ++beside;
      return;
    }
    ASSERT_EQ(view.mask[pixel], static_cast<std::uint8_t>(Seen::wall));
    ++walls;
    EXPECT_LT(std::abs(bit_mm), edge_mm);
    EXPECT_LT(kBall.distance_mm(p_mm), 2.0 * kOffBallMm);
    // Out of the bone: into the hole.
    const Vec3 from_tip_mm = p_mm - way.end.tip_mm;
    const double back_mm = -from_tip_mm.dot(way.end.axis);
    if (back_mm < kViewedBit.tip_length_mm + 1.0) return;
    EXPECT_LT(std::abs(bit_mm), wall_mm);
    const Vec3 inward = -(from_tip_mm + back_mm * way.end.axis).normalized();
    worst = std::min(worst, normal_at(view, pixel).dot(inward));
  });
  EXPECT_GT(walls, 100U);
  EXPECT_GT(beside, 1000U);
  EXPECT_GT(worst, std::cos(0.05)) << "of the cylinder's normals";
}

TEST(ViewBone, SeesTheSameWhileTheHoleIsDrilled) {
  const StraightWay way = way_into_ball();
  HoleCutter cutter(viewed_ball());
  cutter.add(DrilledHole{kViewedBit, {{way.start, way.end}}});
  const Camera eye = camera_from(-way.end.axis);
  const View drilling = view_bone(cutter.hole(), eye), drilled = view_bone(cutter.bone(), eye);
  EXPECT_EQ(drilling.mask, drilled.mask);
  EXPECT_EQ(drilling.depth_mm, drilled.depth_mm);
  EXPECT_EQ(drilling.normals, drilled.normals);
  EXPECT_GT(std::count(drilling.mask.begin(), drilling.mask.end(), static_cast<std::uint8_t>(Seen::wall)), 100);
}

TEST(ViewBone, SeesTheBitOnItsOwnSurfaceInFrontOfWhatItHides) {
  const StraightWay way = way_into_ball();
  const View view = view_bone(drilled_view_ball(), camera_from(Vec3(0.1, 0.9, 0.6)), RenderedBit{kViewedBit, way.end});
  const View without = view_bone(drilled_view_ball(), view.camera);
  const BitProfile profile(kViewedBit);
  std::size_t bits = 0;
  for_each_pixel(view, [&](int column, int row, std::size_t pixel) {
    if (view.mask[pixel] != static_cast<std::uint8_t>(Seen::bit)) {
      EXPECT_EQ(view.mask[pixel], without.mask[pixel]);
      EXPECT_EQ(view.depth_mm[pixel], without.depth_mm[pixel]);
      return;
    }
    ++bits;
    EXPECT_NEAR(bit_distance_mm(profile, way.end, view.point_mm(column, row)), 0.0, 1e-4);
    EXPECT_NEAR(normal_at(view, pixel).norm(), 1.0, 1e-6);
    EXPECT_LT(normal_at(view, pixel).dot(view.camera.point_mm(column, row, 1.0) - view.camera.eye_mm()), 1e-3);
    if (without.mask[pixel] != 0) {
      EXPECT_LT(view.depth_mm[pixel], without.depth_mm[pixel] + 1e-3F);
    }
  });
  EXPECT_GT(bits, 300U);
}

TEST(ViewBone, LooksOutOfAHoleItStandsIn) {
  const StraightWay way = way_into_ball();
  const Vec3 in_hole_mm = way.end.tip_mm - 5.0 * way.end.axis;
  const Vec3 aside = way.end.axis.cross(Vec3::UnitZ()).normalized();
  const View view = view_bone(drilled_view_ball(), look_at(in_hole_mm, in_hole_mm + aside, way.end.axis, 0.3, 32, 24));
  EXPECT_TRUE(std::all_of(view.mask.begin(), view.mask.end(), [](std::uint8_t seen) { return seen == 2; }));
  EXPECT_NEAR(static_cast<double>(view.depth_mm[view.pixel(16, 12)]), 2.0, 0.05);
  const Camera outward = look_at(in_hole_mm, in_hole_mm - way.end.axis, aside, 0.1, 32, 24);
  const View sky = view_bone(drilled_view_ball(), outward);
  EXPECT_EQ(std::count(sky.mask.begin(), sky.mask.end(), 0), 32 * 24);
}

TEST(ViewBone, SeesNothingOfSolidsItStandsIn) {
  const RenderedBit bit{kViewedBit, {kBall.centre_mm, -Vec3::UnitZ()}};
  const Camera inside =
      look_at(kBall.centre_mm + Vec3::UnitZ(), kBall.centre_mm + 9.0 * Vec3::UnitX(), Vec3::UnitZ(), 1.0, 32, 24);
  const View view = view_bone(viewed_ball(), inside, bit);
  EXPECT_EQ(std::count(view.mask.begin(), view.mask.end(), 0), 32 * 24);
}

TEST(ViewBone, HasTheSameBitsAtOneAndManyThreads) {
  const StraightWay way = way_into_ball();
  const RenderedBit bit{kViewedBit, way.end};
  const View many = view_bone(drilled_view_ball(), camera_from(kAskew), bit);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const View alone = view_bone(drilled_view_ball(), camera_from(kAskew), bit);
  EXPECT_EQ(alone.mask, many.mask);
  EXPECT_EQ(std::memcmp(alone.depth_mm.data(), many.depth_mm.data(), many.depth_mm.size() * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(alone.normals.data(), many.normals.data(), many.normals.size() * sizeof(float)), 0);
}

TEST(ViewBone, RejectsWhatIsNoCameraAndNoBit) {
  Camera blind = camera_from(kAskew);
  blind.fx = std::nan("");
  EXPECT_THROW(view_bone(viewed_ball(), blind), Error);
  EXPECT_THROW(view_bone(viewed_ball(), camera_from(kAskew), RenderedBit{{-1.0, 10.0, 2.0}, {}}), Error);
}

}  // namespace
}  // namespace spinaltap
