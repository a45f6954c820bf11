// Forces in even blocks, against the model in closed form.

#include "core/force/drill_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

using test::feed_mm;
using test::FeltBit;
using test::kFeltHu;

/// Of averaging, at most, at spacings of up to 0.2 mm: two boxes.
constexpr double kAveragedMm = 0.8;

struct NamedBit {
  const char* name;
  DrillBit bit;
};

const std::vector<NamedBit>& named_bits() {
  // The wall of 3.0 mm lies on a ring of points at 0.1 and 0.05 mm, that of 3.2 mm at all spacings.
  static const std::vector<NamedBit> all{{"3.0 mm", {3.0, 50.0, 5.0}},
                                         {"3.06 mm", {3.06, 50.0, 5.0}},
                                         {"3.2 mm", {3.2, 50.0, 5.0}},
                                         {"twist drill of 3.2 mm", twist_drill(3.2, 50.0, 118.0, 0.5)}};
  return all;
}

class EvenBlock : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Spacings, EvenBlock, ::testing::Values(0.2, 0.1, 0.05));

/// Drills to where the whole tip is in, then on in steps of `step_mm`; calls `see` of all cycles over two discs and
/// more from where nothing but such steps is averaged.
void drill_steadily(PointVolume& volume, const NamedBit& tool, double offset_mm, double step_mm,
                    const std::function<void(double, const DrillForce&)>& see) {
  FeltBit felt(volume, tool.bit);
  const double whole_mm = tool.bit.tip_length_mm + 0.2;
  felt.drill(Vec3(offset_mm, 0.0, -0.3), whole_mm, 0.02);
  // Two boxes of 0.2 mm, and 100 cycles after which the speed's filter of 5 ms has come to rest.
  const double even_mm = whole_mm + 0.41 + 100.0 * step_mm;
  felt.drill(Vec3(offset_mm, 0.0, whole_mm), even_mm + 0.41, step_mm, [&](double z_mm, const DrillForce& force) {
    if (z_mm > even_mm) see(z_mm, force);
  });
}

TEST_P(EvenBlock, GivesThrustAndTorqueOfTheClosedFormInEveryCycle) {
  const Spindle spindle;
  double worst = 0.0;
  for (const NamedBit& tool : named_bits()) {
    for (const double offset_mm : {0.0, 0.83}) {
      for (const double step_mm : {0.0001, 0.001, 0.01, 0.02}) {
        SCOPED_TRACE(::testing::Message() << tool.name << ", " << offset_mm << " mm off, steps of " << step_mm);
        const CuttingResistance block = resistance_of_block(tool.bit, Material(), kFeltHu);
        const double feed = feed_mm(step_mm, spindle);
        PointVolume volume = test::block(tool.bit.tip_length_mm + 6.0, 2.8, GetParam(), kFeltHu);
        int seen = 0;
        drill_steadily(volume, tool, offset_mm, step_mm, [&](double, const DrillForce& force) {
          ++seen;
          const double thrust = force.thrust_n / block.thrust_n(feed) - 1.0;
          const double torque = force.torque_n_mm / block.torque_n_mm(feed) - 1.0;
          worst = std::max({worst, std::abs(thrust), std::abs(torque)});
          EXPECT_NEAR(force.feed_mm_per_turn, feed, 1e-4 * feed);
        });
        EXPECT_GE(seen, 20);
      }
    }
  }
  std::printf("at %.2f mm, worst cycle: %.2f %%\n", GetParam(), 100.0 * worst);
  EXPECT_LT(worst, 0.01);
}

TEST(ResistanceOfBlock, IsTheModelWrittenOut) {
  Material material;
  material.density = {0.0, 0.001};
  const DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  const CuttingResistance block = resistance_of_block(bit, material, 1500.0);
  const double feed = 0.06;
  const double energy_mpa = material.specific_cutting_energy_mpa * std::pow(1.5, 2.0) * std::pow(feed / 0.1, -0.3);
  const double torque_n_mm = energy_mpa * feed * 1.6 * 1.6 / 2.0;
  const double chisel_n = material.chisel_mpa * std::pow(1.5, 2.0) * std::numbers::pi * 0.25 * 0.25;
  EXPECT_NEAR(block.torque_n_mm(feed), torque_n_mm, 1e-12 * torque_n_mm);
  EXPECT_NEAR(block.thrust_n(feed), material.lip_thrust_share * 2.0 * torque_n_mm / 1.6 + chisel_n, 1e-9);
  EXPECT_EQ(block.thrust_n(0.0), 0.0);
  EXPECT_EQ(block.torque_n_mm(0.0), 0.0);
  double before_n = 0.0;
  for (double f = 1e-5; f < 1.0; f *= 1.3) {
    EXPECT_GT(block.thrust_n(f), before_n);
    before_n = block.thrust_n(f);
  }
  // A bit that states no chisel edge has one of the material's share of its diameter.
  EXPECT_NEAR(resistance_of_block({3.2, 50.0, 5.0}, material, 1500.0).chisel_n,
              chisel_n * std::pow(material.chisel_share * 3.2 / 0.5, 2.0), 1e-9);
}

TEST(DrillForces, OfHalfABlockAreHalfTheTorqueAndALateralForce) {
  // Lips cut on one side only: the tangential force, u f R / pi on average over a turn, against the turn, and its share
  // away from the bone. Through the axis in a direction in which no point lies: exactly half of them.
  const DrillBit bit{3.06, 50.0, 5.0};
  const Vec3 towards(std::cos(0.1234), std::sin(0.1234), 0.0);
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  for (const bool is_clockwise : {true, false}) {
    PointVolume volume = test::block(9.0, 2.8, 0.1, kFeltHu);
    test::fill_density(volume, material, [&](const Vec3& p) { return p.dot(towards) > 0.0 ? density : 0.0; });
    FeltBit felt(volume, bit, material, {.rpm = 1250.0, .is_clockwise = is_clockwise});
    const CuttingResistance block = resistance_of_block(bit, material, kFeltHu);
    const double feed = feed_mm(0.002, felt.spindle());
    const double torque_n_mm = block.torque_n_mm(feed);
    const double along_cut_n = 2.0 * torque_n_mm / (std::numbers::pi * bit.radius_mm());
    felt.drill(Vec3(0.0, 0.0, -0.3), 8.0, 0.002, [&](double z_mm, const DrillForce& force) {
      if (z_mm < 6.5) return;
      EXPECT_NEAR(force.torque_n_mm, 0.5 * torque_n_mm, 0.01 * torque_n_mm);
      const double lips_n = block.thrust_n(feed) - block.chisel_n;
      EXPECT_NEAR(force.resistance.thrust_n(feed) - force.resistance.chisel_n, 0.5 * lips_n, 0.01 * lips_n);
      const Vec3 lateral_n = felt.along_path(force.lateral_n);
      // Clockwise from the base: a lip on the side of the bone moves along axis x side, and bone pushes back.
      const Vec3 with_turn = (is_clockwise ? 1.0 : -1.0) * Vec3::UnitZ().cross(towards);
      EXPECT_NEAR(lateral_n.dot(with_turn), -along_cut_n, 0.02 * along_cut_n);
      EXPECT_NEAR(lateral_n.dot(towards), -material.lip_thrust_share * along_cut_n, 0.02 * along_cut_n);
      EXPECT_NEAR(lateral_n.z(), 0.0, 1e-9);
      const Vec3 whole_n = felt.along_path(force.force_n);
      EXPECT_NEAR((whole_n - lateral_n + force.thrust_n * Vec3::UnitZ()).norm(), 0.0, 1e-9);
    });
  }
}

TEST(DrillForces, ChangeWithTheFeedAtOnceAndNotWithoutOne) {
  const DrillBit bit{3.06, 50.0, 5.0};
  PointVolume volume = test::block(12.0, 2.0, 0.1, kFeltHu);
  FeltBit felt(volume, bit);
  const CuttingResistance block = resistance_of_block(bit, Material(), kFeltHu);
  felt.drill(Vec3(0.0, 0.0, -0.3), 8.0, 0.001);
  // 25 ms at four times the feed are 0.1 mm: long before what is cut has been averaged anew.
  double z_mm = 8.0;
  DrillForce force;
  for (int n = 0; n < 25; ++n) force = felt.move_to(Vec3(0.0, 0.0, z_mm += 0.004));
  const double fast_n = block.thrust_n(feed_mm(0.004, felt.spindle()));
  EXPECT_NEAR(force.thrust_n, fast_n, 0.015 * fast_n);
  // Standing still: nothing after some filters of 5 ms, but the resistance is known.
  for (int n = 0; n < 100; ++n) force = felt.move_to(Vec3(0.0, 0.0, z_mm));
  EXPECT_LT(force.thrust_n, 1e-3 * fast_n);
  EXPECT_LT(force.torque_n_mm, 1e-3);
  EXPECT_NEAR(force.resistance.thrust_n(0.05), block.thrust_n(0.05), 0.01 * block.thrust_n(0.05));
}

TEST(DrillForces, AreThoseOfTheFeedUnderTremorAcrossTheAxis) {
  // An operator trembles six times as fast across the axis as it feeds. The hole gets wider, which costs torque; the
  // thrust is still that of the feed along the axis.
  const DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  PointVolume volume = test::block(10.0, 2.8, 0.1, kFeltHu);
  FeltBit felt(volume, bit);
  const CuttingResistance block = resistance_of_block(bit, Material(), kFeltHu);
  const double feed = feed_mm(0.001, felt.spindle());
  double sum_n = 0.0, max_n = 0.0, min_n = 1e9;
  int count = 0;
  for (int n = 0; n < 9'000; ++n) {
    const double z_mm = -0.3 + 0.001 * n;
    const Vec3 tremor = 0.1 * Vec3(std::sin(0.0628 * n), std::cos(0.0571 * n), 0.0);
    const DrillForce& force = felt.move_to(tremor + Vec3(0.0, 0.0, z_mm));
    if (z_mm < 3.0) continue;
    ++count;
    sum_n += force.thrust_n;
    max_n = std::max(max_n, force.thrust_n);
    min_n = std::min(min_n, force.thrust_n);
  }
  // The hole, wider by the tremor, has up to (1.7 / 1.6)² times the section.
  EXPECT_NEAR(sum_n / count, block.thrust_n(feed), 0.05 * block.thrust_n(feed));
  EXPECT_GT(min_n, 0.85 * block.thrust_n(feed));
  EXPECT_LT(max_n, 1.15 * block.thrust_n(feed));
}

TEST(DrillForces, OfABitThatWentBackComeBackWhereItLeft) {
  const DrillBit bit{3.06, 50.0, 5.0};
  PointVolume volume = test::block(12.0, 2.0, 0.1, kFeltHu);
  FeltBit felt(volume, bit);
  felt.drill(Vec3(0.0, 0.0, -0.3), 8.0, 0.002);
  const double before_n = felt.move_to(Vec3(0.0, 0.0, 8.002)).thrust_n;
  for (double z_mm = 8.0; z_mm > 5.0; z_mm -= 0.01) felt.move_to(Vec3(0.0, 0.0, z_mm));
  EXPECT_EQ(felt.move_to(Vec3(0.0, 0.0, 5.0)).thrust_n, 0.0);
  felt.drill(Vec3(0.0, 0.0, 5.0), 9.0, 0.002, [&](double z_mm, const DrillForce& force) {
    // Two discs ahead are felt.
    if (z_mm > 5.1 && z_mm < 7.75) {
      EXPECT_EQ(force.thrust_n, 0.0) << z_mm;
    }
    if (z_mm > 8.05) {
      EXPECT_NEAR(force.thrust_n, before_n, 0.01 * before_n) << z_mm;
    }
  });
}

TEST(DrillForces, AreZeroOutsideBoneAndAfterLeavingIt) {
  const DrillBit bit = twist_drill(3.0, 50.0, 118.0, 0.5);
  PointVolume volume = test::block(16.0, 2.0, 0.1, kFeltHu);
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  test::fill_density(volume, material, [&](const Vec3& p) { return p.z() > 2.0 && p.z() < 8.0 ? density : 0.0; });
  FeltBit felt(volume, bit);
  felt.drill(Vec3(0.0, 0.0, -0.3), 14.0, 0.005, [&](double z_mm, const DrillForce& force) {
    if (z_mm < 1.7 || z_mm > 8.0 + bit.tip_length_mm + kAveragedMm) {
      EXPECT_EQ(force.force_n.norm(), 0.0) << z_mm;
      EXPECT_EQ(force.torque_n_mm, 0.0) << z_mm;
      EXPECT_EQ(force.tip_density_g_cm3, 0.0) << z_mm;
    } else if (z_mm > 2.1 && z_mm < 7.7) {
      EXPECT_NEAR(force.tip_density_g_cm3, density, 1e-3) << z_mm;
      EXPECT_GT(force.thrust_n, 0.0) << z_mm;
    }
  });
}

TEST(DrillForces, AllocateNothingAndTakeBadPosesAsNone) {
  static_assert(noexcept(std::declval<DrillForces&>().update(
      std::declval<const StepResult&>(), std::declval<const Pose&>(), 0.0, std::declval<const Spindle&>())));
  PointVolume volume = test::block(8.0, 2.0, 0.1, kFeltHu);
  FeltBit felt(volume, {3.0, 50.0, 5.0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t before = test::allocation_count();
  for (int n = 0; n < 3'000; ++n) felt.move_to(Vec3(0.1 * std::sin(0.05 * n), 0.0, 0.002 * n));
  const DrillForce good = felt.move_to(Vec3(0.0, 0.0, 6.0));
  for (const Pose& pose : {Pose{Vec3::Constant(nan), Vec3::UnitZ()}, Pose{Vec3::Zero(), Vec3::Zero()}}) {
    EXPECT_EQ(felt.forces().update({}, pose, 0.001, {}).force_n, Vec3::Zero());
  }
  for (const double dt_s : {0.0, -1.0, nan}) {
    EXPECT_EQ(felt.forces().update({}, test::pose_at(volume, Vec3(0, 0, 6)), dt_s, {}).force_n, Vec3::Zero());
  }
  EXPECT_GT(felt.move_to(Vec3(0.0, 0.0, 6.002)).thrust_n, 0.5 * good.thrust_n);
  felt.spindle().rpm = 0.0;
  felt.move_to(Vec3(0.0, 0.0, 6.1));
  felt.forces().reset();
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_THROW(DrillForces({&volume, 1}, {nan, 50.0, 5.0}, {}), Error);
  Material bad;
  bad.chisel_mpa = nan;
  EXPECT_THROW(DrillForces({&volume, 1}, {}, bad), Error);
  EXPECT_THROW(DrillForces(std::span<const PointVolume>(), {}, {}), Error);
}

TEST(DrillForces, StartAnewWhenReset) {
  PointVolume first = test::block(8.0, 2.0, 0.1, kFeltHu);
  PointVolume second = first;
  FeltBit felt(first, {3.0, 50.0, 5.0});
  FeltBit fresh(second, {3.0, 50.0, 5.0});
  felt.drill(Vec3(0.0, 0.0, -0.3), 3.0, 0.003);
  fresh.drill(Vec3(0.0, 0.0, -0.3), 3.0, 0.003);
  felt.forces().reset();
  DrillForces other({&second, 1}, {3.0, 50.0, 5.0}, {});
  for (int n = 0; n < 500; ++n) {
    const Pose pose = test::pose_at(first, Vec3(0.05, 0.0, 3.0 + 0.004 * n));
    const DrillForce a = felt.forces().update(felt.engine().step(pose), pose, 0.001, {});
    const DrillForce b = other.update(fresh.engine().step(pose), pose, 0.001, {});
    ASSERT_EQ(a.force_n, b.force_n);
    ASSERT_EQ(a.torque_n_mm, b.torque_n_mm);
  }
}

}  // namespace
}  // namespace spinaltap
