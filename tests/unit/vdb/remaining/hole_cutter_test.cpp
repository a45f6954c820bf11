// Compiled with optimisation: long loops of its own.

#include "vdb/remaining/hole_cutter.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/tool/bit_profile.h"
#include "mesh/mesh_quality.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/bit_contains.h"
#include "tests/support/cut_hole.h"
#include "tests/support/release_only.h"
#include "tests/support/test_kind.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

using test::kLargeBall;

constexpr double kCutVoxelMm = 0.2;
const DrillBit kBit{4.0, 12.0, 5.0};

const BoneModel& uncut_ball() {
  static const BoneModel bone = test::bake_ball(kLargeBall, kCutVoxelMm);
  return bone;
}

double volume_mm3(const BoneModel& bone) { return measure_mesh(bone_surface(bone)).volume_mm3; }

double bit_volume_mm3(const DrillBit& bit) {
  const double section_mm2 = std::numbers::pi * bit.radius_mm() * bit.radius_mm();
  return section_mm2 * (bit.length_mm - bit.tip_length_mm + bit.tip_length_mm / 3.0);
}

/// Volume of the ball within the bit at `pose`, by counting the middles of small cubes.
double shared_volume_mm3(const DrillBit& bit, const Pose& pose) {
  constexpr double kStepMm = 0.05;
  const BitProfile profile(bit);
  Box3 box(pose.tip_mm);
  box.extend(pose.tip_mm - bit.length_mm * pose.axis);
  const Vec3 low = box.min() - Vec3::Constant(bit.radius_mm());
  const Eigen::Array3i size =
      ((box.sizes() + Vec3::Constant(2.0 * bit.radius_mm())) / kStepMm).array().ceil().cast<int>();
  std::size_t inside = 0;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const Vec3 p = low + kStepMm * (Vec3(i, j, k) + Vec3::Constant(0.5));
        inside += kLargeBall.distance_mm(p) < 0.0 && test::bit_contains(profile, pose, p) ? 1U : 0U;
      }
    }
  }
  return static_cast<double>(inside) * std::pow(kStepMm, 3);
}

SLOW_TESTS("HoleCutter.TakesTheSameThroughPosesBetween", "HoleCutter.TakesWhatTheBitSweptThroughTheSurface");

TEST(HoleCutter, TakesTheBitsVolumeOutOfSolid) {
  const Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  const Pose pose{kLargeBall.centre_mm + 6.0 * axis, axis};
  const double taken_mm3 = volume_mm3(uncut_ball()) - volume_mm3(test::without_hole(uncut_ball(), kBit, pose, pose));
  // The mesh rounds the bit's 25 mm of sharp edges by part of a voxel's section, and its tip: under 1% of this bit.
  EXPECT_NEAR(taken_mm3, bit_volume_mm3(kBit), 0.01 * bit_volume_mm3(kBit));
}

TEST(HoleCutter, TakesWhatTheBitSweptThroughTheSurface) {
  const Vec3 axis = Vec3(-0.7, 0.2, -0.4).normalized();
  const Pose start{kLargeBall.centre_mm - 18.0 * axis, axis};
  const Pose end{kLargeBall.centre_mm + 9.0 * axis, axis};
  DrillBit swept = kBit;
  swept.length_mm += 27.0;
  const double expected_mm3 = shared_volume_mm3(swept, end);
  ASSERT_GT(expected_mm3, 250.0);
  const BoneModel drilled = test::without_hole(uncut_ball(), kBit, start, end);
  EXPECT_NEAR(volume_mm3(uncut_ball()) - volume_mm3(drilled), expected_mm3, 0.01 * expected_mm3);
  const MeshQuality quality = measure_mesh(bone_surface(drilled));
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, 2);
}

TEST(HoleCutter, TakesManyWaysAsOneAfterTheOther) {
  RELEASE_ONLY();
  DrilledHole hole{kBit, {}};
  BoneModel one_by_one = uncut_ball();
  for (int n = 0; n < 5; ++n) {
    const Vec3 axis = Vec3(-0.7 + 0.2 * n, 0.2, -0.4 + 0.1 * n).normalized();
    hole.ways.push_back({{kLargeBall.centre_mm - 20.0 * axis, axis}, {kLargeBall.centre_mm + (3.0 + n) * axis, axis}});
    one_by_one = test::without_hole(one_by_one, kBit, hole.ways.back()[0], hole.ways.back()[1]);
  }
  const BoneModel at_once = without_holes(uncut_ball(), {&hole, 1});
  // Distances, not only surfaces: culling bits that are not nearest must change nothing. Beyond the band both are
  // clamped, but by a rounding of it.
  for (std::uint64_t n = 0; n < 20'000; ++n) {
    const Vec3 p = kLargeBall.centre_mm +
                   16.0 * (2.0 * Vec3(random_uniform(1, n), random_uniform(2, n), random_uniform(3, n)) - Vec3::Ones());
    ASSERT_NEAR(test::distance_at(at_once, p), test::distance_at(one_by_one, p), 1e-5) << p.transpose();
  }
  EXPECT_LT(volume_mm3(at_once), volume_mm3(uncut_ball()) - 500.0);
}

TEST(HoleCutter, TakesTheSameThroughPosesBetween) {
  const Vec3 axis = Vec3(-0.7, 0.2, -0.4).normalized();
  const Pose start{kLargeBall.centre_mm - 18.0 * axis, axis}, end{kLargeBall.centre_mm + 9.0 * axis, axis};
  const DrilledHole hole{kBit, {{start, {kLargeBall.centre_mm, axis}, end}}};
  const BoneModel moved = without_holes(uncut_ball(), {&hole, 1});
  const BoneModel subtracted = test::without_hole(uncut_ball(), kBit, start, end);
  for (std::uint64_t n = 0; n < 20'000; ++n) {
    const Vec3 p = kLargeBall.centre_mm +
                   16.0 * (2.0 * Vec3(random_uniform(1, n), random_uniform(2, n), random_uniform(3, n)) - Vec3::Ones());
    const double distance_mm = test::distance_at(subtracted, p);
    // Distances on the way are exact outside of the bit and near its surface: deep inside they may be less.
    if (distance_mm > 0.5 * kCutVoxelMm) continue;
    ASSERT_NEAR(test::distance_at(moved, p), distance_mm, 0.01 * kCutVoxelMm) << p.transpose();
  }
  EXPECT_NEAR(volume_mm3(moved), volume_mm3(subtracted), 1e-3 * (volume_mm3(uncut_ball()) - volume_mm3(subtracted)));
}

TEST(HoleCutter, MillsASlotAndJumpsToAnother) {
  // A ball on no shank that goes sideways, within the bone: what it takes is a capsule.
  const DrillBit ball{4.0, 10.0, 1.0, BitShape::round_burr, 0.0, 0.0};
  const Vec3 axis = Vec3(0.2, -0.3, -1.0).normalized(), aside = axis.cross(Vec3::UnitX()).normalized();
  const auto at = [&](double aside_mm, double up_mm) {
    const Vec3 middle_mm = kLargeBall.centre_mm + aside_mm * aside + up_mm * axis;
    return Pose{middle_mm + 2.0 * axis, axis};
  };
  std::vector<Pose> slot;
  for (int n = 0; n <= 100; ++n) slot.push_back(at(-4.0 + 0.05 * n, 0.0));
  const DrilledHole hole{ball, {slot, {at(5.0, 5.0)}}};
  const BoneModel milled = without_holes(uncut_ball(), {&hole, 1});
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * 8.0;
  const double expected_mm3 = 2.0 * ball_mm3 + std::numbers::pi * 4.0 * 5.0;
  // Walls of 2 mm radius that lie voxel² / 4R too far in, all around, are worth half a per cent.
  EXPECT_NEAR(volume_mm3(uncut_ball()) - volume_mm3(milled), expected_mm3, 0.01 * expected_mm3);
  for (std::uint64_t n = 0; n < 20'000; ++n) {
    const Vec3 p = kLargeBall.centre_mm +
                   8.0 * (2.0 * Vec3(random_uniform(1, n), random_uniform(2, n), random_uniform(3, n)) - Vec3::Ones());
    const Vec3 q = p - kLargeBall.centre_mm;
    const double along_mm = std::clamp(q.dot(aside), -4.0, 1.0);
    const double hole_mm = std::min((q - along_mm * aside).norm(), (q - 5.0 * aside - 5.0 * axis).norm()) - 2.0;
    if (std::abs(hole_mm) > kCutVoxelMm) continue;
    // Tri-linear values of a ball of 2 mm miss by voxel² / 4R.
    ASSERT_NEAR(test::distance_at(milled, p), -hole_mm, 0.015) << p.transpose();
  }
}

/// A trembling drill that goes in, out and in again beside it, turning on its way, at 1 kHz.
std::vector<ToolInput> trembling_inputs() {
  std::vector<ToolInput> inputs;
  for (int n = 0; n < 3000; ++n) {
    const double time_s = 0.001 * n;
    const double depth_mm = n < 1500 ? 8.0 * std::sin(2.0 * time_s) : 6.0 * std::sin(2.0 * (time_s - 1.5)) - 2.0;
    const double turn = 0.1 * std::sin(3.0 * time_s);
    const Vec3 axis = Vec3(std::sin(turn), 0.3 * turn, -std::cos(turn)).normalized();
    const Vec3 tremor_mm(0.1 * std::sin(60.0 * time_s), 0.08 * std::cos(71.0 * time_s), 0.0);
    const Vec3 aside_mm(n < 1500 ? 0.0 : 4.0, 0.0, 0.0);
    inputs.push_back(
        {.pose = {kLargeBall.centre_mm + Vec3(0.0, 0.0, 12.0) + aside_mm + tremor_mm + depth_mm * axis, axis},
         .spindle_on = n < 1490 || n > 1510});
  }
  return inputs;
}

TEST(HoleCutter, TakesWhatThePosesOfATremblingDrillTake) {
  const std::vector<ToolInput> inputs = trembling_inputs();
  HoleCutter cutter(uncut_ball());
  cutter.take_bit(kBit, 50.0);
  cutter.add(inputs);
  const openvdb::FloatGrid& hole = *cutter.bone().grids().hole;
  const BitProfile profile(kBit);
  std::size_t compared = 0;
  double max_mm = 0.0;
  for (auto value = hole.cbeginValueOn(); value; ++value) {
    if (compared++ % 40 != 0) continue;
    const Vec3 p_mm = detail::from_vdb(hole.indexToWorld(value.getCoord()));
    double by_poses_mm = std::numeric_limits<double>::infinity();
    for (const ToolInput& input : inputs) {
      if (input.spindle_on) by_poses_mm = std::min(by_poses_mm, bit_distance_mm(profile, input.pose, p_mm));
    }
    // Deep inside, distances are those to the union's parts, not to its surface.
    if (by_poses_mm < -0.3) continue;
    max_mm = std::max(max_mm, std::abs(static_cast<double>(*value) - by_poses_mm));
  }
  EXPECT_GT(compared, 20'000U);
  // A hundredth of a voxel, and between poses, which lie up to 0.02 mm apart, what an edge of the bit's passes beside.
  EXPECT_LT(max_mm, 0.01 * kCutVoxelMm + 0.003);
}

TEST(HoleCutter, GivesTheSameBitsInHoweverManyCallsAndThreads) {
  const std::vector<ToolInput> inputs = trembling_inputs();
  HoleCutter whole(uncut_ball());
  whole.take_bit(kBit, 50.0);
  whole.add(inputs);
  const std::string expected = bone_hash(whole.bone());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  HoleCutter parts(uncut_ball());
  parts.take_bit(kBit, 50.0);
  std::size_t done = 0;
  for (std::size_t calls = 0; done < inputs.size(); ++calls) {
    const std::size_t count = std::min(inputs.size() - done, 1 + 37 * (calls % 11));
    parts.add(std::span(inputs).subspan(done, count));
    done += count;
    if (calls > 0 && calls % 5 == 0) {
      EXPECT_TRUE(is_drilled(parts.bone()));
    }
  }
  EXPECT_EQ(bone_hash(parts.bone()), expected);
  const DrilledHole hole = drilled_hole(inputs, kBit, 50.0);
  EXPECT_EQ(hole.ways.size(), 2U);
  EXPECT_EQ(bone_hash(without_holes(uncut_ball(), {&hole, 1})), expected);
}

TEST(HoleCutter, MakesATunnelWhereItComesOutAgain) {
  const Vec3 axis = Vec3::UnitX();
  const BoneModel drilled = test::without_hole(uncut_ball(), kBit, {kLargeBall.centre_mm - 20.0 * axis, axis},
                                               {kLargeBall.centre_mm + 21.0 * axis, axis});
  const MeshQuality quality = measure_mesh(bone_surface(drilled));
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 0);
}

TEST(HoleCutter, LeavesItsSurfaceOnTheExactCut) {
  const Vec3 axis = Vec3(-0.7, 0.2, -0.4).normalized();
  const Pose start{kLargeBall.centre_mm - 18.0 * axis, axis};
  const Pose end{kLargeBall.centre_mm + 9.0 * axis, axis};
  DrillBit swept = kBit;
  swept.length_mm += 27.0;
  const BitProfile profile(swept);
  std::size_t on_cut = 0;
  for (const Eigen::Vector3f& vertex : bone_surface(test::without_hole(uncut_ball(), kBit, start, end)).vertices_mm) {
    const Vec3 p = vertex.cast<double>();
    const double to_ball_mm = std::abs(kLargeBall.distance_mm(p));
    const double to_bit_mm = std::abs(bit_distance_mm(profile, end, p));
    // At the rim, the tip and the shoulder a grid rounds by up to a voxel.
    ASSERT_LE(std::min(to_ball_mm, to_bit_mm), kCutVoxelMm) << p.transpose();
    const double back_mm = (end.tip_mm - p).dot(axis);
    const bool smooth_wall = back_mm > kBit.tip_length_mm + 2.0 * kCutVoxelMm && to_ball_mm > 2.0 * kCutVoxelMm;
    if (smooth_wall) {
      ++on_cut;
      // On a wall of 2 mm radius, tri-linear values miss by voxel² / 8R: 0.004 mm. A fifth of a voxel is ample.
      ASSERT_LE(to_bit_mm, 0.2 * kCutVoxelMm) << p.transpose();
    }
  }
  EXPECT_GT(on_cut, 1000U);
}

TEST(HoleCutter, ChangesTheBandNowhereElse) {
  const Vec3 axis = Vec3::UnitX();
  const BoneModel drilled =
      test::without_hole(uncut_ball(), kBit, {kLargeBall.centre_mm - 18.0 * axis, axis}, {kLargeBall.centre_mm, axis});
  for (const Vec3& p : kLargeBall.surface_points(0.5)) {
    if ((p - kLargeBall.centre_mm).cross(axis).norm() < 4.0) continue;
    ASSERT_EQ(test::distance_at(drilled, p), test::distance_at(uncut_ball(), p));
  }
  EXPECT_EQ(test::hu_at(drilled, kLargeBall.centre_mm), 300.0);
  EXPECT_EQ(drilled.metadata(), uncut_ball().metadata());
}

TEST(HoleCutter, ChangesNothingOutsideTheBone) {
  for (const double aside_mm : {30.0, 17.1}) {
    // The nearer one passes by, 0.1 mm from the surface.
    const Vec3 beside = kLargeBall.centre_mm + aside_mm * Vec3::UnitY();
    const Pose start{beside - 20.0 * Vec3::UnitX(), Vec3::UnitX()};
    const Pose end{beside + 20.0 * Vec3::UnitX(), Vec3::UnitX()};
    const BoneModel same = test::without_hole(uncut_ball(), kBit, start, end);
    const TriangleMesh before = bone_surface(uncut_ball());
    const TriangleMesh after = bone_surface(same);
    EXPECT_EQ(after.triangles, before.triangles);
    EXPECT_EQ(after.vertices_mm, before.vertices_mm);
  }
}

TEST(HoleCutter, TakesTheSameForwardsAndBackwards) {
  const Vec3 axis = Vec3::UnitZ();
  const Pose start{kLargeBall.centre_mm - 18.0 * axis, axis};
  const Pose end{kLargeBall.centre_mm, axis};
  EXPECT_EQ(volume_mm3(test::without_hole(uncut_ball(), kBit, start, end)),
            volume_mm3(test::without_hole(uncut_ball(), kBit, end, start)));
}

TEST(HoleCutter, RejectsWhatIsNoPoseAndNoBit) {
  const Pose start{kLargeBall.centre_mm, Vec3::UnitZ()};
  const Pose nowhere{Vec3::Constant(std::nan("")), Vec3::UnitZ()};
  const Pose not_unit{kLargeBall.centre_mm, 2.0 * Vec3::UnitZ()};
  EXPECT_THROW(test::without_hole(uncut_ball(), kBit, start, nowhere), Error);
  EXPECT_THROW(test::without_hole(uncut_ball(), kBit, nowhere, nowhere), Error);
  EXPECT_THROW(test::without_hole(uncut_ball(), kBit, not_unit, not_unit), Error);
  EXPECT_THROW(test::without_hole(uncut_ball(), {0.0, 12.0, 5.0}, start, start), Error);
}

}  // namespace
}  // namespace spinaltap
