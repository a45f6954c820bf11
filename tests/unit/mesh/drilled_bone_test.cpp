// What a bone keeps of being drilled: itself as it was, and the hole.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/tool/bit_profile.h"
#include "tests/support/cut_hole.h"
#include "tests/support/drilled_ball.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/remaining/remaining_bone.h"

namespace spinaltap {
namespace {

using test::kDrilledBall;

/// Stands in the middle, its shank out of the ball.
Pose in_the_middle() { return {kDrilledBall.centre_mm, test::kAslant}; }

const BoneModel& ball_drilled_once() {
  static const BoneModel bone =
      test::without_hole(test::ball_to_drill(), test::paper_drill(), in_the_middle(), in_the_middle());
  return bone;
}

TEST(DrilledBone, KeepsTheBoneAsItWas) {
  EXPECT_FALSE(is_drilled(test::ball_to_drill()));
  ASSERT_TRUE(is_drilled(ball_drilled_once()));
  EXPECT_EQ(ball_drilled_once().grids().before, test::ball_to_drill().grids().sdf);
  EXPECT_FALSE(is_drilled(before_drilling(ball_drilled_once())));
  EXPECT_EQ(before_drilling(ball_drilled_once()).grids().sdf, test::ball_to_drill().grids().sdf);
  EXPECT_EQ(before_drilling(test::ball_to_drill()).grids().sdf, test::ball_to_drill().grids().sdf);
}

TEST(DrilledBone, KeepsTheExactDistanceToTheBitWhereThereWasBone) {
  const openvdb::FloatGrid& hole = *ball_drilled_once().grids().hole;
  const BitProfile bit(test::paper_drill());
  std::size_t count = 0;
  for (auto voxel = ball_drilled_once().grids().before->cbeginValueOn(); voxel; ++voxel) {
    const Vec3 p_mm = detail::from_vdb(hole.indexToWorld(voxel.getCoord()));
    const double band_mm = static_cast<double>(hole.background());
    const double expected_mm = std::clamp(bit_distance_mm(bit, in_the_middle(), p_mm), -band_mm, band_mm);
    ASSERT_NEAR(static_cast<double>(hole.tree().getValue(voxel.getCoord())), expected_mm, 1e-6);
    count += std::abs(expected_mm) < band_mm ? 1U : 0U;
  }
  EXPECT_GT(count, 1000U);
}

TEST(DrilledBone, IsTheLargerOfBothEverywhere) {
  const detail::BoneGrids& grids = ball_drilled_once().grids();
  std::size_t differ = 0;
  for (auto voxel = grids.sdf->cbeginValueOn(); voxel; ++voxel) {
    const float before = grids.before->tree().getValue(voxel.getCoord());
    const float hole = grids.hole->tree().getValue(voxel.getCoord());
    ASSERT_EQ(*voxel, std::max(before, -hole));
    differ += *voxel != before ? 1U : 0U;
  }
  EXPECT_GT(differ, 1000U);
}

TEST(DrilledBone, KnowsAllItsHoles) {
  const Pose beside{kDrilledBall.centre_mm + Vec3(3.0, 1.0, -2.0), Vec3::UnitX()};
  const BoneModel twice = test::without_hole(ball_drilled_once(), test::ball_burr(), beside, beside);
  EXPECT_EQ(twice.grids().before, test::ball_to_drill().grids().sdf);
  const BitProfile first(test::paper_drill());
  const BitProfile second(test::ball_burr());
  for (auto voxel = twice.grids().hole->cbeginValueOn(); voxel; ++voxel) {
    const Vec3 p_mm = detail::from_vdb(twice.grids().hole->indexToWorld(voxel.getCoord()));
    const double nearest_mm =
        std::min(bit_distance_mm(first, in_the_middle(), p_mm), bit_distance_mm(second, beside, p_mm));
    // Far from the bone only one of them may be kept, which is then too far.
    ASSERT_GT(static_cast<double>(*voxel), nearest_mm - 1e-6);
    if (kDrilledBall.distance_mm(p_mm) >= 0.0) continue;
    ASSERT_NEAR(static_cast<double>(*voxel), nearest_mm, 1e-6);
  }
}

TEST(DrilledBone, IsDrilledOnWhereItWasLeft) {
  RemainingBone fresh(test::ball_to_drill(), {.voxel_mm = 0.25});
  fresh.drill(test::paper_drill(), std::array{in_the_middle()});
  RemainingBone again(ball_drilled_once(), {.voxel_mm = 0.25});
  EXPECT_EQ(again.holes_to_undo(), 0U);
  // On the grid's own voxels, whose hole is that of the same bit.
  const auto differences = [&] {
    double max_mm = 0.0;
    const auto low = fresh.first_voxel();
    const auto high = fresh.last_voxel();
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          const double a = static_cast<double>(fresh.value_mm({x, y, z}));
          max_mm = std::max(max_mm, std::abs(a - static_cast<double>(again.value_mm({x, y, z}))));
        }
      }
    }
    return max_mm;
  };
  EXPECT_LT(differences(), 1e-5);
  const Pose further{kDrilledBall.centre_mm + 3.0 * test::kAslant, test::kAslant};
  fresh.drill(test::paper_drill(), std::array{in_the_middle(), further});
  again.drill(test::paper_drill(), std::array{in_the_middle(), further});
  EXPECT_LT(differences(), 1e-5);
  // Only what was drilled since can be taken back.
  again.reset();
  RemainingBone as_it_was(ball_drilled_once(), {.voxel_mm = 0.25});
  const auto voxel_of = [](const Vec3& p_mm) {
    return std::array{static_cast<int>(std::lround(p_mm.x() / 0.25)), static_cast<int>(std::lround(p_mm.y() / 0.25)),
                      static_cast<int>(std::lround(p_mm.z() / 0.25))};
  };
  EXPECT_GT(again.value_mm(voxel_of(kDrilledBall.centre_mm - 3.0 * test::kAslant)), 0.0F);
  EXPECT_LT(again.value_mm(voxel_of(further.tip_mm - 1.0 * test::kAslant)), 0.0F);
}

TEST(DrilledBone, HasASharpSurfaceWithoutItsRecord) {
  const TriangleMesh mesh = sharp_surface(ball_drilled_once());
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 2);
  const BitProfile bit(test::paper_drill());
  // Each vertex lies on the ball or on the bit, and none within the bit or out of the ball.
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    const Vec3 p_mm = vertex.cast<double>();
    const double off_mm = std::max(kDrilledBall.distance_mm(p_mm), -bit_distance_mm(bit, in_the_middle(), p_mm));
    ASSERT_NEAR(off_mm, 0.0, 0.08) << p_mm.transpose();
  }
}

}  // namespace
}  // namespace spinaltap
