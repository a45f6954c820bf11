#include "core/session/compliant_tool.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "tests/support/drill_block.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

const DrillBit kBit = twist_drill(3.0, 50.0, 118.0, 0.48);
constexpr double kDtS = 0.001;

ComplianceOptions compliant() { return {.is_on = true}; }

Pose down() { return {Vec3(1.0, 2.0, 3.0), Vec3::UnitZ()}; }

/// A thrust on a surface that slopes by so many degrees, the tip not yet in bone.
CompliantTool::Met on_slope(double thrust_n, double slope_deg, double inside_mm = 0.0) {
  CompliantTool::Met met;
  met.force.thrust_n = thrust_n;
  met.tip.inside_mm = inside_mm;
  met.into_bone = Vec3(-std::sin(slope_deg * kDegree), 0.0, std::cos(slope_deg * kDegree));
  return met;
}

TEST(CompliantTool, BendsAsABeamDoes) {
  for (const double free_mm : {30.0, 50.0, 80.0}) {
    ComplianceOptions options = compliant();
    options.free_length_mm = free_mm;
    options.flutes_share = 1.0;
    CompliantTool tool(kBit, options);
    CompliantTool::Met met;
    met.force.lateral_n = Vec3(4.0, -3.0, 0.0);
    met.tip.inside_mm = -1.0;
    Pose real;
    for (int n = 0; n < 500; ++n) real = tool.real_pose(down(), met, kDtS);
    // F L³ / 3 E I of a full round bar, and its end's slope, F L² / 2 E I.
    const double bending_n_mm2 = 200e3 * std::numbers::pi * std::pow(3.0, 4) / 64.0;
    const double off_mm = 5.0 * std::pow(free_mm, 3) / (3.0 * bending_n_mm2);
    EXPECT_NEAR((real.tip_mm - down().tip_mm).norm(), off_mm, 1e-3 * off_mm) << free_mm;
    EXPECT_NEAR(std::atan2(real.axis.head<2>().norm(), real.axis.z()),
                std::atan(5.0 * free_mm * free_mm / (2.0 * bending_n_mm2)), 1e-4);
    EXPECT_GT((real.tip_mm - down().tip_mm).dot(met.force.lateral_n), 0.0) << "to where the force pushes";
  }
}

TEST(CompliantTool, WalksDownASlopeUntilItsSpringAndFrictionHoldIt) {
  for (const double thrust_n : {10.0, 30.0}) {
    for (const double slope_deg : {20.0, 40.0}) {
      CompliantTool tool(kBit, compliant());
      for (int n = 0; n < 1000; ++n) tool.real_pose(down(), on_slope(thrust_n, slope_deg), kDtS);
      const double expected_mm = thrust_n * (std::sin(slope_deg * kDegree) - 0.25) / tool.stiffness_n_mm(0.0);
      EXPECT_NEAR(tool.off_mm().x(), expected_mm, 0.01 * expected_mm) << thrust_n << " N, " << slope_deg;
      EXPECT_EQ(tool.off_mm().y(), 0.0);
    }
  }
}

TEST(CompliantTool, StandsWhereFrictionHoldsIt) {
  CompliantTool tool(kBit, compliant());
  const double held_deg = std::asin(0.25) / kDegree;
  for (int n = 0; n < 1000; ++n) tool.real_pose(down(), on_slope(50.0, held_deg - 0.5), kDtS);
  EXPECT_EQ(tool.off_mm(), Vec3::Zero());
}

TEST(CompliantTool, IsLedByItsHoleOnceItHasBitten) {
  CompliantTool tool(kBit, compliant());
  for (int n = 0; n < 1000; ++n) tool.real_pose(down(), on_slope(30.0, 40.0), kDtS);
  const double walked_mm = tool.off_mm().x();
  ASSERT_GT(walked_mm, 0.5);
  // It stands in its hole: nothing brings it back.
  CompliantTool::Met met = on_slope(30.0, 40.0, 1.0);
  for (int n = 0; n < 1000; ++n) tool.real_pose(down(), met, kDtS);
  EXPECT_EQ(tool.off_mm().x(), walked_mm);
  // It goes on: along its bent end, and aside by spring over thrust, d off / d depth = (1.5 / L - k / T) off.
  met.advance_mm = 1e-3;
  const double free_mm = 50.0 - 1.0;
  const double rate = 1.5 / free_mm - tool.stiffness_n_mm(1.0) / 30.0;
  for (int n = 0; n < 2000; ++n) tool.real_pose(down(), met, kDtS);
  EXPECT_NEAR(tool.off_mm().x(), walked_mm * std::exp(rate * 2.0), 1e-3 * walked_mm);
}

TEST(CompliantTool, TurnsAsItsMotorsLineHasIt) {
  ComplianceOptions options = compliant();
  options.stall_n_mm = 200.0;
  CompliantTool tool(kBit, options);
  CompliantTool::Met met;
  met.force.torque_n_mm = 50.0;
  Spindle real;
  for (int n = 0; n < 2000; ++n) real = tool.real_spindle({}, met, kDtS);
  EXPECT_NEAR(real.rpm, 0.75 * 1250.0, 0.1);
  EXPECT_FALSE(tool.is_stalled());
  met.force.torque_n_mm = 250.0;
  for (int n = 0; n < 2000; ++n) real = tool.real_spindle({}, met, kDtS);
  EXPECT_TRUE(tool.is_stalled());
  EXPECT_EQ(real.rpm, 0.0);
  // It stays so without a load, until it is drawn back.
  met.force.torque_n_mm = 0.0;
  for (int n = 0; n < 2000; ++n) real = tool.real_spindle({}, met, kDtS);
  EXPECT_EQ(real.rpm, 0.0);
  met.advance_mm = -0.01;
  for (int n = 0; n < 60; ++n) real = tool.real_spindle({}, met, kDtS);
  EXPECT_FALSE(tool.is_stalled());
  met.advance_mm = 0.0;
  for (int n = 0; n < 2000; ++n) real = tool.real_spindle({}, met, kDtS);
  EXPECT_NEAR(real.rpm, 1250.0, 0.1);
}

TEST(CompliantTool, RejectsOptionsWithoutSense) {
  using test::kNan;
  for (const ComplianceOptions& options :
       {ComplianceOptions{.free_length_mm = -1.0}, ComplianceOptions{.free_length_mm = kNan},
        ComplianceOptions{.young_gpa = 0.0}, ComplianceOptions{.flutes_share = 0.0},
        ComplianceOptions{.friction = kNan}, ComplianceOptions{.bite_mm = -1.0}, ComplianceOptions{.stall_n_mm = -1.0},
        ComplianceOptions{.spin_up_s = 0.0}}) {
    EXPECT_THROW(CompliantTool(kBit, options), Error);
  }
}

TEST(CompliantSession, StallsInBoneThatIsTooHardForItsMotor) {
  test::DrillBlock block([](double depth_mm) { return depth_mm >= 0.0 ? 1200.0 : test::kNan; }, 10.0);
  SessionOptions options;
  options.compliance = {.is_on = true, .stall_n_mm = 20.0};
  const auto session = block.session(options);
  for (int n = 0; n <= 5000; ++n) session->step(block.input(-1.0 + 0.001 * n));
  const auto stalls = test::events_of(*session, EventKind::stall);
  ASSERT_EQ(stalls.size(), 1U);
  EXPECT_GE(stalls[0].value, 0.9 * 20.0);
  EXPECT_EQ(session->last().force.torque_n_mm, 0.0);
  EXPECT_GT(session->last().force.contact_n.norm(), 1.0) << "a drill that stands is pressed on bone";
}

TEST(CompliantSession, IsTheSameAsAStiffOneWhereNothingGivesWay) {
  const auto layers = [](double depth_mm) { return depth_mm >= 0.0 ? 300.0 : test::kNan; };
  test::DrillBlock stiff(layers, 10.0), bends(layers, 10.0);
  SessionOptions options;
  options.compliance = {.is_on = true, .young_gpa = 1000.0, .flutes_share = 1.0};
  const auto first = stiff.session();
  const auto second = bends.session(options);
  for (int n = 0; n <= 5000; ++n) {
    const Cycle& is = first->step(stiff.input(-1.0 + 0.001 * n));
    const Cycle& other = second->step(bends.input(-1.0 + 0.001 * n));
    // On the path of an even block no force goes across it.
    ASSERT_NEAR((other.pose.tip_mm - is.pose.tip_mm).norm(), 0.0, 0.02) << n;
    ASSERT_NEAR(other.force.thrust_n, is.force.thrust_n, 0.02 * is.force.thrust_n + 0.05) << n;
  }
}

}  // namespace
}  // namespace spinaltap
