#include "core/engine/volume_segments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// 20 mm, from 5 mm outside a wall of bone into it.
DrillPath wall_path() {
  const Vec3 direction = Vec3(-0.3, -0.93, 0.2).normalized();
  const Vec3 entry(31, 212, -618);
  return {"", entry, entry + 20.0 * direction, {2.0, 30.0, 2.0}};
}

/// Bone from `depth_mm` beyond the entry on.
BoneSampler wall(double depth_mm) {
  return [depth_mm](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      distance_mm[i] =
          static_cast<float>(depth_mm - (points_mm[i] - wall_path().entry_mm).dot(wall_path().direction()));
    }
    for (float& number : hu) number = 300.0F;
  };
}

TEST(VolumeSegments, AreFineAtTheSurfaceAndBeforeTheTarget) {
  const auto segments = fine_near_surface(wall_path(), 3.0, wall(5.0), 1.0, 2.0, 0.1, 0.2);
  ASSERT_EQ(segments.size(), 4U);
  EXPECT_NEAR(segments[0].begin_mm, -3.0, 1e-12);
  // Whole layers of a coarse spacing, around the middle of the one that the surface lies in.
  constexpr double kLayersMm = 1.5 * 0.2 + 1e-9;
  EXPECT_NEAR(segments[1].begin_mm, 4.0, kLayersMm);
  EXPECT_NEAR(segments[1].end_mm, 6.0, kLayersMm);
  EXPECT_NEAR(segments[3].begin_mm, 18.0, 0.2);
  EXPECT_NEAR(segments[3].end_mm, 20.0, 1e-12);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(segments[n].spacing_mm, n % 2 == 0 ? 0.2 : 0.1);
    if (n > 0) {
      EXPECT_EQ(segments[n].begin_mm, segments[n - 1].end_mm);
    }
  }
}

TEST(VolumeSegments, StandForTheWholeCylinderOnce) {
  const std::vector<VolumeSegment> segments{{-3.0, 4.0, 0.2}, {4.0, 6.0, 0.1}, {6.0, 20.0, 0.25}};
  double depth_mm = -3.0;
  for (const PointVolume& volume : make_segments(wall_path(), segments, {.radius_mm = 2.0})) {
    const double spacing_mm = volume.pattern().spacing_mm();
    for (const int disc : {0, volume.disc_count() - 1}) {
      const Vec3 centre = volume.frame().to_patient(volume.point_in_path_mm(disc, 0)) - wall_path().entry_mm;
      const double at_mm = depth_mm + (disc + 0.5) * spacing_mm;  // the middle of the disc's layer
      EXPECT_NEAR((centre - at_mm * wall_path().direction()).norm(), 0.0, 1e-9);
    }
    depth_mm += volume.disc_count() * spacing_mm;
  }
  EXPECT_NEAR(depth_mm, 20.0, 1e-9);
}

TEST(VolumeSegments, AreDrilledByOneJointEngine) {
  auto volumes = make_segments(wall_path(), {{-3.0, 4.0, 0.2}, {4.0, 20.0, 0.1}}, {.radius_mm = 2.0});
  std::vector<std::unique_ptr<DrillEngine>> engines;
  std::size_t before = 0;
  for (PointVolume& volume : volumes) {
    before += volume.occupied_count();
    engines.push_back(make_ring_engine(volume, wall_path().bit, {}));
  }
  const auto engine = make_joint_engine(std::move(engines));
  std::size_t removed = 0;
  for (int n = 0; n <= 230; ++n) {
    removed += engine->step({wall_path().entry_mm + (0.1 * n - 3.0) * wall_path().direction(), wall_path().direction()})
                   .removed;
  }
  EXPECT_EQ(before - removed, volumes[0].occupied_count() + volumes[1].occupied_count());
  // The bit's volume: a cylinder to 2 mm before the target, then a cone.
  double removed_mm3 = 0.0;
  for (const PointVolume& volume : volumes) {
    removed_mm3 +=
        static_cast<double>(volume.point_count() - volume.occupied_count()) * volume.pattern().point_volume_mm3(1);
  }
  const double expected_mm3 = std::numbers::pi * (21.0 + 2.0 / 3.0);
  // A wall of 1 mm lies on a ring of points, which is removed whole: half a spacing more of radius.
  EXPECT_GT(removed_mm3, expected_mm3);
  EXPECT_LT(removed_mm3, expected_mm3 * 1.22);
}

TEST(VolumeSegments, AreRejectedWhereTheyDoNotFollowEachOther) {
  EXPECT_THROW(make_segments(wall_path(), {}, {}), Error);
  EXPECT_THROW(make_segments(wall_path(), {{0.0, 0.0, 0.1}}, {}), Error);
  EXPECT_THROW(make_segments(wall_path(), {{0.0, 5.0, 0.1}, {6.0, 9.0, 0.1}}, {}), Error);
  EXPECT_THROW(make_segments(wall_path(), {{0.0, std::nan(""), 0.1}}, {}), Error);
  EXPECT_THROW(fine_near_surface(wall_path(), 3.0, wall(5.0), 1.0, 2.0, 0.0, 0.2), Error);
  EXPECT_THROW(fine_near_surface(wall_path(), 3.0, wall(5.0), 1.0, 2.0, 0.1, std::nan("")), Error);
  EXPECT_THROW(make_joint_engine({}), Error);
}

}  // namespace
}  // namespace spinaltap
