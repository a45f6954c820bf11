#include "core/points/point_volume.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

DrillPath straight_path(double length_mm) { return {"test", Vec3(1, 2, 3), Vec3(1, 2, 3 + length_mm), {}}; }

/// A path of 37.8 mm along no axis, a metre and more from the patient frame's origin.
DrillPath far_path() {
  const Vec3 entry_mm(1234.5, -987.6, 1500.3);
  return {"far", entry_mm, entry_mm + 37.8 * Vec3(-0.36, 0.48, -0.8), {}};
}

/// A ball of bone; its CT number grows from the centre outwards.
BoneSampler bone_ball(const Vec3& centre_mm, double radius_mm) {
  return [=](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      const double r_mm = (points_mm[i] - centre_mm).norm();
      distance_mm[i] = static_cast<float>(r_mm - radius_mm);
      hu[i] = static_cast<float>(100.0 * r_mm);
    }
  };
}

TEST(PointVolume, HoldsAsManyPointsAsThePaperSays) {
  const PointVolume sample(far_path(), {.radius_mm = 3.0, .spacing_mm = 0.1});
  EXPECT_EQ(sample.disc_count(), 378);
  EXPECT_EQ(sample.point_count(), 986'958U);
  EXPECT_EQ(sample.occupied_count(), 986'958U);
  EXPECT_EQ(PointVolume(straight_path(10.0), {.radius_mm = 4.0, .spacing_mm = 0.1}).point_count(), 468'100U);
  EXPECT_EQ(PointVolume(straight_path(10.0), {.radius_mm = 4.0, .spacing_mm = 0.05}).point_count(), 3'792'200U);
}

TEST(PointVolume, SharesTheCylindersVolumeAmongItsPoints) {
  const PointVolume volume(straight_path(10.0), {.radius_mm = 3.0, .spacing_mm = 0.1});
  double disc_mm3 = 0.0;
  for (int ring = 0; ring < volume.pattern().ring_count(); ++ring) {
    disc_mm3 += static_cast<double>(DiscPattern::ring_size(ring)) * volume.pattern().point_volume_mm3(ring);
  }
  // The outermost ring lies a spacing within the radius and stands for half a spacing beyond itself.
  EXPECT_NEAR(disc_mm3 * volume.disc_count(), std::numbers::pi * 2.95 * 2.95 * 10.0, 1e-9);
}

TEST(PointVolume, StartsAtTheEntryAndEndsOneSpacingBeforeTheTarget) {
  const DrillPath path = far_path();
  const PointVolume volume(path, {.radius_mm = 3.0, .spacing_mm = 0.1});
  // 1e-9 mm: a double holds 1,500 mm to 2e-13 mm, and a handful of operations follow.
  EXPECT_LT((volume.frame().to_patient(volume.point_in_path_mm(0, 0)) - path.entry_mm).norm(), 1e-9);
  const Vec3 last_mm = volume.frame().to_patient(volume.point_in_path_mm(377, 0));
  EXPECT_LT((last_mm - (path.target_mm - 0.1 * path.direction())).norm(), 1e-9);
}

TEST(PointVolume, StartsBeforeTheEntryByTheLeadIn) {
  const DrillPath path = far_path();
  const PointVolume volume(path, {.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 4.2});
  EXPECT_EQ(volume.disc_count(), 420);
  EXPECT_EQ(volume.lead_in_mm(), 4.2);
  EXPECT_LT((volume.frame().to_patient(volume.point_in_path_mm(42, 0)) - path.entry_mm).norm(), 1e-9);
}

TEST(PointVolume, KeepsPositionsFarBelowAMicronFarFromTheOrigin) {
  const DrillPath path = far_path();
  const PointVolume volume(path, {.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 5.0});
  const Vec3 direction = path.direction();
  for (int disc = 0; disc < volume.disc_count(); disc += 13) {
    for (int ring = 0; ring < volume.pattern().ring_count(); ++ring) {
      const std::size_t i = DiscPattern::ring_start(ring) + DiscPattern::ring_size(ring) / 3;
      const Vec3 p_path = volume.point_in_path_mm(disc, i);
      const Vec3 p_patient = volume.frame().to_patient(p_path);
      // Depth and distance from the path's line are what the patient frame says, and the way back is exact.
      const Vec3 from_entry_mm = p_patient - path.entry_mm;
      const double depth_mm = from_entry_mm.dot(direction);
      EXPECT_NEAR(depth_mm, 0.1 * disc - 5.0, 1e-9);
      EXPECT_NEAR((from_entry_mm - depth_mm * direction).norm(), 0.1 * ring, 1e-9);
      EXPECT_LT((volume.frame().to_path(p_patient) - p_path).norm(), 1e-9);
    }
  }
}

TEST(PointVolume, RejectsSizesWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DrillPath path = straight_path(10.0);
  for (const double bad : {nan, 0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(PointVolume(path, {.radius_mm = bad}), Error) << bad;
    EXPECT_THROW(PointVolume(path, {.spacing_mm = bad}), Error) << bad;
  }
  EXPECT_THROW(PointVolume(path, {.lead_in_mm = nan}), Error);
  EXPECT_THROW(PointVolume(path, {.lead_in_mm = -0.1}), Error);
  EXPECT_THROW(PointVolume(path, {.lead_in_mm = 101.0}), Error);
  // 3 million points a disc in 40,000 discs are over 2^32.
  EXPECT_THROW(PointVolume(straight_path(400.0), {.radius_mm = 10.0, .spacing_mm = 0.01}), Error);
  EXPECT_THROW(PointVolume(straight_path(0.0), {}), Error);
  EXPECT_THROW(PointVolume(straight_path(nan), {}), Error);
  EXPECT_THROW(PointVolume(straight_path(501.0), {}), Error);
}

TEST(FillVolume, KeepsWhatLiesInTheBallWithItsNumbers) {
  const DrillPath path = far_path();
  const Vec3 centre_mm = path.entry_mm + 2.0 * path.direction();
  PointVolume volume(path, {.radius_mm = 3.0, .spacing_mm = 0.2});
  fill_volume(volume, bone_ball(centre_mm, 2.5));
  std::size_t occupied = 0;
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      const Vec3 p_mm = volume.frame().to_patient(volume.point_in_path_mm(disc, i));
      const double r_mm = (p_mm - centre_mm).norm();
      if (std::abs(r_mm - 2.5) > 1e-6) {  // float distances
        ASSERT_EQ(volume.is_occupied(disc, i), r_mm < 2.5) << disc << " " << i;
      }
      if (!volume.is_occupied(disc, i)) continue;
      ++occupied;
      ASSERT_NEAR(volume.hu(disc, i), 100.0 * r_mm, 0.5 + 1e-4);
    }
  }
  EXPECT_EQ(volume.occupied_count(), occupied);
  EXPECT_GT(occupied, 1000U);
  EXPECT_LT(occupied, volume.point_count() / 2);
}

TEST(FillVolume, GivesTheSameAtAnyNumberOfThreads) {
  const DrillPath path = far_path();
  const BoneSampler bone = bone_ball(path.entry_mm + 3.0 * path.direction(), 3.3);
  PointVolume one(path, {.radius_mm = 3.0, .spacing_mm = 0.2});
  PointVolume two = one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    fill_volume(one, bone);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  fill_volume(two, bone);
  EXPECT_TRUE(std::ranges::equal(std::as_const(one).occupancy_words(), std::as_const(two).occupancy_words()));
  for (int disc = 0; disc < one.disc_count(); ++disc) {
    for (std::size_t i = 0; i < one.pattern().point_count(); ++i) ASSERT_EQ(one.hu(disc, i), two.hu(disc, i));
  }
}

TEST(FillVolume, ClampsNumbersThatSixteenBitsCannotHold) {
  PointVolume volume(straight_path(0.2), {.radius_mm = 0.2, .spacing_mm = 0.1});
  const auto fill_with = [&](float number) {
    fill_volume(volume, [=](std::span<const Vec3>, std::span<float> distance_mm, std::span<float> hu) {
      std::ranges::fill(distance_mm, -1.0F);
      std::ranges::fill(hu, number);
    });
    return volume.hu(0, 3);
  };
  EXPECT_EQ(fill_with(1e9F), 32767);
  EXPECT_EQ(fill_with(-1e9F), -32768);
  EXPECT_EQ(fill_with(12.6F), 13);
}

TEST(FillVolume, EmptiesPointsWithoutADistanceAndRejectsOccupiedOnesWithoutANumber) {
  PointVolume volume(straight_path(0.2), {.radius_mm = 0.2, .spacing_mm = 0.1});
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  const auto fill_with = [&](float distance, float number) {
    fill_volume(volume, [=](std::span<const Vec3>, std::span<float> distance_mm, std::span<float> hu) {
      std::ranges::fill(distance_mm, distance);
      std::ranges::fill(hu, number);
    });
  };
  fill_with(kNoNumber, kNoNumber);
  EXPECT_EQ(volume.occupied_count(), 0U);
  EXPECT_EQ(volume.hu(0, 0), 0);
  EXPECT_THROW(fill_with(-1.0F, kNoNumber), Error);
}

TEST(FillVolume, StopsWhenItIsCancelled) {
  PointVolume volume(straight_path(1.0), {.radius_mm = 0.2, .spacing_mm = 0.1});
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(fill_volume(volume, bone_ball(Vec3::Zero(), 1.0), progress), Cancelled);
}

}  // namespace
}  // namespace spinaltap
