#include "apps/link/link_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr std::int64_t kMsNs = 1'000'000;

LinkTransform at(const Vec3& place_mm, double angle = 0.0, const Vec3& about = Vec3::UnitZ()) {
  LinkTransform transform = LinkTransform::Identity();
  transform.linear() = Eigen::AngleAxisd(angle, about.normalized()).toRotationMatrix();
  transform.translation() = place_mm;
  return transform;
}

TEST(LinkFrames, TurnLeftIntoRightAndBackIntoFront) {
  // A place 10 mm to the patient's left, 20 mm to the back, 30 mm to the head.
  EXPECT_EQ(ras_from_lps(Vec3(10.0, 20.0, 30.0)), Vec3(-10.0, -20.0, 30.0));
  EXPECT_EQ(lps_from_ras(Vec3(-10.0, -20.0, 30.0)), Vec3(10.0, 20.0, 30.0));
  EXPECT_EQ(ras_from_lps(Eigen::Vector3f(1.0F, 2.0F, 3.0F)), Eigen::Vector3f(-1.0F, -2.0F, 3.0F));
}

TEST(LinkFrames, OfABitHaveTheTipAsOriginAndItsAxisAsZ) {
  // Drilling forward, to the patient's front: y of RAS.
  const LinkTransform bit = bit_in_ras({Vec3(10.0, 20.0, 30.0), -Vec3::UnitY(), Vec3::Zero()});
  EXPECT_EQ(bit.translation(), Vec3(-10.0, -20.0, 30.0));
  EXPECT_LT((bit.linear().col(2) - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_NEAR(bit.linear().determinant(), 1.0, 1e-12);
}

TEST(LinkFrames, GoThereAndBackThroughAMessage) {
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 200; ++n) {
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    Pose pose{100.0 * vector(), vector().normalized(), vector()};
    pose.side = (pose.side - pose.side.dot(pose.axis) * pose.axis).normalized();
    const std::optional<LinkTransform> sent = transform_of(transform_content(bit_in_ras(pose)));
    ASSERT_TRUE(sent);
    const Pose back = pose_in_lps(*sent, {});
    // Floats have 24 bits: 3e-5 mm of a place some 400 mm away.
    EXPECT_LT((back.tip_mm - pose.tip_mm).norm(), 1e-4);
    EXPECT_LT((back.axis - pose.axis).norm(), 1e-6);
    EXPECT_LT((back.side - pose.side).norm(), 1e-6);
    EXPECT_NEAR(back.axis.norm(), 1.0, 1e-15);
  }
}

TEST(LinkFrames, OfAToolMayHaveTheTipAnywhere) {
  const ToolFrame frame = tool_frame(Vec3(0.0, 0.0, 120.0), Vec3(0.0, 0.0, 2.0));
  EXPECT_EQ(frame.axis, Vec3::UnitZ());
  // The tool's z turned onto the patient's right, x of RAS: the tip 120 mm to the right, which is -x of LPS.
  const Pose pose = pose_in_lps(at(Vec3(1.0, 2.0, 3.0), std::acos(0.0), Vec3::UnitY()), frame);
  EXPECT_LT((pose.tip_mm - Vec3(-121.0, -2.0, 3.0)).norm(), 1e-9);
  EXPECT_LT((pose.axis - Vec3(-1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_THROW(tool_frame(Vec3::Zero(), Vec3::Zero()), Error);
  EXPECT_THROW(tool_frame(Vec3(std::nan(""), 0.0, 0.0), Vec3::UnitZ()), Error);
  EXPECT_THROW(tool_frame(Vec3(5000.0, 0.0, 0.0), Vec3::UnitZ()), Error);
}

TEST(Tracking, PutsTheToolIntoThePatientWhereverTheTrackerStands) {
  // The same tool on the same patient, seen by a tracker that is carried around: the pose stays.
  const LinkTransform patient = at(Vec3(5.0, -7.0, 100.0), 0.4, Vec3(1.0, 1.0, 0.0));
  const LinkTransform tool_in_reference = at(Vec3(30.0, 40.0, 50.0), 1.1, Vec3(0.0, 1.0, 2.0));
  const Pose expected = pose_in_lps(patient * tool_in_reference, {});
  for (int n = 0; n < 5; ++n) {
    const LinkTransform reference_in_tracker = at(Vec3(100.0 * n, -20.0, 800.0), 0.3 * n, Vec3(1.0, 0.2, 0.1 * n));
    Tracking tracking({});
    tracking.update(LinkDevice::patient, patient, true, kMsNs);
    tracking.update(LinkDevice::reference, reference_in_tracker, true, kMsNs);
    tracking.update(LinkDevice::tool, reference_in_tracker * tool_in_reference, true, kMsNs);
    const std::optional<Pose> pose = tracking.pose(2 * kMsNs);
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->tip_mm - expected.tip_mm).norm(), 1e-9);
    EXPECT_LT((pose->axis - expected.axis).norm(), 1e-12);
  }
}

TEST(Tracking, TakesARegistrationUntilATransformComes) {
  RigidPose ct_from_patient;
  ct_from_patient.rotation = Eigen::AngleAxisd(0.7, Vec3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  ct_from_patient.translation_mm = Vec3(12.0, -30.0, 400.0);
  Tracking tracking({.needs_patient = true, .registration = ct_from_patient});
  // A tip that was measured at these RAS numbers, LPS in the registration.
  const Vec3 measured_ras(31.0, -44.0, 70.0);
  tracking.update(LinkDevice::tool, at(measured_ras), true, kMsNs);
  const std::optional<Pose> pose = tracking.pose(2 * kMsNs);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->tip_mm - ct_from_patient.apply(Vec3(-31.0, 44.0, 70.0))).norm(), 1e-9);
  // The tool's z is the reference's, and turns as the registration does.
  EXPECT_LT((pose->axis - ct_from_patient.rotation.col(2)).norm(), 1e-12);
  tracking.update(LinkDevice::patient, LinkTransform::Identity(), true, 3 * kMsNs);
  EXPECT_LT((tracking.pose(4 * kMsNs)->tip_mm - Vec3(-31.0, 44.0, 70.0)).norm(), 1e-9);
}

TEST(Tracking, IsStaleAfterHalfASecondWithoutToolOrReferenceButKeepsARegistration) {
  Tracking tracking({});
  EXPECT_EQ(tracking.state(0), TrackingState::waiting);
  EXPECT_FALSE(tracking.pose(0));
  tracking.update(LinkDevice::patient, LinkTransform::Identity(), true, 0);
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 1000 * kMsNs);
  EXPECT_EQ(tracking.state(1500 * kMsNs), TrackingState::ok);
  EXPECT_EQ(tracking.state(1501 * kMsNs), TrackingState::stale);
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 60'000 * kMsNs);
  EXPECT_EQ(tracking.state(60'100 * kMsNs), TrackingState::ok);  // the registration is a minute old
  tracking.update(LinkDevice::reference, LinkTransform::Identity(), true, 60'000 * kMsNs);
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 60'600 * kMsNs);
  EXPECT_EQ(tracking.state(60'600 * kMsNs), TrackingState::stale);

  Tracking streamed({.is_patient_tracked = true});
  streamed.update(LinkDevice::patient, LinkTransform::Identity(), true, 0);
  streamed.update(LinkDevice::tool, LinkTransform::Identity(), true, 1000 * kMsNs);
  EXPECT_EQ(streamed.state(1000 * kMsNs), TrackingState::stale);
}

TEST(Tracking, DrillsNothingWithAToolThatItsSenderDoesNotSee) {
  Tracking tracking({});
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 0);
  tracking.update(LinkDevice::tool, at(Vec3(500.0, 0.0, 0.0)), false, kMsNs);
  EXPECT_EQ(tracking.state(kMsNs), TrackingState::invalid);
  EXPECT_FALSE(tracking.pose(kMsNs));
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 2 * kMsNs);
  EXPECT_TRUE(tracking.pose(2 * kMsNs));
  tracking.invalidate(LinkDevice::tool, 3 * kMsNs);
  EXPECT_FALSE(tracking.pose(3 * kMsNs));
}

TEST(Tracking, WaitsForWhatItIsToldToWaitFor) {
  Tracking tracking({.needs_reference = true, .needs_patient = true});
  tracking.update(LinkDevice::tool, LinkTransform::Identity(), true, 0);
  EXPECT_EQ(tracking.state(0), TrackingState::waiting);
  tracking.update(LinkDevice::reference, LinkTransform::Identity(), true, 0);
  EXPECT_EQ(tracking.state(0), TrackingState::waiting);
  tracking.update(LinkDevice::patient, LinkTransform::Identity(), true, 0);
  EXPECT_EQ(tracking.state(0), TrackingState::ok);
}

}  // namespace
}  // namespace spinaltap
