#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <vector>

#include "core/base/error.h"
#include "core/session/device/coupled_operator.h"
#include "core/session/device/loopback_device.h"
#include "core/session/record/session_record.h"
#include "tests/support/coupled_hand.h"
#include "tests/support/drill_block.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

test::DrillBlock coupled_even_block(double hu = 700.0) {
  return test::DrillBlock([hu](double depth_mm) { return depth_mm > 0.0 ? hu : std::nan(""); });
}

SessionOptions options_with_device() {
  SessionOptions options;
  options.has_device = true;
  return options;
}

/// A hand that pushes with 4 N on a device of 1 ms delay, which shows a tenth of the bone's force.
LoopbackOptions pushing_loopback_hand() {
  LoopbackOptions options;
  options.limits.position_step_mm = 160.0 / 4096.0;
  options.pose_delay_s = 0.0005;
  options.force_delay_s = 0.0005;
  options.hand.stiffness_n_mm = 0.05;
  options.hand.damping_n_s_mm = 0.01;
  options.hand.push_mm = 100.0;
  options.hand.push_mm_s = 300.0;
  return options;
}

CoupledOptions weak_coupled_device() {
  CoupledOptions options;
  options.coupling.force_scale = 0.1;
  options.lead_in_mm = 1.0;
  return options;
}

struct CoupledRun {
  std::vector<ToolInput> inputs;
  std::vector<RecordedCycle> rows;
  std::size_t occupied = 0;
};

TEST(CoupledSession, IsFeltAsTheLawHasIt) {
  const test::DrillBlock plain = coupled_even_block();
  for (const double delay_s : {0.001, 0.005}) {
    test::DrillBlock block = coupled_even_block();
    LoopbackOptions options = pushing_loopback_hand();
    options.pose_delay_s = options.force_delay_s = 0.5 * delay_s;
    LoopbackDevice device(options);
    CoupledOptions coupled = weak_coupled_device();
    coupled.longest_s = 4.0;
    CoupledOperator hand(device, block.path, coupled);
    const auto session = block.session(options_with_device());
    double felt_n = 0.0, from_mm = 0.0, to_mm = 0.0, given_n_mm = 0.0;
    int count = 0;
    run_session(*session, hand, [&](const Cycle& cycle) {
      given_n_mm = std::max(given_n_mm, -device.energy_in_n_mm());
      if (cycle.time_s < 3.0 || cycle.time_s > 3.8) return;
      if (count++ == 0) from_mm = cycle.depth_mm;
      to_mm = cycle.depth_mm;
      felt_n -= device.acting_n().z();
    });
    ASSERT_GT(count, 500);
    felt_n /= count * coupled.coupling.force_scale;
    const double feed_mm_s = (to_mm - from_mm) / ((count - 1) * 1e-3);
    EXPECT_GT(feed_mm_s, 0.1);
    const Spindle spindle;
    const CuttingResistance law = resistance_of_block(block.path.bit, block.material, 700.0, spindle.rpm);
    const double law_n = law.thrust_n(feed_mm_s * 60.0 / spindle.rpm);
    EXPECT_NEAR(felt_n, law_n, 0.03 * law_n) << delay_s << " s, " << feed_mm_s << " mm/s";
    EXPECT_LT(given_n_mm, 1.0);
    EXPECT_GT(session->last().depth_mm, 3.0);
  }
}

TEST(CoupledSession, HandsOfAllKindsGetNoEnergy) {
  for (std::uint64_t seed = 20'000; seed < 20'012; ++seed) {
    const test::CoupledHand hand(seed);
    test::DrillBlock block = coupled_even_block(hand.hu);
    const auto session = block.session(options_with_device());
    LoopbackDevice device(hand.loopback);
    CoupledOptions coupled;
    coupled.coupling = hand.coupling;
    coupled.coupling.force_scale = 0.1;
    coupled.lead_in_mm = 1.5;
    coupled.longest_s = 2.0;
    CoupledOperator tool(device, block.path, coupled);
    double given_n_mm = 0.0;
    run_session(*session, tool, [&](const Cycle&) { given_n_mm = std::max(given_n_mm, -device.energy_in_n_mm()); });
    EXPECT_LT(given_n_mm, 1.0) << "seed " << seed;
    EXPECT_EQ(tool.end(), OperatorEnd::ran_out_of_time);
  }
}

CoupledRun run_coupled_block(test::DrillBlock& block, const LoopbackOptions& loopback, double seconds) {
  CoupledRun run;
  LoopbackDevice device(loopback);
  CoupledOptions coupled = weak_coupled_device();
  coupled.longest_s = seconds;
  CoupledOperator hand(device, block.path, coupled);
  const auto session = block.session(options_with_device());
  run_session(*session, hand, [&](const Cycle& cycle) {
    run.inputs.push_back(cycle.input);
    run.rows.push_back(recorded(cycle));
  });
  run.occupied = block.volumes.front().occupied_count();
  return run;
}

TEST(CoupledSession, ReplaysForcesPosesAndBoneBitForBit) {
  LoopbackOptions loopback = pushing_loopback_hand();
  loopback.lost_share = 0.05;
  loopback.hand.tremor_mm = 0.1;
  loopback.silent_from_s = 1.0;
  loopback.silent_to_s = 1.1;
  test::DrillBlock block = coupled_even_block(), again = coupled_even_block();
  const CoupledRun run = run_coupled_block(block, loopback, 2.5);
  // The record holds the device's side.
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "coupled.h5";
  const RecordParts parts = record_parts(block.path.bit, options_with_device());
  {
    test::DrillBlock third = coupled_even_block();
    RecordWriter writer(file, {}, false, {}, parts);
    const auto session = third.session(options_with_device());
    for (const ToolInput& input : run.inputs) writer.add_waiting(session->step(input));
    writer.close(session->events());
  }
  const SessionRecord record = read_record(file);
  ASSERT_EQ(record.cycles.size(), run.rows.size());
  EXPECT_TRUE(record.parts.has_device);
  // From the record: the session does the same, and from what the device said so does the coupling.
  const auto session = again.session(options_with_device());
  LoopbackDevice device(loopback);
  VirtualCoupling coupling(device.limits(), weak_coupled_device().coupling, {}, record.cycles.front().device.pose);
  bool was_lost = false;
  for (std::size_t n = 0; n < run.rows.size(); ++n) {
    const RecordedCycle& row = record.cycles[n];
    ASSERT_EQ(row, run.rows[n]) << n << ": " << difference(row, run.rows[n]);
    DeviceNews news;
    if (row.device.status == DeviceStatus::live) news.pose = row.device.pose;
    news.buttons = row.device.buttons;
    const ToolInput input = coupling.step(news, session->feedback(), row.dt_s);
    ASSERT_EQ(recorded(session->step(input)), row) << n;
    was_lost = was_lost || row.device.status == DeviceStatus::lost;
  }
  EXPECT_TRUE(was_lost);
  EXPECT_EQ(again.volumes.front().occupied_count(), run.occupied);
  EXPECT_LT(run.occupied, coupled_even_block().volumes.front().occupied_count());
}

TEST(CoupledSession, ToldThatItsDeviceWasLost) {
  LoopbackOptions loopback = pushing_loopback_hand();
  loopback.silent_from_s = 1.0;
  loopback.silent_to_s = 1.5;
  test::DrillBlock block = coupled_even_block();
  LoopbackDevice device(loopback);
  CoupledOptions coupled = weak_coupled_device();
  coupled.longest_s = 2.5;
  CoupledOperator hand(device, block.path, coupled);
  const auto session = block.session(options_with_device());
  std::uint64_t removed = 0;
  run_session(*session, hand, [&](const Cycle& cycle) {
    if (cycle.input.device.status == DeviceStatus::lost) removed += cycle.step.removed;
    if (cycle.time_s > 1.075 && cycle.time_s < 1.49) {
      EXPECT_EQ(cycle.input.device.force_n.norm(), 0.0);
    }
  });
  EXPECT_EQ(removed, 0U);
  const auto events = test::events_of(*session, EventKind::device_lost);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events.front().time_s, 1.02, 0.0025);
  EXPECT_NEAR(events.front().value, 0.5, 0.0025);
  EXPECT_EQ(hand.end(), OperatorEnd::ran_out_of_time);
}

TEST(CoupledSession, EndsWhereTheDeviceStaysAway) {
  LoopbackOptions loopback = pushing_loopback_hand();
  loopback.silent_from_s = 0.5;
  test::DrillBlock block = coupled_even_block();
  LoopbackDevice device(loopback);
  CoupledOptions coupled = weak_coupled_device();
  coupled.gives_up_s = 1.0;
  CoupledOperator hand(device, block.path, coupled);
  const auto session = block.session(options_with_device());
  run_session(*session, hand);
  EXPECT_EQ(hand.end(), OperatorEnd::device_lost);
  EXPECT_NEAR(session->last().time_s, 1.52, 0.01);
  loopback.silent_from_s = 0.0;
  LoopbackDevice dumb(loopback);
  CoupledOperator nobody(dumb, block.path, coupled);
  EXPECT_THROW(nobody.next({}), Error);
}

TEST(CoupledSession, HoldsNoToolUnlessAsked) {
  test::DrillBlock block = coupled_even_block();
  const auto plain = block.session();
  test::DrillBlock other = coupled_even_block();
  const auto coupled = other.session(options_with_device());
  for (int n = -50; n < 500; ++n) {
    const ToolInput input = block.input(0.01 * n);
    const DrillForce &of = plain->step(input).force, &with = coupled->step(input).force;
    ASSERT_EQ(of.thrust_n, with.thrust_n) << n;
    for (const double number : of.contact.stiffness) ASSERT_EQ(number, 0.0);
  }
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  const Mat6 hold(coupled->last().force.contact.stiffness.data());
  EXPECT_TRUE(hold.isApprox(hold.transpose(), 1e-12));
  const Eigen::SelfAdjointEigenSolver<Mat6> modes(hold);
  EXPECT_GT(modes.eigenvalues().minCoeff(), -1e-9 * modes.eigenvalues().maxCoeff());
  // A wall holds across the axis, and not along it.
  const Vec3 axis = block.path.direction();
  const Vec3 aside = any_perpendicular(axis);
  EXPECT_NEAR(axis.dot(hold.topLeftCorner<3, 3>() * axis), 0.0, 1e-6);
  const double stiff_n_mm = aside.dot(hold.topLeftCorner<3, 3>() * aside);
  EXPECT_GT(stiff_n_mm, 10.0);
  // A push aside is answered by that stiffness, less what is reamed within the cycle, and by its moment.
  const Vec3 push_mm = 0.005 * aside;
  const ToolInput pushed{block.at(4.99, push_mm), true, 0.001};
  const DrillForce& force = coupled->step(pushed).force;
  const double left = 1.0 / (1.0 + 1250.0 / 60.0 * 0.001);
  EXPECT_NEAR(-force.support_n.dot(aside), left * 0.005 * stiff_n_mm, 0.05 * 0.005 * stiff_n_mm);
  const Vec3 moment = -hold.bottomLeftCorner<3, 3>() * push_mm;
  EXPECT_NEAR((force.contact.moment_n_mm - left * moment).norm(), 0.0, 0.05 * moment.norm());
}

}  // namespace
}  // namespace spinaltap
