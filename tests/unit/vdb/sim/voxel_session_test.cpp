// Sessions that drill the voxels of a whole bone: their forces against the model's of an even block, their records
// against their replays.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/files/recorded_setup.h"
#include "core/session/cutting_motion.h"
#include "core/session/operator/path_motion.h"
#include "core/session/record/session_record.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/random_drilling.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/engine/living_voxels.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/session.h"
#include "vdb/sim/session_batch.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int16_t kEvenHu = 304;  // eight bits have it
const test::Ball kVoxelBall{Vec3(3.0, -4.0, 5.0), 9.0};

const Bone& voxel_ball() {
  static const Bone bone(test::bake_ball(kVoxelBall, 0.25, kEvenHu));
  return bone;
}

DrillPath path_through(const Vec3& direction, const DrillBit& bit = {3.1, 50.0, 3.0}) {
  const Vec3 axis = direction.normalized();
  const Vec3 entry_mm = kVoxelBall.centre_mm - kVoxelBall.radius_mm * axis;
  return {"through", entry_mm, entry_mm + 14.0 * axis, bit};
}

SessionSetup voxel_setup(const DrillPath& path) {
  SessionSetup setup;
  setup.path = path;
  setup.engine = EngineKind::voxel;
  setup.volume.spacing_mm = 0.1;
  setup.volume.lead_in_mm = 1.0;
  setup.has_clearances = false;
  return setup;
}

Drilling drill(const SessionSetup& setup, double step_mm = 0.02) {
  constexpr double kMmS = 1.0;
  PlannedMotion tool_operator(
      setup.path,
      {.line = {.lead_in_mm = setup.volume.lead_in_mm}, .rate_hz = kMmS / step_mm, .feed = {.steps = {{0.0, kMmS}}}});
  return drill_bone(voxel_ball(), setup, tool_operator, {.log_step_mm = 0.5});
}

/// Across the lattice, along it, and along its diagonals.
const std::vector<Vec3> kVoxelDirections{
    {0.2, -0.9, 0.3}, {0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {1.0, -1.0, 1.0}};

/// The section of the voxels that a hole takes, over its own: along the lattice's directions the same columns are in it
/// all the way, and their number is not quite the section's.
double section_of_voxels(const DrillPath& path, double voxel_mm) {
  const double from_mm = 4.505, to_mm = 9.505;
  const Vec3 middle_mm = path.entry_mm + 7.0 * path.direction();
  const Eigen::Vector3i low = ((middle_mm.array() - 4.0) / voxel_mm).floor().matrix().cast<int>();
  const int count = static_cast<int>(8.0 / voxel_mm) + 1;
  std::size_t inside = 0;
  for (int x = 0; x < count; ++x) {
    for (int y = 0; y < count; ++y) {
      for (int z = 0; z < count; ++z) {
        const Vec3 from_entry = voxel_mm * (low + Eigen::Vector3i(x, y, z)).cast<double>() - path.entry_mm;
        const double along_mm = from_entry.dot(path.direction());
        if (along_mm < from_mm || along_mm >= to_mm) continue;
        if ((from_entry - along_mm * path.direction()).norm() <= path.bit.radius_mm()) ++inside;
      }
    }
  }
  const double hole_mm3 = std::numbers::pi * path.bit.radius_mm() * path.bit.radius_mm() * (to_mm - from_mm);
  return static_cast<double>(inside) * voxel_mm * voxel_mm * voxel_mm / hole_mm3;
}

TEST(VoxelSessions, NeedTheThrustAndTorqueOfTheModelInEveryDirection) {
  const FeedResistance even = resistance_of_block(path_through({1, 0, 0}).bit, Material(), kEvenHu);
  const double feed_mm = 60.0 / Spindle().rpm;
  for (const Vec3& direction : kVoxelDirections) {
    SCOPED_TRACE(testing::Message() << direction.transpose());
    const SessionSetup setup = voxel_setup(path_through(direction));
    const double section = section_of_voxels(setup.path, setup.volume.spacing_mm);
    EXPECT_NEAR(section, 1.0, 0.03);
    FeedResistance expected = even;
    expected.lips_n *= section;
    expected.lips_n_mm *= section;
    double thrust_n = 0.0, torque_n_mm = 0.0;
    int rows = 0;
    const Drilling drilling = drill(setup);
    for (const DepthRow& row : drilling.rows) {
      if (row.depth_mm < 4.5 || row.depth_mm > 13.6) continue;  // the whole cone is in
      ++rows;
      thrust_n += row.thrust_n;
      torque_n_mm += row.torque_n_mm;
      EXPECT_NEAR(row.thrust_n, even.thrust_n(feed_mm), 0.05 * even.thrust_n(feed_mm)) << row.depth_mm;
      EXPECT_NEAR(row.hu, kEvenHu, 1e-9);
    }
    ASSERT_GT(rows, 15);
    EXPECT_NEAR(thrust_n / rows, expected.thrust_n(feed_mm), 0.01 * even.thrust_n(feed_mm));
    EXPECT_NEAR(torque_n_mm / rows, expected.torque_n_mm(feed_mm), 0.01 * even.torque_n_mm(feed_mm));
  }
}

TEST(VoxelSessions, RemoveTheVolumeOfTheHole) {
  const DrillPath path = path_through({0.2, -0.9, 0.3});
  const Drilling drilling = drill(voxel_setup(path));
  const double r = path.bit.radius_mm();
  const double cap_mm = kVoxelBall.radius_mm - std::sqrt(kVoxelBall.radius_mm * kVoxelBall.radius_mm - r * r);
  const double hole_mm3 =
      std::numbers::pi * r * r * (14.0 - path.bit.tip_length_mm * 2.0 / 3.0) - std::numbers::pi * r * r * cap_mm / 2.0;
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.removed), hole_mm3, 0.01 * hole_mm3);
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.points_in_bone), 4.0 / 3.0 * std::numbers::pi * std::pow(9.0, 3),
              0.005 * 4.0 / 3.0 * std::numbers::pi * std::pow(9.0, 3));
  ASSERT_TRUE(drilling.left.voxels);
  EXPECT_EQ(drilling.left.voxels->alive_count() + drilling.removed, drilling.points_in_bone);
  EXPECT_EQ(drilling.discs, 0);
  // The cone's tip holds a voxel's volume, and with luck a voxel, from 0.15 mm on.
  EXPECT_NEAR(drilling.entry_depth_mm, 0.15, 0.1);
  EXPECT_TRUE(std::ranges::any_of(drilling.events, [](const SessionEvent& event) {
    return event.kind == EventKind::contact && std::abs(event.depth_mm - 0.15) < 0.1;
  }));
}

TEST(VoxelSessions, ForcesOfABurrThatGoesSidewaysDoTheWorkOfWhatItCuts) {
  const Material material;
  VoxelBone bone(voxel_ball().model());
  const DrillBit burr{4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  const auto engine = make_voxel_engine(bone, burr, material);
  const auto living = make_living_bone(bone, material);
  DrillForces forces(*living, burr, material);
  const Spindle spindle{10'000.0, true};
  constexpr double kStepMm = 0.02, kStepS = 1e-3;
  double torque_work = 0.0, removed_mm3 = 0.0, removed_n_mm = 0.0;
  for (int n = 0; n < 900; ++n) {
    const Pose pose{kVoxelBall.centre_mm + Vec3(-9.0 - 3.0 + n * kStepMm, 0.0, -7.5), -Vec3::UnitZ()};
    const StepResult step = engine->step(pose);
    const DrillForce force = forces.update(step, pose, kStepS, spindle);
    ASSERT_TRUE(force.force_n.allFinite());
    removed_mm3 += step.removed_mm3;
    removed_n_mm += step.work_n_mm;
    const double turned = 2.0 * std::numbers::pi * spindle.rpm / 60.0 * kStepS;
    torque_work += force.torque_n_mm * turned;
  }
  ASSERT_GT(removed_mm3, 20.0);
  // Thin chips cost more: by the feed per turn to minus the exponent.
  const double feed_mm = kStepMm / kStepS / (spindle.rpm / 60.0);
  const double expected = removed_n_mm * std::pow(feed_mm / material.reference_feed_mm, -material.feed_exponent);
  EXPECT_NEAR(torque_work, expected, 0.02 * expected);
}

TEST(VoxelSessions, ABitAtRestInBoneIsPushedBackAsByPoints) {
  const DrillPath path = path_through({0.0, 0.0, 1.0});
  for (const double depth_mm : {1.0, 2.5}) {
    double contact_n[2];
    for (const EngineKind kind : {EngineKind::ring, EngineKind::voxel}) {
      SessionSetup setup = voxel_setup(path);
      setup.engine = kind;
      const BuiltSession built = build_session(voxel_ball(), setup);
      ToolInput input;
      input.pose = {path.entry_mm + depth_mm * path.direction(), path.direction()};
      input.spindle_on = false;
      contact_n[kind == EngineKind::voxel] = built.session->step(input).force.contact_n.norm();
    }
    EXPECT_GT(contact_n[0], 1.0);
    EXPECT_NEAR(contact_n[1], contact_n[0], 0.05 * contact_n[0]) << depth_mm;
  }
}

TEST(VoxelSessions, RecordsReplayBitForBitAndHolesBeforeAreGone) {
  SessionSetup setup = voxel_setup(path_through({0.2, -0.9, 0.3}));
  const DrillPath before = path_through({1.0, 0.1, 0.0});
  setup.holes.push_back(
      {before.bit, {{{before.entry_mm, before.direction()}, {before.target_mm, before.direction()}}}});
  setup.bone_hash = voxel_ball().hash();
  SessionRecord record;
  std::size_t removed = 0;
  {
    const BuiltSession built = build_session(voxel_ball(), setup);
    PlannedMotion tool_operator(setup.path,
                                {.line = {.lead_in_mm = 1.0}, .rate_hz = 200.0, .feed = {.steps = {{0.0, 2.0}}}});
    run_session(*built.session, tool_operator, [&](const Cycle& cycle) {
      record.cycles.push_back(recorded(cycle));
      removed += cycle.step.removed;
    });
    record.events.assign(built.session->events().begin(), built.session->events().end());
    record.is_whole = true;
  }
  ASSERT_GT(removed, 10'000U);
  EXPECT_LT(removed, drill(voxel_setup(setup.path)).removed) << "the holes cross";
  const BuiltSession again = build_session(voxel_ball(), setup);
  const Replay same = replay_record(*again.session, record);
  EXPECT_EQ(same.difference, "");
  EXPECT_EQ(same.cycles, record.cycles.size());
  SessionSetup by_points = setup;
  by_points.engine = EngineKind::ring;
  const BuiltSession other = build_session(voxel_ball(), by_points);
  EXPECT_NE(replay_record(*other.session, record).difference, "") << "points are not voxels";
}

TEST(VoxelSessions, ABatchBeginsAgainWithAllBone) {
  SessionSetup setup = voxel_setup(path_through({0.2, -0.9, 0.3}));
  SessionBatch batch({{voxel_ball(), setup.path}}, 2, setup);
  const auto run = [&](std::size_t n) {
    std::vector<double> thrust_n;
    PlannedMotion tool_operator(setup.path,
                                {.line = {.lead_in_mm = 1.0}, .rate_hz = 50.0, .feed = {.steps = {{0.0, 2.0}}}});
    run_session(batch.session(n), tool_operator, [&](const Cycle& cycle) { thrust_n.push_back(cycle.force.thrust_n); });
    return thrust_n;
  };
  const std::vector<double> first = run(0);
  EXPECT_EQ(run(1), first) << "each has voxels of its own";
  batch.reset(0);
  EXPECT_EQ(run(0), first);
}

TEST(VoxelSessions, RejectWhatOnlyPointsHave) {
  const auto rejects = [](const std::function<void(SessionSetup&)>& change, const char* words) {
    SessionSetup setup = voxel_setup(path_through({1.0, 0.0, 0.0}));
    change(setup);
    EXPECT_THAT([&] { build_session(voxel_ball(), setup); }, ThrowsMessage<Error>(HasSubstr(words)));
  };
  rejects([](SessionSetup& setup) { setup.volume.jitter = 0.2; }, "expected no jitter");
  rejects([](SessionSetup& setup) { setup.fine_spacing_mm = 0.05; }, "expected no finer spacing");
  rejects([](SessionSetup& setup) { setup.volume.subdivision = DiscSubdivision::hexagons; }, "expected no other");
  rejects([](SessionSetup& setup) { setup.volume.spacing_mm = 0.001; }, "expected a size");
}

/// A ball burr that goes 3 mm into the ball and then 4 mm aside, as what a session is fed.
std::vector<ToolInput> slot_of(const DrillPath& path, double aside_mm) {
  const Vec3 aside = any_perpendicular(path.direction());
  std::vector<ToolInput> inputs;
  const auto go_to = [&](const Vec3& tip_mm) { inputs.push_back({{tip_mm, path.direction()}, true, 1e-3}); };
  for (int n = 0; n <= 200; ++n) go_to(path.entry_mm + (0.02 * n - 1.0) * path.direction());
  const Vec3 deepest_mm = inputs.back().pose.tip_mm;
  for (int n = 1; n <= 200; ++n) go_to(deepest_mm + n * aside_mm / 200.0 * aside);
  return inputs;
}

SessionSetup slot_setup(std::optional<double> margin_mm) {
  const DrillBit burr{4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  DrillPath path = path_through({0.2, -0.9, 0.3}, burr);
  path.target_mm = path.entry_mm + 3.0 * path.direction();
  SessionSetup setup = voxel_setup(path);
  setup.bone_hash = voxel_ball().hash();
  if (margin_mm) setup.region_mm = region_around(path, setup.volume.lead_in_mm, *margin_mm);
  return setup;
}

SessionRecord record_of(const SessionSetup& setup, const std::vector<ToolInput>& inputs) {
  SessionRecord record;
  const BuiltSession built = build_session(voxel_ball(), setup);
  for (const ToolInput& input : inputs) record.cycles.push_back(recorded(built.session->step(input)));
  record.events.assign(built.session->events().begin(), built.session->events().end());
  record.is_whole = true;
  return record;
}

TEST(VoxelRegion, ThatHoldsAllOfTheToolsWayMakesNoDifference) {
  // The burr reaches 2 mm further aside than the 4 mm that it goes.
  const SessionSetup whole = slot_setup({}), part = slot_setup(6.5);
  const std::vector<ToolInput> inputs = slot_of(whole.path, 4.0);
  BuiltSession all = build_session(voxel_ball(), whole), again = build_session(voxel_ball(), part);
  EXPECT_GT(all.bone.alive_count(), again.bone.alive_count());
  std::size_t removed = 0;
  for (const ToolInput& input : inputs) {
    const Cycle &expected = all.session->step(input), &cycle = again.session->step(input);
    SCOPED_TRACE(cycle.index);
    removed += cycle.step.removed;
    ASSERT_EQ(cycle.step.removed, expected.step.removed);
    ASSERT_EQ(cycle.step.removed_hu, expected.step.removed_hu);
    ASSERT_EQ(cycle.state, expected.state);
    // Engines count places from the middle of what they have: the last digits may differ.
    ASSERT_NEAR((cycle.force.force_n - expected.force.force_n).norm(), 0.0, 1e-9);
    ASSERT_NEAR(cycle.force.torque_n_mm, expected.force.torque_n_mm, 1e-9);
  }
  EXPECT_GT(removed, 20'000U);
  ASSERT_EQ(again.session->events().size(), all.session->events().size());
  EXPECT_GT(again.session->events().size(), 1U);
  for (std::size_t n = 0; n < all.session->events().size(); ++n) {
    const SessionEvent &expected = all.session->events()[n], &event = again.session->events()[n];
    EXPECT_EQ(event.kind, expected.kind);
    EXPECT_EQ(event.cycle, expected.cycle);
    EXPECT_NEAR(event.value, expected.value, 1e-9);
  }
  // What is left within the region is the same as well, voxel by voxel.
  std::size_t within = 0;
  all.bone.voxels->for_each_alive([&](const Eigen::Vector3i& voxel) {
    if (!part.region_mm->contains(all.bone.voxels->centre_mm(voxel))) return;
    ++within;
    EXPECT_TRUE(again.bone.voxels->is_alive(voxel));
  });
  EXPECT_EQ(within, again.bone.voxels->alive_count());
}

TEST(VoxelRegion, SaysWhereTheToolLeavesIt) {
  const SessionSetup whole = slot_setup({}), part = slot_setup(3.0);
  const std::vector<ToolInput> inputs = slot_of(whole.path, 4.0);
  const auto leaves = [](const SessionRecord& record) {
    return std::ranges::count(record.events, EventKind::outside_volume, &SessionEvent::kind);
  };
  EXPECT_EQ(leaves(record_of(whole, inputs)), 0);
  const SessionRecord record = record_of(part, inputs);
  ASSERT_EQ(leaves(record), 1);
  const auto event = std::ranges::find(record.events, EventKind::outside_volume, &SessionEvent::kind);
  // The ball, of 2 mm, has the least room where it goes along the axis that it is nearest to: aside by 4 mm at most.
  double beyond_mm = 0.0;
  for (const ToolInput& input : inputs) {
    const Vec3 centre_mm = input.pose.tip_mm - 2.0 * input.pose.axis;
    const Vec3 below = part.region_mm->min() - (centre_mm - Vec3::Constant(2.0));
    const Vec3 above = centre_mm + Vec3::Constant(2.0) - part.region_mm->max();
    beyond_mm = std::max(beyond_mm, below.cwiseMax(above).maxCoeff());
  }
  EXPECT_GT(beyond_mm, 0.5);
  EXPECT_NEAR(event->value, beyond_mm, 1e-9);
  EXPECT_GT(event->cycle, 200U) << "on its way aside";
}

TEST(VoxelRegion, TakesMemoryByItsVolume) {
  const DrillPath path = path_through({0.2, -0.9, 0.3});
  SessionSetup setup = voxel_setup(path);
  const std::size_t whole_bytes = DrilledBone(voxel_ball().model(), setup).memory_bytes();
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kVoxelBall.radius_mm, 3);
  // Cubes within the ball. Leaves of 0.8 mm that they cut are there as a whole.
  for (const double half_mm : {1.6, 2.4, 4.0}) {
    setup.region_mm =
        Box3(kVoxelBall.centre_mm - Vec3::Constant(half_mm), kVoxelBall.centre_mm + Vec3::Constant(half_mm));
    const DrilledBone part(voxel_ball().model(), setup);
    EXPECT_NEAR(1e-3 * static_cast<double>(part.alive_count()), std::pow(2.0 * half_mm, 3),
                0.07 * std::pow(2.0 * half_mm, 3));
    const double share = static_cast<double>(part.memory_bytes()) / static_cast<double>(whole_bytes);
    EXPECT_LT(share, 1.1 * std::pow(2.0 * (half_mm + 0.8), 3) / ball_mm3) << half_mm;
  }
}

TEST(VoxelRegion, IsKeptInRecordsThatReplayBitForBit) {
  SessionSetup setup = slot_setup(3.0);
  setup.engine = EngineKind::automatic;
  const std::vector<ToolInput> inputs = slot_of(setup.path, 4.0);
  SessionRecord record = record_of(setup, inputs);
  record.setup = record_setup(setup);
  const Replay same = replay(record, "run.h5", voxel_ball());
  EXPECT_EQ(same.difference, "");
  EXPECT_EQ(same.cycles, inputs.size());
  EXPECT_EQ(same.events, record.events.size());
  EXPECT_TRUE(replay(record, "run.h5", voxel_ball(), EngineKind::automatic).is_same());
  EXPECT_THAT([&] { replay(record, "run.h5", voxel_ball(), EngineKind::leaf); },
              ThrowsMessage<Error>(HasSubstr("expected the engine voxel, found leaf")));
}

TEST(VoxelRegion, IsRejectedWhereItMakesNoSense) {
  const auto rejects = [](const std::function<void(SessionSetup&)>& change, const char* words) {
    SessionSetup setup = slot_setup(6.0);
    change(setup);
    EXPECT_THAT([&] { build_session(voxel_ball(), setup); }, ThrowsMessage<Error>(HasSubstr(words)));
  };
  rejects([](SessionSetup& setup) { setup.engine = EngineKind::ring; }, "expected the engine voxel, found ring");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(); }, "second corner");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(Vec3::Ones(), Vec3::Zero()); }, "second corner");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(Vec3::Constant(90.0), Vec3::Constant(91.0)); },
          "a region with bone in it");
  // Around the entry alone, 3 mm before the target.
  rejects(
      [](SessionSetup& setup) {
        setup.region_mm = Box3(setup.path.entry_mm - Vec3::Constant(2.0), setup.path.entry_mm + Vec3::Constant(2.0));
      },
      "within the region of the voxels");
}

TEST(VoxelSessions, OnlyARegionHasAnEnd) {
  const VoxelBone whole(voxel_ball().model(), {.voxel_mm = 0.3});
  const Box3 box_mm(kVoxelBall.centre_mm - Vec3::Constant(4.0), kVoxelBall.centre_mm + Vec3::Constant(4.0));
  const VoxelBone part(voxel_ball().model(), {.voxel_mm = 0.3, .region_mm = box_mm});
  const auto all = make_living_bone(whole, {});
  const auto some = make_living_bone(part, {});
  const BitProfile bit({2.0, 20.0, 2.0});
  const Vec3& middle_mm = kVoxelBall.centre_mm;
  const Pose pose{middle_mm + Vec3(0.0, 3.5, 0.0), Vec3::UnitZ()};
  EXPECT_EQ(all->past_end_mm(Vec3::Constant(1e5)), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(all->beyond_side_mm(bit, pose, middle_mm), -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(some->past_end_mm(middle_mm + Vec3(0.0, 0.0, 5.5)), 1.5, 1e-12);
  EXPECT_NEAR(some->past_end_mm(middle_mm), -4.0, 1e-12);
  // Only its tip has come deeper than the first contact; then all of a cone of 2 mm, which is 1 mm wide, and its shaft.
  EXPECT_NEAR(some->beyond_side_mm(bit, pose, pose.tip_mm), -0.5, 1e-12);
  EXPECT_NEAR(some->beyond_side_mm(bit, pose, pose.tip_mm - Vec3(0.0, 0.0, 2.0)), 0.5, 1e-12);
  EXPECT_NO_THROW(all->check_within(path_through({1.0, 0.0, 0.0})));
  EXPECT_THAT(
      [&] {
        some->check_within(path_through({1.0, 0.0, 0.0}));
      },
      ThrowsMessage<Error>(HasSubstr("within the region")));
}

/// The slot of a hand that trembles and tilts.
std::vector<ToolInput> trembling_slot(const DrillPath& path, double aside_mm, std::uint64_t seed) {
  std::vector<ToolInput> inputs = slot_of(path, aside_mm);
  test::Random random(seed);
  Vec3 off_mm = Vec3::Zero();
  for (ToolInput& input : inputs) {
    off_mm = 0.9 * off_mm + 0.03 * random.direction();
    input.pose.tip_mm += off_mm;
    input.pose.axis = (input.pose.axis + 0.05 * off_mm).normalized();
  }
  return inputs;
}

std::vector<std::uint64_t> living_words(const Session& session) {
  std::vector<std::uint64_t> words;
  session.voxels()->get_living_words(words);
  return words;
}

/// Cycles and events of a hole, the voxels that it leaves, its display and the drilled bone: the same to the last bit.
struct VoxelHole {
  std::vector<RecordedCycle> rows;
  std::vector<std::size_t> event_cycles;
  std::vector<std::uint64_t> living;
  std::map<std::array<int, 3>, SurfaceBlock> shown;
  std::string drilled;
  bool operator==(const VoxelHole&) const = default;
};
VoxelHole run_hole(Session& session, const std::vector<ToolInput>& inputs,
                   std::map<std::array<int, 3>, SurfaceBlock>& shown) {
  VoxelHole hole;
  hole.rows = session.run(inputs);
  for (const SessionEvent& event : session.events()) hole.event_cycles.push_back(event.cycle);
  hole.living = living_words(session);
  for (const SurfaceUpdate& update : session.surface_changes()) {
    shown.erase(update.block);
    if (update.surface) shown.emplace(update.block, *update.surface);
  }
  hole.shown = shown;
  hole.drilled = session.drilled().hash();
  return hole;
}

SLOW_TESTS("VoxelUndo.LeavesNoTraceOfWhatWasTakenBack");

TEST(VoxelUndo, LeavesNoTraceOfWhatWasTakenBack) {
  for (const bool has_region : {false, true}) {
    SCOPED_TRACE(has_region);
    SessionSetup setup = slot_setup(has_region ? std::optional(5.0) : std::nullopt);
    setup.engine = has_region ? EngineKind::automatic : EngineKind::voxel;
    setup.has_clearances = !has_region;
    const std::vector<ToolInput> taken_back = trembling_slot(setup.path, 4.0, 1),
                                 first = trembling_slot(setup.path, 2.0, 2),
                                 second = trembling_slot(setup.path, -3.0, 3);
    std::map<std::array<int, 3>, SurfaceBlock> shown, shown_again;
    Session plain(voxel_ball(), setup.path, setup), undone(voxel_ball(), setup.path, setup);
    const VoxelHole one = run_hole(plain, first, shown);
    const std::vector<std::uint64_t> whole = living_words(undone);
    EXPECT_NE(one.living, whole);

    // What was drilled so far.
    run_hole(undone, taken_back, shown_again);
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(living_words(undone), whole);
    EXPECT_TRUE(run_hole(undone, first, shown_again) == one);
    // A hole that is done, and half of one behind it.
    plain.end_hole();
    undone.end_hole();
    EXPECT_EQ(living_words(undone), one.living);
    run_hole(undone, taken_back, shown_again);
    undone.end_hole();
    run_hole(undone, second, shown_again);
    EXPECT_TRUE(undone.undo());
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(living_words(undone), one.living);
    EXPECT_EQ(undone.setup().holes.size(), 1U);
    const VoxelHole two = run_hole(plain, second, shown);
    EXPECT_TRUE(run_hole(undone, second, shown_again) == two);
    EXPECT_NE(two.rows.back(), one.rows.back());
    // All of it.
    EXPECT_TRUE(undone.undo());
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(living_words(undone), whole);
    EXPECT_FALSE(undone.undo());
    EXPECT_EQ(undone.drilled().hash(), voxel_ball().hash());
  }
}

TEST(VoxelUndo, TakesBackHolesThatWereThereWhenTheSessionBegan) {
  const SessionSetup setup = slot_setup({});
  SessionSetup with_hole = setup;
  with_hole.holes = {hole_of(trembling_slot(setup.path, 4.0, 1), setup)};
  Session plain(voxel_ball(), setup.path, setup), begun(voxel_ball(), setup.path, with_hole);
  EXPECT_NE(living_words(begun), living_words(plain));
  begun.run(trembling_slot(setup.path, -3.0, 2));
  begun.end_hole();
  EXPECT_TRUE(begun.undo());
  EXPECT_TRUE(begun.undo());
  EXPECT_EQ(living_words(begun), living_words(plain));
  EXPECT_FALSE(begun.undo());
  const std::vector<ToolInput> inputs = trembling_slot(setup.path, 2.0, 3);
  EXPECT_EQ(begun.run(inputs), plain.run(inputs));
}

TEST(VoxelUndo, RecordsOfHolesBehindOthersReplayBitForBit) {
  const test::TemporaryFolder folder;
  const SessionSetup setup = slot_setup({});
  Session session(voxel_ball(), setup.path, setup);
  session.run(trembling_slot(setup.path, 4.0, 1));
  session.end_hole();
  session.run(trembling_slot(setup.path, 2.0, 2));
  session.undo();
  session.record(folder.path() / "second.h5");
  session.run(trembling_slot(setup.path, -3.0, 3));
  session.end_record();
  const Replay again = replay(folder.path() / "second.h5", voxel_ball());
  EXPECT_TRUE(again.is_same()) << again.difference;
  EXPECT_EQ(again.cycles, 401U);
}

TEST(VoxelUndo, AHoleThatLeavesNoBoneIsNotEnded) {
  const test::Ball small{kVoxelBall.centre_mm, 1.5};
  const Bone bone(test::bake_ball(small, 0.25, kEvenHu));
  SessionSetup setup = voxel_setup(path_through({0.0, 0.0, 1.0}, {6.0, 50.0, 1.0}));
  Session session(bone, setup.path, setup);
  std::vector<ToolInput> inputs;
  for (int n = 0; n <= 160; ++n) {
    inputs.push_back({{setup.path.entry_mm + 0.1 * n * setup.path.direction(), setup.path.direction()}, true, 1e-3});
  }
  const std::vector<RecordedCycle> rows = session.run(inputs);
  EXPECT_EQ(session.voxels()->alive_count(), 0U);
  EXPECT_THAT([&] { session.end_hole(); }, ThrowsMessage<Error>(HasSubstr("all is drilled away")));
  EXPECT_EQ(session.last().index, 160U);
  EXPECT_EQ(session.voxels()->alive_count(), 0U);
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.run(inputs), rows);
}

/// Two balls of bone, one behind the other with 1.5 mm of air between, of different density.
const test::Ball kNearBall{Vec3(3.0, -4.0, 5.0), 5.0};
const test::Ball kFarBall{Vec3(3.0, -4.0, 16.5), 5.0};
constexpr std::int16_t kNearHu = 304, kFarHu = 1104;  // eight bits have them

const std::vector<Bone>& near_and_far() {
  static const std::vector<Bone> bones{Bone(test::bake_ball(kNearBall, 0.25, kNearHu)),
                                       Bone(test::bake_ball(kFarBall, 0.25, kFarHu))};
  return bones;
}

/// Through the middle of both, until all of a cone of 3 mm is in the open behind the second.
SessionSetup through_both(const DrillBit& bit = {3.1, 50.0, 3.0}) {
  const Vec3 entry_mm = kNearBall.centre_mm - 5.0 * Vec3::UnitZ();
  return voxel_setup({"both", entry_mm, entry_mm + 25.0 * Vec3::UnitZ(), bit});
}

Drilling drill_both(SessionSetup setup) {
  name_bones(setup, near_and_far());
  PlannedMotion tool_operator(setup.path,
                              {.line = {.lead_in_mm = 1.0}, .rate_hz = 50.0, .feed = {.steps = {{0.0, 1.0}}}});
  return drill_bone(near_and_far(), setup, tool_operator, {.log_step_mm = 0.5});
}

/// Of a cylinder along a ball's diameter.
double through_ball_mm3(const test::Ball& ball, double radius_mm) {
  const double rest = ball.radius_mm * ball.radius_mm - radius_mm * radius_mm;
  return 4.0 / 3.0 * std::numbers::pi * (std::pow(ball.radius_mm, 3) - std::pow(rest, 1.5));
}

TEST(SeveralBones, AreDrilledThroughWithTheThrustOfEach) {
  const SessionSetup setup = through_both();
  const Drilling drilling = drill_both(setup);
  const double hole_mm3 = through_ball_mm3(kNearBall, 1.55) + through_ball_mm3(kFarBall, 1.55);
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.removed), hole_mm3,
              (0.005 + std::abs(section_of_voxels(setup.path, 0.1) - 1.0)) * hole_mm3);
  const double feed_mm = 60.0 / Spindle().rpm;
  const auto mean_n = [&](double from_mm, double to_mm) {
    double sum_n = 0.0;
    int rows = 0;
    for (const DepthRow& row : drilling.rows) {
      if (row.depth_mm < from_mm || row.depth_mm > to_mm) continue;
      sum_n += row.thrust_n;
      ++rows;
    }
    return sum_n / rows;
  };
  // Where the whole cone is in one of them: 3 mm past where it meets the ball, before it comes out.
  const double near_n = resistance_of_block(setup.path.bit, Material(), kNearHu).thrust_n(feed_mm);
  const double far_n = resistance_of_block(setup.path.bit, Material(), kFarHu).thrust_n(feed_mm);
  EXPECT_GT(far_n, 1.5 * near_n);
  EXPECT_NEAR(mean_n(4.0, 9.0), near_n, 0.04 * near_n);
  EXPECT_NEAR(mean_n(15.5, 20.5), far_n, 0.04 * far_n);
  // Each is written with its own hole: what is left of it is its ball without the cylinder.
  ASSERT_EQ(drilling.further_drilled.size(), 1U);
  const auto hole_of = [](const BoneModel& drilled, const test::Ball& ball) {
    return ball.volume_mm3() - 1e-3 * static_cast<double>(VoxelBone(drilled).alive_count());
  };
  for (const auto& [drilled, ball] :
       {std::pair{&drilling.drilled, &kNearBall}, std::pair{&drilling.further_drilled[0], &kFarBall}}) {
    EXPECT_NEAR(hole_of(*drilled, *ball), through_ball_mm3(*ball, 1.55), 0.04 * through_ball_mm3(*ball, 1.55));
  }
}

TEST(SeveralBones, HaveClearancesToTheWallsOfAllTogether) {
  SessionSetup setup = through_both({2.0, 50.0, 2.0});
  setup.has_clearances = true;
  setup.path.target_mm = setup.path.entry_mm + 18.0 * Vec3::UnitZ();
  name_bones(setup, near_and_far());
  const BuiltSession both = build_session(near_and_far(), setup);
  // The outline's place that is least deep in the two balls, of those past the entry opening.
  const auto expected_mm = [&](double depth_mm) {
    double min_mm = std::numeric_limits<double>::infinity();
    for (double back_mm = 0.0; depth_mm - back_mm > both.clearances->entry_end_mm(); back_mm += 0.01) {
      const Vec3 place = setup.path.entry_mm + Vec3(std::min(1.0, 0.5 * back_mm), 0.0, depth_mm - back_mm);
      double in_mm = -std::numeric_limits<double>::infinity();
      for (const test::Ball& ball : {kNearBall, kFarBall}) {
        in_mm = std::max(in_mm, ball.radius_mm - (place - ball.centre_mm).norm());
      }
      min_mm = std::min(min_mm, in_mm);
    }
    return min_mm;
  };
  // Half way between the balls distances have an edge, which a lattice of 0.4 mm rounds off by half of that; distances
  // themselves are right to 0.03 mm.
  for (const double depth_mm : {3.0, 7.0, 9.5, 10.4, 10.75, 11.2, 13.0, 16.5, 18.0}) {
    ToolInput input;
    input.pose = {setup.path.entry_mm + depth_mm * Vec3::UnitZ(), Vec3::UnitZ()};
    EXPECT_NEAR(both.session->step(input).clearance.outer_mm, expected_mm(depth_mm), 0.23) << depth_mm;
  }
  EXPECT_NEAR(expected_mm(16.5), -(std::hypot(5.75, 1.0) - 5.0), 0.01) << "the shaft in the middle of the gap";
  // The first alone says how far the tip is from it.
  SessionSetup alone = setup;
  name_bones(alone, std::span(near_and_far()).first(1));
  const BuiltSession first = build_session(near_and_far()[0], alone);
  EXPECT_LT(
      first.clearances->of(BitProfile(setup.path.bit), {setup.path.entry_mm + 16.5 * Vec3::UnitZ(), Vec3::UnitZ()})
          .outer_mm,
      -6.0);
}

TEST(SeveralBones, ComeBackWithUndoAndReplayBitForBit) {
  const test::TemporaryFolder folder;
  const SessionSetup setup = through_both({4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0});
  std::vector<ToolInput> inputs;
  test::Random random(5);
  for (int n = 0; n <= 400; ++n) {
    const Vec3 off_mm = 0.1 * random.direction();
    inputs.push_back({{setup.path.entry_mm + (0.06 * n - 1.0) * Vec3::UnitZ() + off_mm, Vec3::UnitZ()}, true, 1e-3});
  }
  Session session(near_and_far(), setup.path, setup);
  EXPECT_EQ(session.setup().further_bone_hashes, std::vector{near_and_far()[1].hash()});
  const std::vector<std::uint64_t> whole = living_words(session);
  const std::size_t blocks[2] = {session.surface_changes(0).size(), session.surface_changes(1).size()};
  session.run(inputs);
  EXPECT_GT(session.surface_changes(0).size(), 0U);
  const std::size_t changed = session.surface_changes(1).size();
  EXPECT_GT(changed, 0U);
  EXPECT_LT(changed, blocks[1]);
  EXPECT_GT(blocks[0], 0U);
  EXPECT_THAT([&] { session.surface_changes(2); }, ThrowsMessage<Error>(HasSubstr("a bone below 2")));
  std::vector<Bone> drilled = session.drilled_bones();
  ASSERT_EQ(drilled.size(), 2U);
  EXPECT_EQ(drilled[0].hash(), session.drilled().hash());
  for (std::size_t n = 0; n < 2; ++n) EXPECT_NE(drilled[n].hash(), near_and_far()[n].hash());
  // From the side, both balls are seen, the one above the other, and the shaft between.
  const Vec3 middle_mm = 0.5 * (kNearBall.centre_mm + kFarBall.centre_mm);
  const Camera camera = look_at(middle_mm - 60.0 * Vec3::UnitX(), middle_mm, Vec3::UnitZ(), 0.5, 61, 61);
  const View view = session.view(camera);
  const auto seen = [&](double up_mm) {
    const int row = 30 - static_cast<int>(std::lround(up_mm * camera.fy / 60.0));
    return static_cast<Seen>(view.mask[view.pixel(30, row)]);
  };
  EXPECT_EQ(seen(5.75), Seen::bone);
  EXPECT_EQ(seen(-5.75), Seen::bone);
  EXPECT_EQ(seen(0.0), Seen::bit);

  EXPECT_TRUE(session.undo());
  EXPECT_EQ(living_words(session), whole);
  drilled = session.drilled_bones();
  for (std::size_t n = 0; n < 2; ++n) EXPECT_EQ(drilled[n].hash(), near_and_far()[n].hash());
  session.record(folder.path() / "both.h5");
  session.run(inputs);
  session.end_record();
  const SessionRecord record = read_record(folder.path() / "both.h5");
  EXPECT_TRUE(replay(record, "both.h5", near_and_far()).is_same());
  EXPECT_THAT([&] { replay(record, "both.h5", near_and_far()[0]); },
              ThrowsMessage<Error>(HasSubstr("expected the 2 bones")));
  const std::vector<Bone> swapped{near_and_far()[1], near_and_far()[0]};
  EXPECT_THAT([&] { replay(record, "both.h5", swapped); }, ThrowsMessage<Error>(HasSubstr("another patient's")));
}

TEST(SeveralBones, NeedVoxels) {
  SessionSetup setup = through_both();
  setup.engine = EngineKind::automatic;
  EXPECT_EQ(Session(near_and_far(), setup.path, setup).setup().engine, EngineKind::voxel);
  EXPECT_EQ(Session(near_and_far()[0], setup.path, setup).setup().engine, EngineKind::ring);
  for (const EngineKind engine : {EngineKind::ring, EngineKind::leaf}) {
    setup.engine = engine;
    EXPECT_THAT([&] { Session(near_and_far(), setup.path, setup); },
                ThrowsMessage<Error>(HasSubstr("several bones: expected the engine voxel")));
  }
  setup.engine = EngineKind::voxel;
  EXPECT_THAT([&] { Session(std::vector<Bone>(), setup.path, setup); }, ThrowsMessage<Error>(HasSubstr("a bone")));
  EXPECT_THAT([&] { Session(std::vector(2, near_and_far()[0]), setup.path, setup); },
              ThrowsMessage<Error>(HasSubstr("one twice")));
  EXPECT_THAT([&] { build_session(near_and_far(), setup); }, ThrowsMessage<Error>(HasSubstr("expected 1 bones")));
}

}  // namespace
}  // namespace spinaltap
