#include "core/points/bone_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/engine/volume_segments.h"
#include "core/force/detail/lattice_section.h"
#include "core/force/detail/tool_contact.h"
#include "core/tool/swept_bit.h"
#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

using test::Draw;

TEST(NearestPoint, IsTheNearestOfAllOnRingsOrNextToIt) {
  Draw draw(3);
  for (const DiscSubdivision subdivision : {DiscSubdivision::rings, DiscSubdivision::hexagons}) {
    const DiscPattern pattern(2.0, 0.1, subdivision);
    for (int n = 0; n < 2'000; ++n) {
      const Eigen::Vector2d p(draw(-1.5, 1.5), draw(-1.5, 1.5));
      const bool is_near = p.norm() < 1.6;  // within the hexagons' flats
      if (!is_near) continue;
      const std::ptrdiff_t found = nearest_point(pattern, p.x(), p.y());
      ASSERT_GE(found, 0);
      double min_mm = 1e9;
      for (std::size_t i = 0; i < pattern.point_count(); ++i) {
        min_mm = std::min(min_mm, (pattern.point_mm(i) - p).norm());
      }
      // The nearest ring and on it the nearest: another ring's may be nearer by little.
      EXPECT_LE((pattern.point_mm(static_cast<std::size_t>(found)) - p).norm(), min_mm + 0.04) << p.transpose();
    }
    for (std::size_t i = 0; i < pattern.point_count(); ++i) {
      const Eigen::Vector2d& p = pattern.point_mm(i);
      EXPECT_EQ(nearest_point(pattern, p.x(), p.y()), static_cast<std::ptrdiff_t>(i));
    }
    EXPECT_EQ(nearest_point(pattern, 2.3, 0.0), -1);
    EXPECT_EQ(nearest_point(pattern, std::numeric_limits<double>::quiet_NaN(), 0.0), -1);
  }
}

TEST(BonePoints, AreFoundInAllVolumesEndToEnd) {
  Material material;
  std::vector<PointVolume> volumes =
      make_segments(test::askew_path(6.0), {{0.0, 2.0, 0.2}, {2.0, 4.0, 0.1}, {4.0, 6.0, 0.2}}, {.radius_mm = 2.0});
  const PathFrame frame = volumes.front().frame();
  // Each point's CT number says where it is.
  for (PointVolume& volume : volumes) {
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
        const double z_mm = frame.to_path(volume.frame().to_patient(volume.point_in_path_mm(disc, i))).z();
        volume.set_hu(disc, i, 100.0 * z_mm);
      }
    }
  }
  const BonePoints bone(volumes, material);
  EXPECT_EQ(bone.widest_spacing_mm(), 0.2);
  for (double z_mm = 0.0; z_mm < 5.8; z_mm += 0.013) {
    const BonePoints::Bone* found = bone.occupied_at(Vec3(0.3, -0.7, z_mm));
    ASSERT_NE(found, nullptr) << z_mm;
    // To half a spacing, and half a HU.
    const double spacing_mm = bone.discs_at(z_mm)->pattern().spacing_mm();
    EXPECT_NEAR(found->density_g_cm3, material.density.density_g_cm3(100.0 * z_mm),
                material.density.per_hu * (50.0 * spacing_mm + 1.5))
        << z_mm;
    EXPECT_NEAR(found->chisel_mpa, material.chisel_mpa * std::pow(found->density_g_cm3, material.chisel_exponent),
                1e-9);
  }
  EXPECT_EQ(bone.occupied_at(Vec3(0.0, 0.0, -0.2)), nullptr);
  EXPECT_EQ(bone.occupied_at(Vec3(0.0, 0.0, 6.0)), nullptr);
  EXPECT_EQ(bone.occupied_at(Vec3(2.2, 0.0, 3.0)), nullptr);
  EXPECT_EQ(bone.occupied_at(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())), nullptr);
  volumes[1].set_occupied(0, 0, false);
  EXPECT_EQ(bone.occupied_at(bone.frame().to_path(volumes[1].frame().to_patient(Vec3::Zero()))), nullptr);
}

TEST(BonePoints, HaveOccupiedBoneUntilTheLastPointIsRemoved) {
  std::vector<PointVolume> volumes =
      make_segments(test::askew_path(3.0), {{0.0, 1.0, 0.2}, {1.0, 3.0, 0.1}}, {.radius_mm = 1.0});
  const BonePoints bone(volumes, {});
  EXPECT_TRUE(bone.has_occupied());
  for (PointVolume& volume : volumes) {
    for (int disc = 0; disc < volume.disc_count(); ++disc) std::ranges::fill(volume.occupancy_words(disc), 0U);
  }
  EXPECT_FALSE(bone.has_occupied());
  PointVolume& last = volumes.back();
  last.set_occupied(last.disc_count() - 1, last.pattern().point_count() - 1, true);
  EXPECT_TRUE(bone.has_occupied());
}

TEST(BonePoints, RejectVolumesThatDoNotLieAlongOnePath) {
  std::vector<PointVolume> volumes;
  volumes.push_back(test::block(2.0, 1.0, 0.2));
  volumes.push_back(test::block(2.0, 1.0, 0.2));
  EXPECT_THROW(BonePoints(volumes, {}), Error);  // both at one place
  DrillPath aside = test::askew_path(2.0);
  aside.entry_mm += Vec3(5.0, 0.0, 0.0);
  aside.target_mm += Vec3(5.0, 0.0, 0.0);
  volumes[1] = PointVolume(aside, {.radius_mm = 1.0, .spacing_mm = 0.2});
  EXPECT_THROW(BonePoints(volumes, {}), Error);
  EXPECT_THROW(BonePoints({}, {}), Error);
}

TEST(ChiselProbe, RunsEvenlyFromDiscToDisc) {
  Material material;
  PointVolume volume = test::block(6.0, 2.0, 0.2);
  test::fill_density(volume, material, [](const Vec3& p) { return 0.2 + 0.1 * p.z(); });
  const BonePoints bone({&volume, 1}, material);
  const ChiselProbe tip(bone, 0.25);
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0.1, -0.2, 1.0), Vec3(0, 0.3, -1.0)}) {
    const Vec3 along = axis.normalized();
    for (double z_mm = 1.0; z_mm < 5.0; z_mm += 0.007) {
      // One spacing ahead along z, linear bone is met exactly, but for whole HU.
      const double ahead_mm = z_mm + (along.z() > 0.0 ? 0.2 : -0.2);
      EXPECT_NEAR(tip.ahead_of({Vec3(0.1, 0.1, z_mm), along}).density_g_cm3, 0.2 + 0.1 * ahead_mm, 2e-3) << z_mm;
    }
  }
}

TEST(SectionOverPoints, CountsThePointsThatABitCuts) {
  Draw draw(9);
  for (int n = 0; n < 300; ++n) {
    const DiscPattern pattern(3.0, n % 2 == 0 ? 0.1 : 0.2);
    const double radius_mm = draw(0.6, 1.6);
    const double offset_mm = n % 5 == 0 ? 0.0 : draw(0.0, 1.2);
    const double angle = draw(-3.1, 3.1);
    const Eigen::Vector2d middle_mm = offset_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    double sum_mm2 = 0.0;
    for (std::size_t i = 0; i < pattern.point_count(); ++i) {
      if ((pattern.point_mm(i) - middle_mm).norm() > radius_mm + SweepProfile::kStraightSkinMm) continue;
      sum_mm2 += pattern.point_volume_mm3(DiscPattern::ring_of(i)) / pattern.spacing_mm();
    }
    const double expected = std::numbers::pi * radius_mm * radius_mm / sum_mm2;
    EXPECT_NEAR(section_over_points(pattern, radius_mm, offset_mm, angle), expected, 1e-9);
  }
}

TEST(SectionOverPoints, IsNoConcernOfHolesBeyondTheVolume) {
  const DiscPattern pattern(3.0, 0.1);
  EXPECT_EQ(section_over_points(pattern, 3.0, 0.0, 0.0), 1.0);
  EXPECT_EQ(section_over_points(pattern, 1.5, 1.6, 0.3), 1.0);
  EXPECT_NE(section_over_points(pattern, 1.5, 0.0, 0.0), 1.0);  // its wall lies on a ring
}

}  // namespace
}  // namespace spinaltap
