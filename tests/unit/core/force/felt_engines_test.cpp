// Forces are the same bit for bit, whatever engine and however many threads.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "core/engine/volume_segments.h"
#include "core/force/drill_forces.h"
#include "tests/unit/core/engine/any_motion.h"
#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/every_engine.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;

std::vector<double> numbers(const DrillForce& force) {
  return {force.force_n.x(),       force.force_n.y(),       force.force_n.z(),          force.thrust_n,
          force.torque_n_mm,       force.lateral_n.x(),     force.lateral_n.y(),        force.lateral_n.z(),
          force.contact_n.x(),     force.contact_n.y(),     force.contact_n.z(),        force.feed_mm_per_turn,
          force.tip_density_g_cm3, force.resistance.lips_n, force.resistance.lips_n_mm, force.resistance.chisel_n};
}

void fill_with_holes(PointVolume& volume, std::uint64_t seed) {
  Draw draw(seed);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      volume.set_hu(disc, i, draw(0.0, 1500.0));
      volume.set_occupied(disc, i, draw(0.0, 1.0) < 0.9);
    }
  }
}

TEST(FeltEngines, GiveTheSameForcesInAnyMotion) {
  const std::vector<test::Tool> tools = test::every_tool();
  int felt_runs = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const DrillBit bit = tools[seed % tools.size()].bit;
    PointVolume whole(test::askew_path(3.0), {.radius_mm = 1.5, .spacing_mm = 0.15});
    fill_with_holes(whole, seed);
    const std::vector<test::NamedEngine> kinds = test::three_engines();
    std::vector<PointVolume> volumes(kinds.size(), whole);
    std::vector<std::unique_ptr<DrillEngine>> engines;
    std::vector<DrillForces> forces;
    for (std::size_t n = 0; n < kinds.size(); ++n) {
      engines.push_back(kinds[n].make(volumes[n], bit, {}));
      forces.emplace_back(std::span<const PointVolume>(&volumes[n], 1), bit, Material());
    }
    test::AnyMotion motion(seed, 3.0, 1.5);
    Draw draw(seed + 100);
    double max_n = 0.0;
    for (int step = 0; step < 80; ++step) {
      const Pose pose = whole.frame().to_patient(motion.next());
      const Spindle spindle{.rpm = draw(0.0, 1.0) < 0.1 ? 0.0 : draw(100.0, 3000.0), .is_clockwise = step < 40};
      std::vector<double> first;
      for (std::size_t n = 0; n < kinds.size(); ++n) {
        const StepResult result = spindle.rpm > 0.0 ? engines[n]->step(pose) : StepResult{};
        const std::vector<double> felt = numbers(forces[n].update(result, pose, 0.001, spindle));
        for (const double number : felt) ASSERT_TRUE(std::isfinite(number));
        if (n == 0) first = felt;
        ASSERT_EQ(felt, first) << kinds[n].name << ", step " << step;
      }
      max_n = std::max(max_n, std::abs(first[3]));
    }
    if (max_n > 0.0) ++felt_runs;
  }
  EXPECT_GT(felt_runs, 15);
}

TEST(FeltEngines, GiveTheSameForcesAtOneAndTwoThreads) {
  const DrillBit bit{2.5, 8.0, 1.0, BitShape::round_burr, 0.0, 0.6};
  const auto run = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    PointVolume volume(test::askew_path(3.0), {.radius_mm = 2.0, .spacing_mm = 0.05});
    fill_with_holes(volume, 4);
    const auto engine = make_ring_engine(volume, bit, {});
    DrillForces forces({&volume, 1}, bit, {});
    std::vector<double> all;
    for (int step = 0; step < 30; ++step) {
      const double x_mm = step % 2 == 0 ? -1.0 : 1.0;  // steps of 2 mm have work for many threads
      const Pose pose = test::pose_at(volume, Vec3(x_mm, 0.0, 0.1 * step));
      const std::vector<double> felt = numbers(forces.update(engine->step(pose), pose, 0.001, {}));
      all.insert(all.end(), felt.begin(), felt.end());
    }
    return all;
  };
  const std::vector<double> one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_GT(*std::max_element(one.begin(), one.end()), 0.0);
}

TEST(FeltEngines, FeelVolumesOfManySpacingsAsOne) {
  // Fine in the middle, coarse around: the same block, the same force throughout.
  const DrillBit bit = twist_drill(3.06, 40.0, 118.0, 0.5);
  std::vector<PointVolume> volumes =
      make_segments(test::askew_path(12.0), {{0.0, 5.0, 0.2}, {5.0, 8.0, 0.1}, {8.0, 12.0, 0.2}}, {.radius_mm = 2.4});
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume& volume : volumes) {
    test::fill_hu(volume, 400.0);
    engines.push_back(make_ring_engine(volume, bit, {}));
  }
  const auto joint = make_joint_engine(std::move(engines));
  DrillForces forces(volumes, bit, {});
  const CuttingResistance block = resistance_of_block(bit, Material(), 400.0);
  for (int n = 0; n < 5'500; ++n) {
    const double z_mm = -0.2 + 0.002 * n;
    const Pose pose = test::pose_at(volumes.front(), Vec3(0.0, 0.0, z_mm));
    const DrillForce force = forces.update(joint->step(pose), pose, 0.001, {});
    if (z_mm < 2.5) continue;
    // Where a spacing gives way to another, discs come out of step by half of one: 5 % of a box of 0.2 mm.
    const double thrust_n = block.thrust_n(0.096);
    ASSERT_NEAR(force.thrust_n, thrust_n, 0.05 * thrust_n) << z_mm;
    if (z_mm > 9.5 || (z_mm < 4.5)) {
      ASSERT_NEAR(force.thrust_n, thrust_n, 0.01 * thrust_n) << z_mm;
    }
  }
}

}  // namespace
}  // namespace spinaltap
