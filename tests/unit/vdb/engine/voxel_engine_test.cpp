// Compiled with optimisation: long loops of its own.

#include "vdb/engine/voxel_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/points/hu_byte.h"
#include "core/points/material.h"
#include "core/tool/swept_bit.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/made_bone.h"
#include "tests/support/random_drilling.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/engine/tools.h"
#include "vdb/detail/bone_samplers.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap {
namespace {

using Eigen::Vector3i;
using test::expect_same_removal;
using test::kBall;
using test::kSmallBall;
using test::Random;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3 kMiddleMm(31.3, 212.1, -618.7);

/// A rounded block with CT numbers that differ from place to place.
BoneModel block(double half_mm = 2.5) {
  const Box3 box_mm(kMiddleMm - Vec3::Constant(half_mm + 2.0), kMiddleMm + Vec3::Constant(half_mm + 2.0));
  const auto distance_mm = [&](const Vec3& p) {
    const Vec3 beyond = (p - kMiddleMm).cwiseAbs() - Vec3::Constant(half_mm - 0.5);
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0) - 0.5;
  };
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = test::made_sdf(distance_mm, box_mm, 0.25);
  auto hu = openvdb::FloatGrid::create(-1024.0F);
  hu->setTransform(openvdb::math::Transform::createLinearTransform(0.4));
  hu->setName("hu");
  auto accessor = hu->getAccessor();
  for (const openvdb::Coord& voxel : openvdb::CoordBBox(openvdb::Coord::floor(detail::to_vdb(box_mm.min() / 0.4)),
                                                        openvdb::Coord::ceil(detail::to_vdb(box_mm.max() / 0.4)))) {
    accessor.setValue(voxel,
                      static_cast<float>(((voxel.x() * 31 + voxel.y() * 57 + voxel.z() * 7) % 1500 + 1500) % 1500));
  }
  grids->hu = hu;
  return BoneModel(grids);
}

/// All shapes, and two profiles: one that is wider again behind a neck, one with a step and a flat arc.
DrillBit mill(std::uint64_t n) {
  switch (n % 8) {
    case 0:
      return {2.0, 8.0, 2.0};
    case 1:
      return {1.5, 8.0, 1.0, BitShape::round_burr, 0.0, 0.6};
    case 2:
      return twist_drill(1.6, 8.0, 118, 0.2);
    case 3:
      return {2.2, 3.0, 1.0, BitShape::round_burr, 0.0, 0.0};
    case 4:
      return {1.5, 8.0, 1.5, BitShape::conical_burr, 0.4, 0.7};
    case 5:
      return {2.0, 8.0, 1.0, BitShape::tapered_screw, 1.2, 0.0};
    case 6:
      return profile_bit({{0.0, 0.0}, {0.8, 0.8, true}, {1.6, 0.8}, {2.0, 0.4}, {3.0, 0.4}, {3.4, 0.7}, {8.0, 0.7}});
    default:
      return profile_bit({{0.0, 0.3}, {1.2, 0.9}, {2.2, 0.9, true}, {2.2, 0.5}, {8.0, 0.5}});
  }
}

/// Poses that wander through and around the block, from all sides, with turns, jumps, and ways out and in again.
std::vector<Pose> wander_around(std::uint64_t seed, int steps, double half_mm = 2.5) {
  Random random(seed);
  const double speed_mm = std::pow(10.0, random(-2.5, -0.3));
  const double turn = seed % 3 == 0 ? 0.0 : std::pow(10.0, random(-5.0, -1.5));
  Vec3 axis = random.direction();
  Vec3 tip = -half_mm * axis + Vec3(random(-1, 1), random(-1, 1), random(-1, 1));
  Vec3 way = axis;
  std::vector<Pose> poses;
  for (int step = 0; step < steps; ++step) {
    if (step % 20 == 10) way = random.direction();
    if (tip.cwiseAbs().maxCoeff() > half_mm + 0.5) way = -tip.normalized();
    if (seed % 7 == 6 && step % 40 == 30) tip = (half_mm + 1.0) * random.direction();  // out, and in again
    if (seed % 5 == 4 && step == steps / 2) axis = random.direction();                 // at once
    tip += speed_mm * way;
    axis = (axis + turn * random.direction()).normalized();
    poses.push_back({kMiddleMm + tip, axis});
  }
  return poses;
}

/// Every occupied voxel put to SweptBit: what the engine must do, without any of its haste.
class BruteForce {
 public:
  BruteForce(const VoxelBone& bone, const DrillBit& bit, const Material& material)
      : profile_(BitProfile(bit)), pressures_(material), voxel_mm_(bone.voxel_mm()) {
    bone.for_each_occupied([&](const Vector3i& voxel) { occupied_.push_back({voxel, bone.hu(voxel)}); });
    // Numbers near the tool are small, as the engine's are: at a voxel, so that they are as exact.
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (const Voxel& one : occupied_) {
      const Vec3 leaf_low = (one.at.cast<double>() / 8.0).array().floor() * 8.0;
      low = low.cwiseMin(leaf_low);
      high = high.cwiseMax(leaf_low + Vec3::Constant(7.0));
    }
    for (int axis = 0; axis < 3; ++axis) middle_[axis] = static_cast<int>(low[axis] + high[axis]) / 2;
  }

  StepResult step(const Pose& pose) {
    const Vec3 middle_mm = voxel_mm_ * middle_.cast<double>();
    Pose target{pose.tip_mm - middle_mm, pose.axis};
    target.axis /= target.axis.norm();
    const Pose start = is_placed_ ? pose_ : target;
    is_placed_ = true;
    pose_ = target;
    StepResult result;
    double moment_n = 0.0;
    const BitMotion motion(profile_, start, target);
    for (std::size_t piece = 0; piece < motion.piece_count(); ++piece) {
      const SweptBit bit = motion.piece(piece);
      std::erase_if(occupied_, [&](const Voxel& voxel) {
        const Vec3 p = voxel_mm_ * (voxel.at - middle_).cast<double>();
        if (!bit.contains(p)) return false;
        ++result.removed;
        result.removed_hu += voxel.hu;
        const double energy = static_cast<double>(pressures_.units(voxel.hu)) * PressureTable::kUnitMpa * voxel_mm_ *
                              voxel_mm_ * voxel_mm_;
        result.work_n_mm += energy;
        result.moment_n_mm2 += energy * (p - target.tip_mm);
        moment_n += energy * (p - target.tip_mm).norm();
        return true;
      });
    }
    result.removed_mm3 = static_cast<double>(result.removed) * voxel_mm_ * voxel_mm_ * voxel_mm_;
    moment_scale = moment_n;
    return result;
  }
  void reset_motion() { is_placed_ = false; }

  bool is_same_as(const VoxelBone& bone) const {
    return bone.occupied_count() == occupied_.size() &&
           std::ranges::all_of(occupied_, [&](const Voxel& voxel) { return bone.is_occupied(voxel.at); });
  }
  double moment_scale = 0.0;

 private:
  struct Voxel {
    Vector3i at;
    std::int16_t hu;
  };
  SweepProfile profile_;
  PressureTable pressures_;
  double voxel_mm_;
  std::vector<Voxel> occupied_;
  Vector3i middle_;
  Pose pose_;
  bool is_placed_ = false;
};

TEST(VoxelBone, HoldsWhatLiesInTheBoneAndItsNumbers) {
  const BoneModel bone = block();
  for (const double voxel_mm : {0.1, 0.13, 0.5}) {
    SCOPED_TRACE(voxel_mm);
    const VoxelBone voxels(bone, {.voxel_mm = voxel_mm});
    std::size_t occupied = 0;
    const Vector3i low = ((kMiddleMm - Vec3::Constant(3.0)) / voxel_mm).array().floor().matrix().cast<int>();
    const Vector3i high = ((kMiddleMm + Vec3::Constant(3.0)) / voxel_mm).array().ceil().matrix().cast<int>();
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) {
          const Vector3i voxel(x, y, z);
          const Vec3 p = voxels.centre_mm(voxel);
          std::uint8_t is_inside = 0;
          bone.inside({&p, 1}, {&is_inside, 1});
          ASSERT_EQ(voxels.is_occupied(voxel), is_inside == 1) << voxel.transpose();
          if (is_inside == 0) continue;
          ++occupied;
          ASSERT_EQ(voxels.hu(voxel), hu_of_byte(byte_of_hu(test::hu_at(bone, p))));
        }
      }
    }
    EXPECT_EQ(voxels.occupied_count(), occupied);
    EXPECT_GT(occupied, 500U);
  }
}

TEST(VoxelBone, MeasuresABall) {
  const BoneModel bone = test::bake_ball(kBall);
  const VoxelBone voxels(bone);
  EXPECT_NEAR(1e-3 * static_cast<double>(voxels.occupied_count()), kBall.volume_mm3(), 5e-4 * kBall.volume_mm3());
  // A byte of CT number and a bit of life, and what leaves cost that the surface cuts.
  EXPECT_LT(voxels.memory_bytes(), 2 * voxels.occupied_count());
}

TEST(VoxelBone, IsCutToARegion) {
  const BoneModel bone = test::bake_ball(kSmallBall);
  const Box3 region_mm(kSmallBall.centre_mm, kSmallBall.centre_mm + Vec3::Constant(20.0));
  const VoxelBone voxels(bone, {.region_mm = region_mm});
  std::size_t inside = 0;
  VoxelBone(bone).for_each_occupied([&](const Vector3i& voxel) {
    const bool is_within = region_mm.contains(voxels.centre_mm(voxel));
    inside += is_within ? 1 : 0;
    ASSERT_EQ(voxels.is_occupied(voxel), is_within);
  });
  EXPECT_EQ(voxels.occupied_count(), inside);
}

TEST(VoxelBone, HoldsSeveralBones) {
  const std::array bones{test::bake_ball({Vec3(0, 0, 0), 3.0}, 0.25, 200),
                         test::bake_ball({Vec3(5, 0, 0), 3.0}, 0.25, 600)};
  const VoxelBone both(bones, {.voxel_mm = 0.2});
  const VoxelBone first(bones[0], {.voxel_mm = 0.2});
  const VoxelBone second(bones[1], {.voxel_mm = 0.2});
  std::size_t in_either = 0;
  both.for_each_occupied([&](const Vector3i& voxel) {
    ++in_either;
    ASSERT_TRUE(first.is_occupied(voxel) || second.is_occupied(voxel));
    ASSERT_EQ(both.hu(voxel), first.is_occupied(voxel) ? first.hu(voxel) : second.hu(voxel));
  });
  first.for_each_occupied([&](const Vector3i& voxel) { ASSERT_TRUE(both.is_occupied(voxel)); });
  second.for_each_occupied([&](const Vector3i& voxel) { ASSERT_TRUE(both.is_occupied(voxel)); });
  EXPECT_LT(in_either, first.occupied_count() + second.occupied_count());  // they overlap
}

TEST(VoxelBone, LivesAgainAsTheOneThatItIsACopyOfAndStaysAsItIsBesideAnother) {
  // The second ball's leaves come behind the first's.
  const std::array bones{test::bake_ball({Vec3(0, 0, 0), 3.0}, 0.25, 200),
                         test::bake_ball({Vec3(30, 0, 0), 3.0}, 0.25, 200)};
  const VoxelBone whole(bones, {.voxel_mm = 0.2});
  const auto words_of = [](const VoxelBone& bone) {
    std::vector<std::uint64_t> words;
    bone.get_occupancy_words(words);
    return words;
  };
  VoxelBone drilled(whole);
  const auto engine = make_voxel_engine(drilled, {4.0, 20.0, 1.0, BitShape::round_burr, 0.0, 2.0}, {});
  EXPECT_GT(engine->step({Vec3(0, 0, 0), Vec3::UnitZ()}).removed, 0U);
  const std::vector<std::uint64_t> left = words_of(drilled);
  const VoxelBone first(bones[0], {.voxel_mm = 0.2}), coarse(bones, {.voxel_mm = 0.25});
  const std::array with_third{bones[0], bones[1], test::bake_ball({Vec3(60, 0, 0), 3.0}, 0.25, 200)};
  const VoxelBone more(with_third, {.voxel_mm = 0.2});
  // As many leaves in the same places, with fewer voxels in them.
  VoxelBone fewer(whole);
  make_voxel_engine(fewer, {1.0, 20.0, 1.0}, {})->step({Vec3(30, 0, 0), Vec3::UnitZ()});
  for (const VoxelBone* other : std::initializer_list<const VoxelBone*>{&first, &coarse, &more, &fewer}) {
    EXPECT_THAT([&] { drilled.restore(*other); }, ThrowsMessage<Error>(HasSubstr("that they are a copy of")));
    EXPECT_EQ(words_of(drilled), left);
  }
  EXPECT_THAT([&] { drilled.set_occupancy_words(words_of(first)); }, ThrowsMessage<Error>(HasSubstr("occupied words")));
  EXPECT_EQ(words_of(drilled), left);
  drilled.restore(whole);
  EXPECT_EQ(words_of(drilled), words_of(whole));
  drilled.set_occupancy_words(left);
  EXPECT_EQ(words_of(drilled), left);
}

TEST(VoxelBone, RejectsWhatIsNone) {
  const BoneModel bone = test::bake_ball(kSmallBall);
  EXPECT_THAT([&] { VoxelBone(bone, {.voxel_mm = 0.0}); }, ThrowsMessage<Error>(HasSubstr("0.02 to 5 mm")));
  EXPECT_THAT([&] { VoxelBone(bone, {.voxel_mm = std::nan("")}); }, ThrowsMessage<Error>(HasSubstr("0.02 to 5 mm")));
  EXPECT_THAT([&] { VoxelBone(std::span<const BoneModel>()); }, ThrowsMessage<Error>(HasSubstr("at least one bone")));
  EXPECT_THAT(
      [&] {
        VoxelBone(bone, {.region_mm = {Vec3::Constant(900.0), Vec3::Constant(901.0)}});
      },
      ThrowsMessage<Error>(HasSubstr("region with bone")));
  const Vec3 corner = kSmallBall.centre_mm + Vec3::Constant(5.9);
  EXPECT_THAT(
      [&] {
        VoxelBone(bone, {.region_mm = {corner, corner + Vec3::Constant(0.05)}});
      },
      ThrowsMessage<Error>(HasSubstr("no voxel")));
}

TEST(LatticeBlock, HasTheValuesOfItsPositionsBitForBit) {
  const BoneModel bone = block();
  Random random(11);
  int with_sign = 0;
  for (int n = 0; n < 300; ++n) {
    const double step_mm = std::pow(10.0, random(-1.5, -0.2));
    const Vec3 first = kMiddleMm + Vec3(random(-5, 5), random(-5, 5), random(-5, 5));
    detail::LatticeBlock lattice;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 8; ++k) {
        lattice.at_mm[axis][k] = first[static_cast<Eigen::Index>(axis)] + step_mm * static_cast<double>(k);
      }
    }
    std::vector<Vec3> points_mm;
    for (std::size_t i = 0; i < 512; ++i) {
      points_mm.push_back({lattice.at_mm[0][i / 64], lattice.at_mm[1][i / 8 % 8], lattice.at_mm[2][i % 8]});
    }
    for (const detail::GridSampler* sampler : {&bone.samplers().distance, &bone.samplers().hu}) {
      std::array<float, 512> found;
      std::vector<float> expected(512);
      sampler->linear(lattice, found);
      sampler->linear(points_mm, expected, {});
      ASSERT_TRUE(std::ranges::equal(found, expected)) << n;
      const int sign = sampler->sign(lattice);
      with_sign += sign != 0 ? 1 : 0;
      const auto [least, most] = std::ranges::minmax_element(expected);
      ASSERT_TRUE(sign >= 0 || *most < 0.0F);
      ASSERT_TRUE(sign <= 0 || *least >= 0.0F);
    }
  }
  EXPECT_GT(with_sign, 100);
}

struct Removed {
  std::size_t removed = 0;
  std::size_t tested = 0;
};

/// One step of both, which must come to the same.
void step_alike(DrillEngine& engine, BruteForce& expected, const Pose& pose, Removed& sum) {
  const StepResult a = engine.step(pose), b = expected.step(pose);
  ASSERT_EQ(a.removed, b.removed);
  ASSERT_EQ(a.removed_hu, b.removed_hu);
  ASSERT_NEAR(a.removed_mm3, b.removed_mm3, 1e-9 * b.removed_mm3);
  ASSERT_NEAR(a.work_n_mm, b.work_n_mm, 1e-9 * b.work_n_mm);
  ASSERT_LE((a.moment_n_mm2 - b.moment_n_mm2).norm(), 1e-9 * (expected.moment_scale + 100.0 * b.work_n_mm));
  sum.removed += a.removed;
  sum.tested += a.tested;
}

SLOW_TESTS("VoxelEngine.IsTheSameWithAllInstructionsAndAtAnyNumberOfThreads");

TEST(VoxelEngine, RemovesWhatBruteForceDoesInAnyMotionOfAnyTool) {
#if defined(SPINALTAP_ADDRESS_SANITIZER)
  constexpr std::uint64_t kSeeds = 20;  // each takes ten times as long
#else
  constexpr std::uint64_t kSeeds = 200;
#endif
  const BoneModel bone = block();
  Removed sum;
  int steps = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = mill(seed);
    VoxelBone found(bone, {.voxel_mm = seed % 2 == 0 ? 0.2 : 0.14});
    BruteForce expected(found, bit, {});
    const auto& kernels = detail::word_kernels();
    const auto engine = detail::make_voxel_engine(found, bit, {}, {}, kernels[seed % kernels.size()]);
    for (const Pose& pose : wander_around(seed, 100)) {
      if (++steps % 23 == 0) {
        expected.reset_motion();
        engine->reset_motion();
      }
      ASSERT_NO_FATAL_FAILURE(step_alike(*engine, expected, pose, sum));
    }
    ASSERT_TRUE(expected.is_same_as(found));
  }
  EXPECT_GT(sum.removed, kSeeds * 300U);
  EXPECT_GT(sum.tested, 0U);
}

/// Tools beside which a leaf is small, so that leaves lie to one side of their balls and cylinders.
DrillBit large_mill(std::uint64_t n) {
  switch (n % 7) {
    case 0:
      return {5.0, 20.0, 1.0, BitShape::round_burr, 0.0, 2.5};
    case 1:
      return {4.0, 4.0, 1.0, BitShape::round_burr, 0.0, 0.0};
    case 2:
      return {4.4, 20.0, 3.0};
    case 3:
      return {4.0, 20.0, 1.0, BitShape::round_burr, 0.0, 3.6};
    case 4:  // with a flat face: what lies ahead of it lies to no side
      return profile_bit({{0.0, 2.2}, {20.0, 2.2}});
    case 5:
      return profile_bit({{0.0, 0.0}, {2.0, 2.0, true}, {4.0, 2.0}, {5.0, 1.2}, {7.0, 1.2}, {8.0, 1.8}, {20.0, 1.8}});
    default:
      return profile_bit({{0.0, 1.2}, {0.0, 2.0}, {2.0, 2.0}, {2.0, 1.4}, {20.0, 1.4}});
  }
}

TEST(VoxelEngine, RemovesWhatBruteForceDoesWithToolsMuchLargerThanALeaf) {
#if defined(SPINALTAP_ADDRESS_SANITIZER)
  constexpr std::uint64_t kSeeds = 4;
#else
  constexpr std::uint64_t kSeeds = 60;
#endif
  constexpr double kHalfMm = 2.5;
  const BoneModel bone = block(kHalfMm);
  Removed sum;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = large_mill(seed);
    VoxelBone found(bone, {.voxel_mm = seed % 2 == 0 ? 0.1 : 0.125});
    BruteForce expected(found, bit, {});
    const auto& kernels = detail::word_kernels();
    const auto engine = detail::make_voxel_engine(found, bit, {}, {}, kernels[seed % kernels.size()]);
    // To and fro over one side, a little deeper each time, with turns: most of what is near lies aside and behind.
    Random random(seed);
    Mat3 turned;
    turned.col(2) = random.direction();
    turned.col(0) = any_perpendicular(turned.col(2));
    turned.col(1) = turned.col(2).cross(turned.col(0));
    const bool lies = seed % 3 == 0;  // the shank mills
    const double step_mm = std::pow(10.0, random(-2.3, -0.7));
    const double turn = seed % 5 < 2 ? 0.0 : std::pow(10.0, random(-5.0, -2.0));
    Vec3 axis = lies ? (turned * Vec3(0.2, 0.97, -0.14)).normalized() : Vec3(-turned.col(2));
    Vec3 tip(-1.5, lies ? 3.0 : random(-0.5, 0.5), kHalfMm + (lies ? 0.5 * bit.diameter_mm : 0.0) - 0.3);
    Vec3 way(1.0, 0.0, 0.0);
    for (int step = 0; step < 150; ++step) {
      tip += step_mm * way + Vec3(random(-0.02, 0.02), random(-0.02, 0.02), random(-0.02, 0.02));
      if (std::abs(tip.x()) > 1.5) {
        tip.x() = std::copysign(1.5, tip.x());
        way = (Vec3(-way.x(), random(-0.4, 0.4), random(-0.3, 0.0))).normalized();
      }
      axis = (axis + turn * random.direction()).normalized();
      ASSERT_NO_FATAL_FAILURE(step_alike(*engine, expected, {kMiddleMm + turned * tip, axis}, sum));
    }
    ASSERT_TRUE(expected.is_same_as(found));
  }
  EXPECT_GT(sum.removed, kSeeds * 1000U);
}

TEST(VoxelEngine, RemovesWhatBruteForceDoesWithToolsThatTurnByManyPieces) {
#if defined(SPINALTAP_ADDRESS_SANITIZER)
  constexpr std::uint64_t kSeeds = 4;
#else
  constexpr std::uint64_t kSeeds = 40;
#endif
  constexpr double kHalfMm = 2.5;
  const BoneModel bone = block(kHalfMm);
  Removed sum;
  std::array<int, 4> steps_of{};  ///< one piece, a few with hardly a way, a few with a long way, more
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = seed % 2 == 0 ? mill(seed) : large_mill(seed);
    const SweepProfile profile{BitProfile(bit)};
    VoxelBone found(bone, {.voxel_mm = seed % 4 < 2 ? 0.1 : 0.14});
    BruteForce expected(found, bit, {});
    const auto& kernels = detail::word_kernels();
    const auto engine = detail::make_voxel_engine(found, bit, {}, {}, kernels[seed % kernels.size()]);
    // About a place on its axis, in its tip or far behind it, which goes on slowly.
    Random random(seed);
    const double behind_mm = seed % 3 == 0 ? random(5.0, 40.0) : random(-1.0, 3.0);
    Vec3 axis = random.direction();
    Vec3 pivot = (-kHalfMm - behind_mm) * axis;
    Pose before{kMiddleMm + pivot + behind_mm * axis, axis};
    for (int step = 0; step < 60; ++step) {
      pivot += random(0.0, 0.15) * Vec3(axis + 0.5 * random.direction());
      axis = (axis + random(0.0, 0.06) * random.direction()).normalized();
      if (pivot.norm() > behind_mm + 2.0 * kHalfMm) pivot *= 0.5;
      const Pose pose{kMiddleMm + pivot + behind_mm * axis, axis};
      const std::size_t pieces = BitMotion(profile, before, pose).piece_count();
      const bool goes_far = (pose.tip_mm - before.tip_mm).norm() > 0.3;
      ++steps_of[pieces == 1 ? 0 : pieces > 4 ? 3 : goes_far ? 2 : 1];
      before = pose;
      ASSERT_NO_FATAL_FAILURE(step_alike(*engine, expected, pose, sum));
    }
    ASSERT_TRUE(expected.is_same_as(found));
  }
  EXPECT_GT(sum.removed, kSeeds * 1000U);
  EXPECT_GT(std::ranges::min(steps_of), static_cast<int>(kSeeds));
}

TEST(VoxelEngine, DecidesWhatLiesOnTheToolsWallAsSweptBitDoes) {
  // Voxels 25 times the voxel's size from the ball's centre, and from the shank's axis 15 times: 3, 4, 5 and 7, 24, 25.
  constexpr double kVoxelMm = 0.125;
  const BoneModel bone = block();
  Removed sum;
  for (const DrillBit& bit : {DrillBit{50.0 * kVoxelMm, 12.0, 1.0, BitShape::round_burr, 0.0, 30.0 * kVoxelMm},
                              DrillBit{40.0 * kVoxelMm, 12.0, 2.5}}) {
    for (const Vec3& axis : {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -0.6, 0.8)}) {
      VoxelBone found(bone, {.voxel_mm = kVoxelMm});
      BruteForce expected(found, bit, {});
      const auto engine = make_voxel_engine(found, bit, {});
      const Vec3 middle_mm = kVoxelMm * (kMiddleMm / kVoxelMm).array().round().matrix();
      for (int step = 0; step < 12; ++step) {
        const Vec3 aside = kVoxelMm * Vec3(step % 3, -step % 2, step % 4);
        const Pose pose{middle_mm - (2.5 - kVoxelMm * (step / 2)) * axis + aside, axis};
        ASSERT_NO_FATAL_FAILURE(step_alike(*engine, expected, pose, sum));
      }
      ASSERT_TRUE(expected.is_same_as(found));
    }
  }
  EXPECT_GT(sum.tested, 1000U);
  EXPECT_GT(sum.removed, 1000U);
}

TEST(VoxelEngine, IsTheSameWithAllInstructionsAndAtAnyNumberOfThreads) {
  const BoneModel bone = test::bake_ball(kBall);
  const VoxelBone before(bone, {.voxel_mm = 0.12});
  const auto run = [&](std::size_t threads, const VoxelEngineOptions& options, const detail::WordKernels& kernels) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    VoxelBone voxels(before);
    const auto engine =
        detail::make_voxel_engine(voxels, {6.0, 20.0, 3.0, BitShape::round_burr, 0.0, 2.5}, {}, options, kernels);
    std::vector<StepResult> results;
    Random random(5);
    for (int step = 0; step < 60; ++step) {
      const Vec3 axis = Vec3(random(-0.3, 0.3), random(-0.3, 0.3), -1.0).normalized();
      results.push_back(engine->step({kBall.centre_mm + Vec3(random(-6, 6), random(-6, 6), 9.0 - 0.2 * step), axis}));
    }
    std::vector<Vector3i> left;
    voxels.for_each_occupied([&](const Vector3i& voxel) { left.push_back(voxel); });
    return std::pair(results, left);
  };
  const auto expected = run(1, {.shares_work = false}, detail::word_kernels().front());
  std::size_t removed = 0;
  for (const StepResult& step : expected.first) removed += step.removed;
  EXPECT_GT(removed, 300'000U);
  for (const detail::WordKernels& kernels : detail::word_kernels()) {
    SCOPED_TRACE(kernels.name);
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
      const auto found = run(threads, {}, kernels);
      ASSERT_EQ(found.first.size(), expected.first.size());
      for (std::size_t n = 0; n < found.first.size(); ++n) {
        expect_same_removal(found.first[n], expected.first[n]);
        ASSERT_EQ(found.first[n].tested, expected.first[n].tested);
      }
      EXPECT_EQ(found.second, expected.second);
    }
  }
}

/// What the tool takes of the whole bone.
double volume_milled_mm3(const BoneModel& bone, const DrillBit& tool, std::span<const Pose> poses,
                         double voxel_mm = 0.1) {
  VoxelBone voxels(bone, {.voxel_mm = voxel_mm});
  const auto engine = make_voxel_engine(voxels, tool, {});
  double sum = 0.0;
  for (const Pose& pose : poses) sum += engine->step(pose).removed_mm3;
  return sum;
}

TEST(VoxelEngine, MillsTheExactVolume) {
  const BoneModel bone = block(4.0);
  const DrillBit burr{3.0, 30.0, 1.5, BitShape::round_burr, 0.0, 1.0};
  const auto milled_mm3 = [&](std::span<const Pose> poses) { return volume_milled_mm3(bone, burr, poses); };
  const Vec3 axis = Vec3(0.2, -0.3, -1.0).normalized();
  const auto at = [&](const Vec3& offset) { return Pose{kMiddleMm + offset + 1.5 * axis, axis}; };
  // From outside to the middle, then on: the front half of the ball moves on, which is worth a cylinder.
  const std::array<Pose, 2> in{at(-8.0 * axis), at(Vec3::Zero())};
  const std::array<Pose, 3> and_on{in[0], in[1], at(1.2 * axis)};
  const double on_mm3 = milled_mm3(and_on) - milled_mm3(in);
  EXPECT_NEAR(on_mm3, std::numbers::pi * 1.5 * 1.5 * 1.2, 0.002 * on_mm3);
}

TEST(VoxelEngine, MillsTheVolumeOfABallASlotAndACurvedHole) {
  constexpr double kRadiusMm = 1.5, kBendMm = 2.2;
  const BoneModel bone = block(4.5);
  const DrillBit ball{2.0 * kRadiusMm, 10.0, 1.0, BitShape::round_burr, 0.0, 0.0};
  const auto milled_mm3 = [&](std::span<const Pose> poses) { return volume_milled_mm3(bone, ball, poses); };
  const auto around = [&](const Vec3& centre_mm, const Vec3& axis) {
    return Pose{kMiddleMm + centre_mm + kRadiusMm * axis, axis};
  };
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadiusMm, 3);
  const double section_mm2 = std::numbers::pi * kRadiusMm * kRadiusMm;
  const Vec3 axis = Vec3(0.2, -0.3, -1.0).normalized();

  const std::array<Pose, 1> stands{around(Vec3::Zero(), axis)};
  EXPECT_NEAR(milled_mm3(stands), ball_mm3, 0.002 * ball_mm3);

  // A slot across the tool's axis, in steps.
  const Vec3 aside = axis.cross(Vec3(0.3, 1.0, 0.2)).normalized();
  std::vector<Pose> slot;
  for (int n = 0; n <= 60; ++n) slot.push_back(around((-1.5 + 0.05 * n) * aside, axis));
  const double slot_mm3 = ball_mm3 + 3.0 * section_mm2;
  EXPECT_NEAR(milled_mm3(slot), slot_mm3, 0.002 * slot_mm3);

  // A hole along a circle, 150 degrees of it, the tool turning with its way: as long as its middle line (Pappus).
  const Vec3 up = axis.cross(aside);
  constexpr int kSteps = 150;
  std::vector<Pose> curved;
  for (int n = 0; n <= kSteps; ++n) {
    const double angle = std::numbers::pi * (n - 0.5 * kSteps) / 180.0;
    const Vec3 out = std::cos(angle) * up + std::sin(angle) * aside;
    curved.push_back(around(kBendMm * out, (std::cos(angle) * aside - std::sin(angle) * up).normalized()));
  }
  const double curved_mm3 = ball_mm3 + section_mm2 * kBendMm * std::numbers::pi * kSteps / 180.0;
  EXPECT_NEAR(milled_mm3(curved), curved_mm3, 0.002 * curved_mm3);
}

TEST(VoxelEngine, RemovesByAProfileWhatItRemovesByTheShapeThatItRepeats) {
  const BoneModel bone = block();
  for (std::uint64_t seed = 1; seed <= 18; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = mill(seed % 6);
    VoxelBone of_shape(bone, {.voxel_mm = 0.15});
    VoxelBone of_profile(of_shape);
    const auto shape = make_voxel_engine(of_shape, bit, {});
    const auto profile = make_voxel_engine(of_profile, test::profile_like(bit), {});
    for (const Pose& pose : wander_around(seed, 80)) {
      const StepResult expected = shape->step(pose), found = profile->step(pose);
      ASSERT_EQ(found.removed, expected.removed);
      ASSERT_EQ(found.work_n_mm, expected.work_n_mm);
      ASSERT_EQ(found.moment_n_mm2, expected.moment_n_mm2);
    }
    of_shape.for_each_occupied([&](const Vector3i& voxel) { ASSERT_TRUE(of_profile.is_occupied(voxel)); });
    EXPECT_EQ(of_profile.occupied_count(), of_shape.occupied_count());
  }
}

TEST(VoxelEngine, MillsTheVolumeOfASteppedReamersHoleAndSlot) {
  // A flat tip, a chamfer, a pilot, a shoulder, and the wider part; all of it comes to lie in the block.
  constexpr double kTipMm = 0.5, kPilotMm = 1.0, kWideMm = 1.6, kSlotMm = 2.0;
  constexpr std::array<double, 5> kBacksMm{0.0, 0.5, 2.5, 3.1, 5.1},
      kRadiiMm{kTipMm, kPilotMm, kPilotMm, kWideMm, kWideMm};
  std::vector<OutlinePoint> outline;
  double hole_mm3 = 0.0, section_mm2 = 0.0;
  for (std::size_t n = 0; n < kBacksMm.size(); ++n) {
    outline.push_back({kBacksMm[n], kRadiiMm[n]});
    if (n == 0) continue;
    const double length_mm = kBacksMm[n] - kBacksMm[n - 1], a = kRadiiMm[n - 1], b = kRadiiMm[n];
    hole_mm3 += std::numbers::pi / 3.0 * length_mm * (a * a + a * b + b * b);
    section_mm2 += length_mm * (a + b);
  }
  const DrillBit reamer = profile_bit(outline);
  const BoneModel bone = block(4.5);
  const Vec3 axis = Vec3(0.2, -0.3, -1.0).normalized();
  const Vec3 aside = axis.cross(Vec3(0.3, 1.0, 0.2)).normalized();
  const auto at = [&](double along_mm) { return Pose{kMiddleMm + 2.55 * axis + along_mm * aside, axis}; };
  // Flat faces fall between planes of voxels: at 0.1 mm the count of them alone is off by 0.26 %.
  constexpr double kVoxelMm = 0.05;
  const std::array<Pose, 1> stands{at(0.0)};
  EXPECT_NEAR(volume_milled_mm3(bone, reamer, stands, kVoxelMm), hole_mm3, 0.002 * hole_mm3);
  std::vector<Pose> slot;
  for (int n = 0; n <= 40; ++n) slot.push_back(at(kSlotMm * (0.025 * n - 0.5)));
  const double slot_mm3 = hole_mm3 + kSlotMm * section_mm2;
  EXPECT_NEAR(volume_milled_mm3(bone, reamer, slot, kVoxelMm), slot_mm3, 0.002 * slot_mm3);
}

TEST(VoxelEngine, ChangesNothingOnPosesThatAreNone) {
  const BoneModel bone = test::bake_ball(kSmallBall);
  VoxelBone voxels(bone, {.voxel_mm = 0.3});
  const std::size_t occupied = voxels.occupied_count();
  const auto engine = make_voxel_engine(voxels, mill(0), {});
  engine->step({Vec3::Constant(std::nan("")), Vec3::UnitZ()});
  engine->step({kSmallBall.centre_mm, Vec3(0, 0, 2)});
  engine->step({kSmallBall.centre_mm + Vec3(2e4, 0, 0), Vec3::UnitZ()});
  EXPECT_EQ(voxels.occupied_count(), occupied);
  EXPECT_GT(engine->step({kSmallBall.centre_mm, Vec3::UnitZ()}).removed, 0U);
}

TEST(VoxelEngine, LeavesNothingWhereAllIsMilled) {
  const BoneModel bone = test::bake_ball(kSmallBall);
  VoxelBone voxels(bone, {.voxel_mm = 0.15});
  const std::size_t occupied = voxels.occupied_count();
  const auto engine = make_voxel_engine(voxels, {14.0, 20.0, 1.0}, {});
  std::size_t removed = 0;
  for (double z = -10.0; z < 20.0; z += 0.1) {
    removed += engine->step({kSmallBall.centre_mm + Vec3(0, 0, z), Vec3::UnitZ()}).removed;
  }
  EXPECT_EQ(removed, occupied);
  EXPECT_EQ(voxels.occupied_count(), 0U);
  EXPECT_EQ(engine->step({kSmallBall.centre_mm, Vec3::UnitZ()}).removed, 0U);
}

}  // namespace
}  // namespace spinaltap
