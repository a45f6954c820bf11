#include "vdb/engine/make_engine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/tool/swept_bit.h"
#include "tests/support/random_drilling.h"
#include "tests/unit/core/engine/tools.h"
#include "vdb/engine/detail/leaf_volume_engine.h"
#include "vdb/engine/detail/shared_points.h"

namespace spinaltap {
namespace {

using test::expect_same_removal;
using test::Random;

/// All shapes, and two profiles; the first also with a flat tip, and with a base that comes into the volume.
DrillBit tool(std::uint64_t n) {
  switch (n % 9) {
    case 0:
      return {2.0, 8.0, 2.0};
    case 1:
      return {1.0, 3.0, 1.0};
    case 2:
      return twist_drill(1.6, 8.0, 118, 0.2);
    case 3:
      return {1.5, 8.0, 1.0, BitShape::round_burr, 0.0, 0.6};
    case 4:
      return {1.5, 8.0, 1.5, BitShape::conical_burr, 0.4, 0.7};
    case 5:
      return {2.0, 8.0, 1.0, BitShape::tapered_screw, 1.2, 0.0};
    case 6:
      return {1.8, 2.5, 1.0, BitShape::round_burr, 0.0, 0.0};
    case 7:
      return profile_bit({{0.0, 0.0}, {0.8, 0.8, true}, {1.6, 0.8}, {2.0, 0.4}, {3.0, 0.4}, {3.4, 0.7}, {8.0, 0.7}});
    default:
      return profile_bit({{0.0, 0.3}, {1.2, 0.9}, {2.2, 0.9, true}, {2.2, 0.5}, {8.0, 0.5}});
  }
}

const Vec3 kEntryMm(31.0, 212.0, -618.0);

DrillPath path_along(const Vec3& direction, const DrillBit& bit, double length_mm = 4.0) {
  return {"test", kEntryMm, kEntryMm + length_mm * direction, bit};
}

/// Every point occupied, with CT numbers that differ.
PointVolume block(const DrillPath& path, const PointVolumeOptions& options) {
  PointVolume volume(path, options);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      volume.set_hu(disc, i, static_cast<double>((static_cast<std::size_t>(disc) * 31 + i * 7) % 1500));
    }
  }
  return volume;
}

/// Path-local poses that wander through and around a volume of 4 mm: straight and sideways, with slow and fast turns,
/// jumps, and for some seeds the bit lying flat or coming from below.
std::vector<Pose> wander(std::uint64_t seed, int steps) {
  Random random(seed);
  const double speed_mm = std::pow(10.0, random(-3.0, -0.5));
  const double turn = seed % 3 == 0 ? 0.0 : std::pow(10.0, random(-5.0, -1.5));
  Vec3 tip(random(-1, 1), random(-1, 1), random(-0.5, 2.0));
  double x_turn = random(-0.3, 0.3) + (seed % 5 == 1 ? random(-1.6, 1.6) : 0.0);
  double y_turn = random(-0.3, 0.3);
  Vec3 way(0, 0, 1);
  std::vector<Pose> poses;
  for (int step = 0; step < steps; ++step) {
    if (step % 20 == 0) way = Vec3(random(-1, 1), random(-1, 1), random(-0.6, 1.2));
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(tip[axis]) > 2.0) way[axis] = -std::copysign(1.0, tip[axis]);
    }
    if (tip.z() > 5.0) way.z() = -1.0;
    if (tip.z() < -1.0) way.z() = 1.0;
    tip += speed_mm * way;
    x_turn += turn * random(-1, 1);
    y_turn += turn * random(-1, 1);
    if (seed % 11 == 5 && step == steps / 2) x_turn = 0.5 * std::numbers::pi;
    if (seed % 7 == 6 && step % 50 == 40) tip = Vec3(random(-3, 3), random(-3, 3), random(-4, 6));  // out, and in again
    const Vec3 axis(std::sin(x_turn), std::sin(y_turn) * std::cos(x_turn), std::cos(y_turn) * std::cos(x_turn));
    poses.push_back({tip, axis.normalized()});
  }
  return poses;
}

PointVolumeOptions options_of(std::uint64_t seed) {
  PointVolumeOptions options{.radius_mm = 1.6, .spacing_mm = 0.1};
  if (seed % 4 == 1) options.hu_bits = HuBits::eight;
  if (seed % 5 == 2) options.jitter = 0.4;
  if (seed % 5 == 3) options.subdivision = DiscSubdivision::hexagons;
  return options;
}

TEST(LeafEngine, RemovesTheSamePointsAsTheReferenceInAnyMotionOfAnyTool) {
  std::size_t removed = 0;
  int steps = 0;
#if defined(SPINALTAP_ADDRESS_SANITIZER)
  constexpr std::uint64_t kSeeds = 20;  // each takes ten times as long
#else
  constexpr std::uint64_t kSeeds = 70;
#endif
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = tool(seed);
    PointVolume expected = block(path_along(Random(seed).direction(), bit), options_of(seed));
    PointVolume found = expected;
    const auto reference = make_reference_engine(expected, bit, {});
    const auto leaf = make_leaf_engine(found, bit, {});
    for (const Pose& local : wander(seed, 120)) {
      const Pose pose = expected.frame().to_patient(local);
      if (++steps % 9 == 0) {
        reference->reset_motion();
        leaf->reset_motion();
      }
      const StepResult result = reference->step(pose);
      removed += result.removed;
      expect_same_removal(leaf->step(pose), result);
      ASSERT_TRUE(std::ranges::equal(found.occupancy_words(), expected.occupancy_words()));
    }
  }
  EXPECT_GT(removed, kSeeds * 1'500U);
}

TEST(LeafEngine, RemovesByAProfileWhatItRemovesByTheShapeThatItRepeats) {
  std::size_t removed = 0;
  for (std::uint64_t seed = 1; seed <= 14; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const DrillBit bit = tool(seed % 7);
    PointVolume of_shape = block(path_along(Random(seed).direction(), bit), options_of(seed));
    PointVolume of_profile = of_shape;
    const auto shape = make_leaf_engine(of_shape, bit, {});
    const auto profile = make_leaf_engine(of_profile, test::profile_like(bit), {});
    for (const Pose& local : wander(seed, 80)) {
      const Pose pose = of_shape.frame().to_patient(local);
      const StepResult result = shape->step(pose);
      expect_same_removal(profile->step(pose), result);
      removed += result.removed;
    }
    EXPECT_TRUE(std::ranges::equal(of_profile.occupancy_words(), of_shape.occupancy_words()));
  }
  EXPECT_GT(removed, 14U * 1'500U);
}

TEST(LeafEngine, RemovesTheSameAtOneAndTwoThreads) {
  const DrillBit bit{2.5, 8.0, 1.0, BitShape::round_burr, 0.0, 0.6};
  const auto run = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    PointVolume volume =
        block(path_along(Vec3(0.3, -0.9, 0.2).normalized(), bit), {.radius_mm = 2.0, .spacing_mm = 0.05});
    const auto engine = make_leaf_engine(volume, bit, {});
    std::vector<std::size_t> counts;
    for (int step = 0; step < 40; ++step) {
      const double x_mm = step % 2 == 0 ? -1.0 : 1.0;  // steps of 2 mm have work for many threads
      const StepResult result =
          engine->step(volume.frame().to_patient(Pose{Vec3(x_mm, 0.0, 0.1 * step), Vec3::UnitZ()}));
      counts.insert(counts.end(), {result.removed, result.tested, static_cast<std::size_t>(result.removed_hu)});
    }
    return std::pair(counts,
                     std::vector<std::uint64_t>(volume.occupancy_words().begin(), volume.occupancy_words().end()));
  };
  const auto one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_GT(*std::ranges::max_element(one.first), 10'000U);
}

TEST(LeafEngine, ChangesNothingOnPosesThatAreNone) {
  const DrillBit bit{2.0, 8.0, 2.0};
  PointVolume volume = block(path_along(Vec3::UnitZ(), bit), {.radius_mm = 1.5, .spacing_mm = 0.1});
  const auto engine = make_leaf_engine(volume, bit, {});
  engine->step({Vec3::Constant(std::nan("")), Vec3::UnitZ()});
  engine->step({kEntryMm + Vec3(0, 0, 2), Vec3(0, 0, 2)});
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
}

TEST(LeafEngine, DropsLeavesThatAreEmpty) {
  const DrillBit bit{2.0, 8.0, 2.0};
  PointVolume volume = block(path_along(Vec3::UnitZ(), bit), {.radius_mm = 1.6, .spacing_mm = 0.1});
  detail::LeafVolumeEngine engine(volume, bit, {});
  const detail::PointLeaves& leaves = engine.leaves();
  const std::size_t cells = leaves.cell_count();
  const std::size_t nodes = engine.node_count();
  EXPECT_GT(nodes, 0U);
  EXPECT_EQ(leaves.active_voxel_count(), cells);
  // 8 by 8 cells of 0.4 mm, less those at the corners that the cylinder does not meet, times 10 layers.
  EXPECT_GT(cells, 500U);
  EXPECT_LE(cells, 640U);
  for (double depth_mm = -0.5; depth_mm < 7.0; depth_mm += 0.05) {
    engine.step({kEntryMm + Vec3(0.0, 0.0, depth_mm), Vec3::UnitZ()});
    ASSERT_EQ(leaves.active_voxel_count(), leaves.cell_count());
  }
  // The four by four columns of cells about the axis lie in the bit.
  EXPECT_LE(leaves.cell_count(), cells - 10 * 4 * 4 / 2);
  EXPECT_EQ(engine.node_count(), nodes);
  // Wide sweeps leave nothing.
  const Pose across{kEntryMm + Vec3(-3.0, 0.0, 7.0), Vec3::UnitZ()};
  for (double y_mm = -2.0; y_mm <= 2.0; y_mm += 0.5) {
    engine.step({across.tip_mm + Vec3(0.0, y_mm, 0.0), Vec3::UnitZ()});
    engine.step({across.tip_mm + Vec3(6.0, y_mm, 0.0), Vec3::UnitZ()});
  }
  EXPECT_EQ(volume.occupied_count(), 0U);
  EXPECT_EQ(leaves.cell_count(), 0U);
  EXPECT_EQ(leaves.active_voxel_count(), 0U);
  EXPECT_EQ(engine.node_count(), 0U);
  EXPECT_EQ(engine.step(across).tested, 0U);
}

TEST(LeafEngine, TestsNothingWhileTheBitStaysWhereItIs) {
  const DrillBit bit{2.1, 8.0, 2.0};
  PointVolume volume = block(path_along(Vec3::UnitZ(), bit), {.radius_mm = 1.6, .spacing_mm = 0.1});
  const auto engine = make_leaf_engine(volume, bit, {});
  const Pose pose{kEntryMm + Vec3(0.013, 0.007, 2.037), Vec3::UnitZ()};
  EXPECT_GT(engine->step(pose).tested, 0U);
  EXPECT_EQ(engine->step(pose).tested, 0U);
}

TEST(LeafEngine, WorksOnAVolumeWithoutOccupiedPoints) {
  const DrillBit bit{2.0, 8.0, 2.0};
  PointVolume volume = block(path_along(Vec3::UnitZ(), bit), {.radius_mm = 1.0, .spacing_mm = 0.2});
  for (int disc = 0; disc < volume.disc_count(); ++disc) std::ranges::fill(volume.occupancy_words(disc), 0);
  const auto engine = make_leaf_engine(volume, bit, {});
  EXPECT_EQ(engine->step({kEntryMm, Vec3::UnitZ()}).removed, 0U);
}

class OverlappingVolumes : public testing::TestWithParam<DiscSubdivision> {
 protected:
  OverlappingVolumes() {
    const PointVolumeOptions options{.radius_mm = 1.2, .spacing_mm = 0.1, .subdivision = GetParam()};
    volumes_.push_back(block({"a", kEntryMm, kEntryMm + Vec3(0.0, 0.0, 5.0), kBit}, options));
    volumes_.push_back(block({"b", kEntryMm + Vec3(-2.5, 0, 2.5), kEntryMm + Vec3(2.5, 0.1, 2.6), kBit}, options));
    volumes_.push_back(block({"c", kEntryMm + Vec3(0.8, 0.9, 0), kEntryMm + Vec3(-0.8, 0.4, 4.5), kBit}, options));
    for (PointVolume& volume : volumes_) pointers_.push_back(&volume);
  }

  std::vector<bool> occupied() const {
    std::vector<bool> all;
    for (const PointVolume& volume : volumes_) {
      for (int disc = 0; disc < volume.disc_count(); ++disc) {
        for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) all.push_back(volume.is_occupied(disc, i));
      }
    }
    return all;
  }

  const DrillBit kBit{1.4, 12.0, 1.0, BitShape::round_burr, 0.0, 0.6};
  std::vector<PointVolume> volumes_;
  std::vector<PointVolume*> pointers_;
};

TEST_P(OverlappingVolumes, KeepAPointWhereNoEarlierVolumeHasOne) {
  std::size_t before = 0;
  for (const PointVolume& volume : volumes_) before += volume.occupied_count();
  const std::size_t dropped = drop_shared_points(pointers_);
  EXPECT_GT(dropped, before / 10);
  EXPECT_EQ(drop_shared_points(pointers_), 0U);
  EXPECT_EQ(volumes_[0].occupied_count(), volumes_[0].point_count());
  // A dropped point lies within a spacing's cube of an earlier volume's point; a kept one has none nearer than half a
  // spacing, less what rows' ends stand back from it.
  std::size_t counted = 0;
  for (std::size_t later = 1; later < volumes_.size(); ++later) {
    const PointVolume& volume = volumes_[later];
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      for (std::size_t i = 0; i < volume.pattern().point_count(); i += 7) {
        const Vec3 p = volume.frame().to_patient(volume.point_in_path_mm(disc, i));
        double nearest_mm = 1e9;
        for (std::size_t earlier = 0; earlier < later; ++earlier) {
          const PointVolume& other = volumes_[earlier];
          const Vec3 q = other.frame().to_path(p);
          const auto plane = static_cast<int>(std::lround(q.z() / 0.1));
          for (int near = std::max(0, plane - 1); near <= std::min(plane + 1, other.disc_count() - 1); ++near) {
            for (std::size_t k = 0; k < other.pattern().point_count(); ++k) {
              nearest_mm = std::min(nearest_mm, (other.point_in_path_mm(near, k) - q).norm());
            }
          }
        }
        ++counted;
        if (volume.is_occupied(disc, i)) {
          ASSERT_GE(nearest_mm, 0.5 * 0.1 * 0.5 * std::numbers::sqrt3 - 1e-9);
        } else {
          ASSERT_LE(nearest_mm, 0.1);
        }
      }
    }
  }
  EXPECT_GT(counted, 1000U);
}

TEST_P(OverlappingVolumes, LoseWhatSweptBitsHoldOfTheKeptPoints) {
  const auto engine = make_leaf_engine(pointers_, kBit, {});
  std::vector<bool> expected = occupied();
  const SweepProfile profile{BitProfile(kBit)};
  Pose last;
  std::size_t all_removed = 0;
  for (int step = 0; step <= 40; ++step) {
    const double t = 0.15 * step;
    const Pose pose{kEntryMm + Vec3(1.5 * std::sin(t), 0.5 * std::cos(2.0 * t), 0.6 * t + 0.3),
                    Vec3(0.4, 0.02 * t, 0.8).normalized()};
    if (step == 0) last = pose;
    std::size_t removed = 0;
    std::size_t first = 0;
    for (const PointVolume& volume : volumes_) {
      // As engines see the way: in the volume's own frame.
      Pose to = volume.frame().to_path(pose);
      Pose from = volume.frame().to_path(last);
      to.axis /= to.axis.norm();
      from.axis /= from.axis.norm();
      const BitMotion motion(profile, from, to);
      for (std::size_t piece = 0; piece < motion.piece_count(); ++piece) {
        const SweptBit bit = motion.piece(piece);
        std::size_t n = first;
        for (int disc = 0; disc < volume.disc_count(); ++disc) {
          for (std::size_t i = 0; i < volume.pattern().point_count(); ++i, ++n) {
            if (!expected[n] || !bit.contains(volume.point_in_path_mm(disc, i))) continue;
            expected[n] = false;
            ++removed;
          }
        }
      }
      first += volume.point_count();
    }
    const StepResult result = engine->step(pose);
    EXPECT_EQ(result.removed, removed);
    ASSERT_EQ(occupied(), expected) << "step " << step;
    last = pose;
    all_removed += removed;
  }
  EXPECT_GT(all_removed, 5000U);
}

INSTANTIATE_TEST_SUITE_P(Patterns, OverlappingVolumes,
                         testing::Values(DiscSubdivision::rings, DiscSubdivision::hexagons));

TEST(LeafEngine, RejectsNoVolumesAndTheSameTwice) {
  const DrillBit bit{2.0, 8.0, 2.0};
  PointVolume volume = block(path_along(Vec3::UnitZ(), bit), {.radius_mm = 1.0, .spacing_mm = 0.2});
  const std::array<PointVolume*, 2> twice{&volume, &volume};
  const std::array<PointVolume*, 1> none{nullptr};
  EXPECT_THROW(make_leaf_engine(std::span<PointVolume* const>{}, bit, {}), Error);
  EXPECT_THROW(make_leaf_engine(twice, bit, {}), Error);
  EXPECT_THROW(make_leaf_engine(none, bit, {}), Error);
}

}  // namespace
}  // namespace spinaltap
