#include "core/session/coupling/virtual_coupling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "tests/support/plane_bone.h"

namespace spinaltap {
namespace {

constexpr double kCoupledDtS = 0.001;

DeviceLimits six_axis_limits() {
  DeviceLimits limits;
  limits.senses_turn = limits.gives_torque = true;
  limits.max_torque_n_mm = 200.0;
  limits.max_stiffness_n_mm_rad = 2000.0;
  limits.inertia_kg_mm2 = 300.0;
  limits.damping_n_mm_s_rad = 5.0;
  return limits;
}

Pose pose_down_at(double z_mm) { return {Vec3(0.0, 0.0, z_mm), Vec3::UnitZ(), Vec3::UnitX()}; }

DeviceNews device_news_of(const Pose& pose, std::uint32_t buttons = 1) { return {pose, buttons}; }

test::PlaneBone coupled_plane_bone() { return {twist_drill(3.0, 60.0, 118.0, 0.48), Material{}, 800.0, 1250.0}; }

TEST(VirtualCoupling, FollowsADeviceInAir) {
  VirtualCoupling tool({}, {}, {}, pose_down_at(-100.0));
  const double mm_s = 30.0;
  ToolInput input;
  for (int n = 1; n <= 1000; ++n)
    input = tool.step(device_news_of(pose_down_at(-100.0 + mm_s * n * kCoupledDtS)), {}, kCoupledDtS);
  // What it is felt with is the tool's own damping.
  const double drag_n = tool.gains().way.tool_damping * mm_s;
  EXPECT_NEAR(input.device.force_n.z(), -drag_n, 1e-3 * drag_n);
  EXPECT_NEAR(input.pose.tip_mm.z(), -70.0 - drag_n / (kStiffInAir * tool.gains().way.stiffness), 0.01);
  for (int n = 0; n < 1000; ++n) input = tool.step(device_news_of(pose_down_at(-70.0)), {}, kCoupledDtS);
  EXPECT_NEAR(input.pose.tip_mm.z(), -70.0, 1e-6);
  EXPECT_NEAR(input.device.force_n.norm(), 0.0, 1e-6);
}

TEST(VirtualCoupling, TurnsWithADeviceThatTurns) {
  VirtualCoupling tool(six_axis_limits(), {}, {}, pose_down_at(-100.0));
  const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
  const Pose turned{pose_down_at(-100.0).tip_mm, turn * Vec3::UnitZ(), turn * Vec3::UnitX()};
  ToolInput input;
  for (int n = 0; n < 2000; ++n) input = tool.step(device_news_of(turned), {}, kCoupledDtS);
  EXPECT_NEAR((input.pose.axis - turned.axis).norm(), 0.0, 1e-6);
  EXPECT_NEAR((input.pose.side - turned.side).norm(), 0.0, 1e-6);
  EXPECT_NEAR(input.device.torque_n_mm.norm(), 0.0, 1e-3);
  // One that does not sense turns keeps its axis.
  VirtualCoupling straight({}, {}, {}, pose_down_at(-100.0));
  for (int n = 0; n < 100; ++n) input = straight.step(device_news_of(turned), {}, kCoupledDtS);
  EXPECT_EQ(input.pose.axis, Vec3::UnitZ());
}

TEST(VirtualCoupling, IsHeldByBoneWithTheSpindleOff) {
  test::PlaneBone bone = coupled_plane_bone();
  VirtualCoupling tool({}, {}, {}, pose_down_at(-2.0));
  ToolFeedback felt;
  ToolInput input;
  for (int n = 0; n < 3000; ++n) {
    input = tool.step(device_news_of(pose_down_at(std::min(1.5, -2.0 + 20.0 * n * kCoupledDtS)), 0), felt, kCoupledDtS);
    EXPECT_FALSE(input.spindle_on);
    felt = bone.step(input);
  }
  // A few hundred N/mm against one: the tool stays pose_down_at the surface, and the hand feels its spring.
  EXPECT_LT(input.pose.tip_mm.z(), 0.02);
  EXPECT_NEAR(input.device.force_n.z(), -tool.gains().way.stiffness * (1.5 - input.pose.tip_mm.z()), 1e-3);
  EXPECT_NEAR(input.device.force_n.z(), felt.force.contact_n.z(), 1e-2);
}

TEST(VirtualCoupling, ShowsAWeakDeviceAStrongBone) {
  DeviceLimits limits;
  limits.max_force_n = 5.0;
  for (const double scale : {1.0, 0.1}) {
    test::PlaneBone bone = coupled_plane_bone();
    CouplingOptions options;
    options.force_scale = scale;
    VirtualCoupling tool(limits, options, {}, pose_down_at(-1.0));
    ToolFeedback felt;
    double most_n = 0.0;
    for (int n = 0; n < 3000; ++n) {
      const ToolInput input =
          tool.step(device_news_of(pose_down_at(std::min(50.0, -1.0 + 30.0 * n * kCoupledDtS))), felt, kCoupledDtS);
      felt = bone.step(input);
      if (n > 1500) most_n = std::max(most_n, felt.force.thrust_n);
      EXPECT_LE(input.device.force_n.norm(), limits.max_force_n * (1.0 + 1e-12));
    }
    // No more is cut with than can be shown.
    EXPECT_LT(most_n, 1.01 * limits.max_force_n / scale) << scale;
    EXPECT_EQ(bone.bottom_mm() > 0.5, scale < 0.5) << scale;
  }
}

TEST(VirtualCoupling, StandsAndDoesNotCutWhereTheDeviceIsLost) {
  test::PlaneBone bone = coupled_plane_bone();
  CouplingOptions options;
  options.force_scale = 0.1;
  VirtualCoupling tool({}, options, {}, pose_down_at(-1.0));
  ToolFeedback felt;
  ToolInput input;
  double z_mm = -1.0;
  const auto drill = [&] {
    z_mm = std::min(z_mm + 20.0 * kCoupledDtS, tool.first().tip_mm.z() + 40.0);
    input = tool.step(device_news_of(pose_down_at(z_mm)), felt, kCoupledDtS);
    felt = bone.step(input);
  };
  for (int n = 0; n < 1000; ++n) drill();
  ASSERT_TRUE(input.spindle_on);
  const double before_n = input.device.force_n.norm();
  ASSERT_GT(before_n, 1.0);
  Pose stood;
  double bottom_mm = 0.0;
  for (int n = 1; n <= 200; ++n) {
    input = tool.step({std::nullopt, 1}, felt, kCoupledDtS);
    felt = bone.step(input);
    EXPECT_EQ(input.device.status, n < 20 ? DeviceStatus::silent : DeviceStatus::lost) << n;
    EXPECT_EQ(input.spindle_on, n < 20) << n;
    if (n == 20) {
      stood = input.pose;
      bottom_mm = bone.bottom_mm();
    }
    if (n > 20) {
      EXPECT_EQ(input.pose.tip_mm, stood.tip_mm);
      EXPECT_EQ(bone.bottom_mm(), bottom_mm);
    }
    if (n >= 70) {
      EXPECT_EQ(input.device.force_n.norm(), 0.0) << n;
    }
    if (n >= 20 && n < 60) {
      EXPECT_GT(input.device.force_n.norm(), 0.0) << n;
    }
  }
  // It comes back little by little, and cuts again when all of the force is there.
  Vec3 last_n = Vec3::Zero();
  for (int n = 1; n <= 400; ++n) {
    drill();
    EXPECT_LE((input.device.force_n - last_n).norm(), 0.1 * DeviceLimits{}.max_force_n * (1.0 + 1e-9)) << n;
    last_n = input.device.force_n;
    if (n < 240) {
      EXPECT_FALSE(input.spindle_on) << n;
    }
  }
  EXPECT_TRUE(input.spindle_on);
}

TEST(VirtualCoupling, BoundsForceAndItsChangeWhateverTheDeviceSays) {
  const DeviceLimits limits = six_axis_limits();
  VirtualCoupling tool(limits, {}, {}, pose_down_at(0.0));
  test::PlaneBone bone = coupled_plane_bone();
  ToolFeedback felt;
  Wrench before;
  for (std::uint64_t n = 0; n < 5000; ++n) {
    const auto any = [&](std::uint64_t k) { return 2.0 * random_uniform(7, 10 * n + k) - 1.0; };
    DeviceNews news;
    news.buttons = any(8) > 0.0 ? 1 : 0;
    if (any(9) > -0.5) {
      const Vec3 axis = Vec3(any(0), any(1), any(2) + 2.0).normalized();
      news.pose = Pose{500.0 * Vec3(any(3), any(4), any(5)), axis, any_perpendicular(axis)};
    }
    const ToolInput input = tool.step(news, felt, kCoupledDtS);
    felt = bone.step(input);
    ASSERT_TRUE(input.pose.tip_mm.allFinite() && input.pose.axis.allFinite()) << n;
    EXPECT_NEAR(input.pose.axis.norm(), 1.0, 1e-9);
    EXPECT_LE(input.device.force_n.norm(), limits.max_force_n * (1.0 + 1e-12));
    EXPECT_LE(input.device.torque_n_mm.norm(), limits.max_torque_n_mm * (1.0 + 1e-12));
    EXPECT_LE((input.device.force_n - before.force_n).norm(), 0.1 * limits.max_force_n * (1.0 + 1e-9));
    EXPECT_LE((input.device.torque_n_mm - before.torque_n_mm).norm(), 0.1 * limits.max_torque_n_mm * (1.0 + 1e-9));
    before = {input.device.force_n, input.device.torque_n_mm};
  }
}

TEST(VirtualCoupling, IsHeldSidewaysByItsHole) {
  test::PlaneBone bone = coupled_plane_bone();
  CouplingOptions options;
  options.force_scale = 0.1;
  VirtualCoupling tool(six_axis_limits(), options, {}, pose_down_at(-1.0));
  ToolFeedback felt;
  ToolInput input;
  double z_mm = -1.0;
  while (bone.bottom_mm() < 10.0) {
    z_mm += 0.004;
    input = tool.step(device_news_of(pose_down_at(z_mm)), felt, kCoupledDtS);
    felt = bone.step(input);
    ASSERT_LT(z_mm, 200.0);
  }
  // The hand goes 2 mm aside within a tenth of a second: the bit does not, the hand feels it.
  const double x_mm = input.pose.tip_mm.x();
  Pose aside = pose_down_at(z_mm);
  for (int n = 0; n < 100; ++n) {
    aside.tip_mm.x() = 0.02 * n;
    input = tool.step(device_news_of(aside), felt, kCoupledDtS);
    felt = bone.step(input);
  }
  EXPECT_LT(std::abs(input.pose.tip_mm.x() - x_mm), 0.2);
  EXPECT_LT(input.device.force_n.x(), -0.5 * tool.gains().way.stiffness * 1.9);
}

}  // namespace
}  // namespace spinaltap
