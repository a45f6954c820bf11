// Compiled with optimisation: long loops of its own.
// Plates through voxels: against every voxel put to the swept box, and against volumes that geometry tells.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/points/material.h"
#include "core/tool/plate.h"
#include "tests/support/made_bone.h"
#include "tests/support/random_drilling.h"
#include "tests/support/test_kind.h"
#include "vdb/engine/make_engine.h"
#include "vdb/engine/voxel_engine.h"

namespace spinaltap {
namespace {

using test::Random;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3 kCubeMm(31.3, 212.1, -618.7);

/// A cube with CT numbers that differ from place to place.
BoneModel plate_cube(double half_mm) {
  const Box3 box_mm(kCubeMm - Vec3::Constant(half_mm + 1.5), kCubeMm + Vec3::Constant(half_mm + 1.5));
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf =
      test::made_sdf([&](const Vec3& p) { return (p - kCubeMm).cwiseAbs().maxCoeff() - half_mm; }, box_mm, 0.25);
  auto hu = openvdb::FloatGrid::create(-1024.0F);
  hu->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
  hu->setName("hu");
  auto accessor = hu->getAccessor();
  for (const openvdb::Coord& voxel : openvdb::CoordBBox(openvdb::Coord::floor(detail::to_vdb(box_mm.min())),
                                                        openvdb::Coord::ceil(detail::to_vdb(box_mm.max())))) {
    accessor.setValue(voxel, static_cast<float>(((voxel.x() * 31 + voxel.y() * 57 + voxel.z()) % 900 + 900) % 900));
  }
  grids->hu = hu;
  return BoneModel(grids);
}

DrillBit plate(std::uint64_t n) {
  switch (n % 4) {
    case 0:
      return plate_bit(3.0, 0.5, 8.0);
    case 1:
      return plate_bit(2.0, 0.08, 6.0, 0.5);  // thinner than a voxel
    case 2:
      return plate_bit(1.5, 1.5, 2.0);  // a bar, shorter than the bone
    default:
      return plate_bit(4.0, 1.2, 9.0, 1.0);
  }
}

/// Poses that wander through and around the cube with turns of all kinds, slides along the plate's own directions,
/// jumps, and ways out and in again.
std::vector<Pose> wander_with_plate(std::uint64_t seed, int steps, double half_mm) {
  Random random(seed);
  const double speed_mm = std::pow(10.0, random(-2.5, -0.3));
  const double turn = seed % 3 == 0 ? 0.0 : std::pow(10.0, random(-5.0, -1.3));
  Pose pose{kCubeMm, random.direction()};
  pose.side = any_perpendicular(pose.axis);
  pose.tip_mm -= half_mm * pose.axis;
  Vec3 way = pose.axis;
  std::vector<Pose> poses;
  for (int step = 0; step < steps; ++step) {
    if (step % 20 == 10) {
      const Vec3 own[] = {pose.axis, -pose.axis, pose.side, pose.axis.cross(pose.side)};
      way = seed % 2 == 0 ? own[static_cast<std::size_t>(step / 20) % 4] : random.direction();
    }
    const Vec3 from_middle = pose.tip_mm - kCubeMm;
    if (from_middle.cwiseAbs().maxCoeff() > half_mm + 0.5) way = -from_middle.normalized();
    if (seed % 7 == 6 && step % 40 == 30) pose.tip_mm = kCubeMm + (half_mm + 1.0) * random.direction();
    const Vec3 about = seed % 5 == 4 ? pose.axis : random.direction();
    const Mat3 turned = Eigen::AngleAxisd(turn * random(0.5, 1.0), about).toRotationMatrix();
    const Vec3 axis = (turned * pose.axis).normalized();
    const Vec3 side = turned * pose.side;
    pose = {pose.tip_mm + speed_mm * way, axis, (side - side.dot(axis) * axis).normalized()};
    poses.push_back(pose);
  }
  return poses;
}

class PlateBruteForce {
 public:
  PlateBruteForce(const VoxelBone& bone, const DrillBit& bit, const Material& material)
      : sweep_(bit), pressures_(material), voxel_mm_(bone.voxel_mm()) {
    bone.for_each_occupied([&](const Eigen::Vector3i& at) {
      occupied_.push_back({at, bone.centre_mm(at), bone.hu(at)});
    });
  }
  StepResult step(const Pose& pose) {
    const PlateMotion motion(sweep_, last_.value_or(pose), pose);
    last_ = pose;
    StepResult result;
    for (std::size_t n = 0; n < motion.piece_count(); ++n) {
      const SweptPlate swept = motion.piece(n);
      std::erase_if(occupied_, [&](const Voxel& voxel) {
        if (!swept.contains(voxel.place_mm)) return false;
        ++result.removed;
        result.removed_hu += voxel.hu;
        const double energy =
            static_cast<double>(pressures_.units(voxel.hu)) * PressureTable::kUnitMpa * std::pow(voxel_mm_, 3.0);
        result.work_n_mm += energy;
        result.moment_n_mm2 += energy * (voxel.place_mm - pose.tip_mm);
        return true;
      });
    }
    return result;
  }
  void reset_motion() { last_.reset(); }
  bool is_same_as(const VoxelBone& bone) const {
    return bone.occupied_count() == occupied_.size() &&
           std::ranges::all_of(occupied_, [&](const Voxel& voxel) { return bone.is_occupied(voxel.at); });
  }

 private:
  struct Voxel {
    Eigen::Vector3i at;
    Vec3 place_mm;
    std::int16_t hu;
  };
  PlateSweep sweep_;
  PressureTable pressures_;
  double voxel_mm_;
  std::vector<Voxel> occupied_;
  std::optional<Pose> last_;
};

SLOW_TESTS("PlateEngine.RemovesWhatEveryVoxelPutToTheSweptBoxSays");

TEST(PlateEngine, RemovesWhatEveryVoxelPutToTheSweptBoxSays) {
  constexpr double kHalfMm = 2.5;
  const BoneModel bone = plate_cube(kHalfMm);
  std::size_t removed = 0;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE(seed);
    VoxelBone voxels(bone, {.voxel_mm = seed % 4 == 3 ? 0.17 : 0.1});
    const DrillBit bit = plate(seed / 2);
    const Material material;
    const auto engine = make_voxel_engine(voxels, bit, material);
    PlateBruteForce truth(voxels, bit, material);
    const std::vector<Pose> poses = wander_with_plate(seed, 120, kHalfMm);
    for (std::size_t n = 0; n < poses.size(); ++n) {
      if (seed % 11 == 10 && n == 60) {
        engine->reset_motion();
        truth.reset_motion();
      }
      const StepResult found = engine->step(poses[n]), expected = truth.step(poses[n]);
      ASSERT_EQ(found.removed, expected.removed) << n;
      ASSERT_EQ(found.removed_hu, expected.removed_hu) << n;
      ASSERT_NEAR(found.work_n_mm, expected.work_n_mm, 1e-9 * expected.work_n_mm) << n;
      ASSERT_LT((found.moment_n_mm2 - expected.moment_n_mm2).norm(), 1e-6 * (1.0 + expected.work_n_mm)) << n;
      removed += found.removed;
    }
    ASSERT_TRUE(truth.is_same_as(voxels));
  }
  EXPECT_GT(removed, 500'000U);
}

/// Volume that is taken on a way through poses, mm³.
double taken_mm3(const BoneModel& bone, const DrillBit& bit, const std::vector<Pose>& poses) {
  VoxelBone voxels(bone, {.voxel_mm = 0.05});
  const auto engine = make_voxel_engine(voxels, bit, {});
  double taken = 0.0;
  for (const Pose& pose : poses) taken += engine->step(pose).removed_mm3;
  return taken;
}

TEST(PlateEngine, CutsTheVolumeThatGeometryTells) {
  // Its face lies midway between layers of voxels.
  constexpr double kFaceMm = 6.025;
  const BoneModel bone = plate_cube(kFaceMm);
  const DrillBit bit = plate_bit(5.0, 0.8, 20.0);
  // Leaning against the cube's face and turned about its own axis, off the lattice's directions.
  const Vec3 axis = Vec3(0.21, -0.13, 1.0).normalized();
  const Vec3 across = any_perpendicular(axis);
  const Vec3 side = std::cos(0.4) * across + std::sin(0.4) * axis.cross(across);
  const Vec3 on_face = kCubeMm + Vec3(0.3, 0.2, -kFaceMm);
  const auto at = [&](double depth_mm, const Vec3& aside_mm, double roll_rad) {
    const Vec3 turned = std::cos(roll_rad) * side + std::sin(roll_rad) * axis.cross(side);
    return Pose{on_face + depth_mm * axis + aside_mm, axis, turned};
  };
  std::vector<Pose> way;
  for (int n = -60; n <= 100; ++n) way.push_back(at(0.05 * n, Vec3::Zero(), 0.0));
  const double kerf_mm3 = 5.0 * 0.8 * 5.0;
  EXPECT_NEAR(taken_mm3(bone, bit, way), kerf_mm3, 2e-3 * kerf_mm3);
  // One step through all: the same.
  EXPECT_NEAR(taken_mm3(bone, bit, {way.front(), way.back()}), kerf_mm3, 2e-3 * kerf_mm3);
  // On across its thickness: a slot.
  std::vector<Pose> slot = way;
  const Vec3 normal = axis.cross(side);
  for (int n = 1; n <= 40; ++n) slot.push_back(at(5.0, 0.05 * n * normal, 0.0));
  // Its mouth leans: what is added lies from half a thickness aside on, and is as much deeper as the face falls there.
  const double shift_mm = (0.5 * 0.8 + 0.5 * 2.0) * normal.z() / axis.z();
  const double slot_mm3 = kerf_mm3 + 5.0 * 2.0 * (5.0 + shift_mm);
  EXPECT_NEAR(taken_mm3(bone, bit, slot), slot_mm3, 2e-3 * slot_mm3);
  // Turned half about its axis it leaves a round hole of its diagonal.
  std::vector<Pose> turned = way;
  for (int n = 1; n <= 180; ++n) turned.push_back(at(5.0, Vec3::Zero(), n * std::numbers::pi / 180.0));
  const double hole_mm3 = std::numbers::pi * 0.25 * (5.0 * 5.0 + 0.8 * 0.8) * 5.0;
  EXPECT_NEAR(taken_mm3(bone, bit, turned), hole_mm3, 2e-3 * hole_mm3);
}

TEST(PlateEngine, TakesNothingAtPosesThatMakeNoSense) {
  VoxelBone voxels(plate_cube(2.0));
  const auto engine = make_voxel_engine(voxels, plate_bit(3.0, 0.5, 8.0), {});
  const Vec3 nan = Vec3::Constant(std::nan(""));
  EXPECT_EQ(engine->step({nan, Vec3::UnitY()}).removed, 0U);
  EXPECT_EQ(engine->step({kCubeMm, 2.0 * Vec3::UnitY()}).removed, 0U);
  EXPECT_EQ(engine->step({kCubeMm, Vec3::UnitY(), Vec3::UnitY()}).removed, 0U) << "a side along the axis";
  EXPECT_EQ(engine->step({kCubeMm, Vec3::UnitZ()}).removed, 0U) << "no side, and held along its axis";
  EXPECT_EQ(engine->step({Vec3::Constant(2e4), Vec3::UnitY()}).removed, 0U);
  EXPECT_GT(engine->step({kCubeMm, Vec3::UnitY()}).removed, 0U);
}

}  // namespace
}  // namespace spinaltap
