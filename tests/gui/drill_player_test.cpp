#include "apps/spinaltap-planner/drill/drill_player.h"

#include <gmock/gmock.h>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "apps/spinaltap-planner/drill/played_hole.h"
#include "core/files/recorded_setup.h"
#include "core/session/choose_engine.h"
#include "core/session/record/session_record.h"
#include "tests/gui/phantom_bone.h"
#include "tests/support/temporary_folder.h"
#include "vdb/grid/bone_field.h"
#include "vdb/remaining/remaining_surface.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/recorded_hole.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using State = DrillPlayer::State;
using ::testing::HasSubstr;

constexpr double kAsFastAsItGoes = 0.0;

/// A player of the phantom's left path, which keeps what it is told.
class DrillPlayerTest : public ::testing::Test {
 protected:
  DrillPlayerTest() {
    document_.set_bone(test::phantom_bone());
    document_.set_paths(test::phantom_paths());
    make_player();
  }

  void make_player() {
    player_ = std::make_unique<DrillPlayer>(document_);
    QObject::connect(player_.get(), &DrillPlayer::failed, player_.get(),
                     [this](const QString& why) { trouble_ = why.toStdString(); });
    QObject::connect(player_.get(), &DrillPlayer::progressed, player_.get(), [this] { ++told_; });
    QObject::connect(player_.get(), &DrillPlayer::surface_changed, player_.get(),
                     [this](const std::vector<SurfaceUpdate>& updates) {
                       for (const SurfaceUpdate& update : updates) blocks_[update.block] = update.surface;
                     });
    blocks_.clear();
    for (const SurfaceUpdate& update : test::phantom_bone()->surface) blocks_[update.block] = update.surface;
  }

#if defined(SPINALTAP_THREAD_SANITIZER)
  static constexpr qint64 kLongestMs = 300'000;  // each takes ten times as long and more
#else
  static constexpr qint64 kLongestMs = 30'000;
#endif
  /// Until a condition holds; false after the longest.
  template <class Condition>
  static bool wait_until(const Condition& condition) {
    QElapsedTimer clock;
    clock.start();
    while (!condition()) {
      if (clock.elapsed() > kLongestMs) return false;
      QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
    }
    return true;
  }
  bool wait_for(State state) {
    return wait_until([&] { return player_->state() == state; });
  }
  void drill_through(const DrillPlan& plan) {
    player_->start(plan);
    ASSERT_EQ(player_->state(), State::preparing) << trouble_;
    ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
  }

  /// The blocks that show surface, by what they hold.
  std::map<std::array<int, 3>, SurfaceBlock> surface() const {
    std::map<std::array<int, 3>, SurfaceBlock> blocks;
    for (const auto& [place, block] : blocks_) {
      if (block) blocks.emplace(place, *block);
    }
    return blocks;
  }

  PlanDocument document_;
  std::unique_ptr<DrillPlayer> player_;
  std::string trouble_;
  int told_ = 0;
  std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>> blocks_;
};

void expect_same_rows(const std::vector<DepthRow>& a, const std::vector<DepthRow>& b) {
  ASSERT_EQ(a.size(), b.size());
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].depth_mm, b[n].depth_mm) << n;
    EXPECT_EQ(a[n].cycles, b[n].cycles) << n;
    EXPECT_EQ(a[n].removed, b[n].removed) << n;
    EXPECT_TRUE(same(a[n].hu, b[n].hu)) << n;
    EXPECT_EQ(a[n].thrust_n, b[n].thrust_n) << n;
    EXPECT_EQ(a[n].torque_n_mm, b[n].torque_n_mm) << n;
    EXPECT_EQ(a[n].lateral_n, b[n].lateral_n) << n;
    EXPECT_EQ(a[n].state, b[n].state) << n;
    EXPECT_EQ(a[n].outer_mm, b[n].outer_mm) << n;
    EXPECT_EQ(a[n].canal_mm, b[n].canal_mm) << n;
  }
}

Drilling drilled_in_one_go(const DrillPath& path, const DrillPlan& plan) {
  const SessionSetup setup = session_setup(path, plan);
  const OperatorPlan tool_operator =
      operator_choice(plan).plan(path, setup.volume.lead_in_mm, setup.options.spindle, false);
  return drill_bone(*test::phantom_bone()->bone, setup, *tool_operator.tool_operator);
}

TEST_F(DrillPlayerTest, DrillsToTheTargetWhatDrillBoneDrills) {
  for (const char* tool_operator : {"tremor", "push"}) {
    const DrillPlan plan{.tool_operator = tool_operator, .push_n = 200.0, .speed = kAsFastAsItGoes};
    drill_through(plan);
    const DrillPath path = test::phantom_paths().front();
    const Drilling ground_truth = drilled_in_one_go(path, plan);
    EXPECT_GT(ground_truth.removed, 10'000U);
    EXPECT_EQ(player_->removed(), ground_truth.removed) << tool_operator;
    expect_same_rows(player_->rows(), ground_truth.rows);
    EXPECT_EQ(player_->events().size(), ground_truth.events.size());
    // Of a strong push cancellous bone takes so little that the operator lets go as if it were through.
    if (plan.tool_operator != "push") {
      EXPECT_NEAR(player_->last()->depth_mm, path.length_mm(), 0.2) << tool_operator;
    }
    EXPECT_TRUE(player_->is_over());
    EXPECT_FALSE(player_->can_go_on());
    EXPECT_GT(player_->cycles_per_s(), 1000.0);
    player_->undo_hole();
    EXPECT_EQ(trouble_, "");
  }
}

TEST_F(DrillPlayerTest, GoesOnAfterAStepBackAsIfNothingHadBeen) {
  struct Case {
    DrillPlan plan;
    double stop_s, back_s;
  };
  // What the operator that pushes does next follows from what it felt before.
  const Case cases[] = {{{.tool_operator = "tremor", .speed = 4.0}, 5.0, 1.0},
                        {{.tool_operator = "push", .push_n = 200.0, .speed = 0.5}, 0.9, 0.2}};
  for (const auto& [plan, stop_s, back_s] : cases) {
    const Drilling ground_truth = drilled_in_one_go(test::phantom_paths().front(), plan);
    player_->start(plan);
    ASSERT_TRUE(wait_until([&, at_s = stop_s] { return player_->seconds() > at_s; })) << plan.tool_operator << trouble_;
    player_->stop();
    ASSERT_EQ(player_->state(), State::stopped);
    ASSERT_TRUE(player_->can_go_on());
    const double stopped_s = player_->seconds();
    const std::size_t removed = player_->removed();
    EXPECT_GT(removed, 0U);
    EXPECT_LT(removed, ground_truth.removed);
    player_->step_back(back_s);
    ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
    EXPECT_NEAR(player_->seconds(), stopped_s - back_s, 1e-9);
    EXPECT_LE(player_->removed(), removed);
    player_->set_speed(kAsFastAsItGoes);
    player_->go_on();
    ASSERT_TRUE(wait_for(State::stopped));
    EXPECT_EQ(player_->removed(), ground_truth.removed);
    expect_same_rows(player_->rows(), ground_truth.rows);
    EXPECT_EQ(trouble_, "");
    player_->undo_hole();
  }
}

TEST_F(DrillPlayerTest, StepBackBringsBackTheSurfaceOfThatMoment) {
  const DrillPlan plan{.tool_operator = "tremor", .feed_mm_s = 4.0, .speed = 4.0};
  player_->start(plan);
  ASSERT_TRUE(wait_until([&] { return player_->seconds() > 3.0; })) << trouble_;
  player_->stop();
  player_->step_back(1.0);
  ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
  // A mesh of its own, drilled with the inputs until then.
  const std::vector<ToolInput> inputs = player_->done()->inputs;
  RemainingBone bone(test::phantom_bone()->model(), {.voxel_mm = kSurfaceVoxelMm});
  RemainingSurface ground_truth(bone);
  std::vector<Pose> poses;
  for (const ToolInput& input : inputs) poses.push_back(input.pose);
  bone.drill(player_->path()->bit, poses);
  ground_truth.update();
  std::map<std::array<int, 3>, SurfaceBlock> blocks;
  for (const auto& block : ground_truth.blocks()) blocks.emplace(block->block, *block);
  EXPECT_EQ(surface(), blocks);
}

TEST_F(DrillPlayerTest, UndoBringsBackTheOpenedSurfaceAndRedoTheHole) {
  const auto opened = surface();
  drill_through({.speed = kAsFastAsItGoes});
  const auto one_hole = surface();
  EXPECT_NE(one_hole, opened);
  const std::size_t removed = player_->removed();
  document_.choose(1);
  drill_through({.tool_operator = "tremor", .speed = kAsFastAsItGoes});
  const auto two_holes = surface();
  EXPECT_NE(two_holes, one_hole);
  player_->undo_hole();
  EXPECT_EQ(surface(), one_hole);
  EXPECT_EQ(player_->removed(), removed);  // of the hole that is the last now
  EXPECT_EQ(player_->path()->name, "left");
  player_->undo_hole();
  EXPECT_EQ(surface(), opened);
  EXPECT_EQ(player_->state(), State::idle);
  EXPECT_FALSE(player_->can_undo_hole());
  player_->redo_hole();
  EXPECT_EQ(surface(), one_hole);
  player_->redo_hole();
  EXPECT_EQ(surface(), two_holes);
  EXPECT_FALSE(player_->can_redo_hole());
  player_->reset();
  EXPECT_EQ(surface(), opened);
}

TEST_F(DrillPlayerTest, FeelsTheHolesThatWereDrilledBefore) {
  drill_through({.feed_mm_s = 2.0, .speed = kAsFastAsItGoes});
  const std::size_t removed = player_->removed();
  // The same path a little further: only what lies beyond is left to drill.
  DrillPath longer = test::phantom_paths().front();
  longer.target_mm += 2.0 * longer.direction();
  document_.change_path(0, longer, "longer");
  drill_through({.feed_mm_s = 2.0, .speed = kAsFastAsItGoes});
  EXPECT_GT(player_->removed(), 0U);
  EXPECT_LT(player_->removed(), removed / 5);
  // A record of it holds the earlier hole.
  const test::TemporaryFolder folder;
  write_record(*player_->done(), folder.path() / "second.h5");
  const SessionRecord record = read_record(folder.path() / "second.h5");
  const SessionSetup setup = recorded_setup(record.setup, "second.h5");
  ASSERT_EQ(setup.holes.size(), 1U);
  BuiltSession built = build_session(*test::phantom_bone()->bone, setup);
  EXPECT_TRUE(replay_record(*built.session, record).is_same());
}

TEST_F(DrillPlayerTest, SavesARecordThatReplaysTheSame) {
  drill_through({.tool_operator = "push", .push_n = 200.0, .speed = kAsFastAsItGoes});
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "run.h5";
  write_record(*player_->done(), file);
  const SessionRecord record = read_record(file);
  EXPECT_TRUE(record.is_whole);
  EXPECT_EQ(record.cycles.size(), player_->done()->inputs.size());
  EXPECT_EQ(record.events.size(), player_->events().size());
  EXPECT_EQ(record.setup.at("operator kind"), "push");
  const SessionSetup setup = recorded_setup(record.setup, file);
  EXPECT_EQ(setup.bone_hash, test::phantom_bone()->bone->hash());
  BuiltSession built = build_session(*test::phantom_bone()->bone, setup);
  const Replay replay = replay_record(*built.session, record);
  EXPECT_TRUE(replay.is_same()) << replay.difference << replay.gap;
  EXPECT_EQ(recorded(*player_->last()), record.cycles.back());
}

/// The same at one go, by the operator itself.
Drilling milled_in_one_go() {
  SessionSetup setup = setup_for(session_setup(test::burr_path(), {}), {.keeps_to_path = false});
  setup.has_clearances = false;
  const BoneField whole(test::phantom_bone()->model());
  MillingMotion tool_operator(test::entry_milling(), setup.path.bit, whole);
  return drill_bone(*test::phantom_bone()->bone, setup, tool_operator);
}

TEST_F(DrillPlayerTest, MillsAPatchThroughAStopUndoAndARecord) {
  document_.set_paths({test::burr_path()});
  const DrillPlan plan{.tool_operator = "milling",
                       .stops_on_breach = true,
                       .speed = 2.0,
                       .milling = std::make_shared<const Milling>(test::entry_milling())};
  const Drilling ground_truth = milled_in_one_go();
  const double removed_mm3 = 1e-3 * static_cast<double>(ground_truth.removed);
  // The patch 1 mm deep, less ridges of 0.06 mm; at most as wide as the burr takes it.
  EXPECT_GT(removed_mm3, 0.9 * 4.0 * 4.0);
  EXPECT_LT(removed_mm3, 8.0 * 8.0);
  const auto whole = surface();
  player_->start(plan);
  ASSERT_TRUE(wait_until([&] { return player_->seconds() > 1.0; })) << trouble_;
  ASSERT_NE(player_->setup(), nullptr);
  EXPECT_EQ(player_->setup()->engine, EngineKind::voxel);
  player_->stop();
  ASSERT_TRUE(player_->can_go_on());
  player_->step_back(0.3);
  ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
  player_->set_speed(kAsFastAsItGoes);
  player_->go_on();
  ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
  EXPECT_TRUE(player_->is_over());
  EXPECT_EQ(player_->removed(), ground_truth.removed);
  expect_same_rows(player_->rows(), ground_truth.rows);
  EXPECT_EQ(player_->events().size(), ground_truth.events.size());
  EXPECT_GT(ground_truth.max_torque_n_mm, 0.0);
  // Through the lamina's cortex, out of the bone and in again: nothing that a pedicle's drilling is told of.
  for (const SessionEvent& event : ground_truth.events) {
    EXPECT_TRUE(event.kind == EventKind::contact || event.kind == EventKind::outside_volume) << name_of(event.kind);
  }
  EXPECT_EQ(player_->last()->state, DrillState::initial);

  const test::TemporaryFolder folder;
  write_record(*player_->done(), folder.path() / "run.h5");
  EXPECT_TRUE(replay(folder.path() / "run.h5", *test::phantom_bone()->bone).is_same());
  const SessionRecord record = read_record(folder.path() / "run.h5");
  EXPECT_EQ(record.setup.at("operator kind"), "milling");
  EXPECT_EQ(record.setup.at("operator milling"), "patch");
  write_report(*player_->done(), folder.path() / "milled");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "milled" / "report.html"));

  const auto milled = surface();
  EXPECT_NE(milled, whole);
  player_->undo_hole();
  EXPECT_EQ(surface(), whole);
  player_->redo_hole();
  EXPECT_EQ(surface(), milled);
  EXPECT_EQ(player_->removed(), ground_truth.removed);
  // What is milled already is gone for the next.
  drill_through(plan);
  EXPECT_EQ(player_->removed(), 0U);
  EXPECT_EQ(trouble_, "");
  // As after a crash.
  const std::vector<HoleOrder> orders = player_->orders();
  ASSERT_EQ(orders.size(), 2U);
  player_->drill_again({orders.front()});
  ASSERT_TRUE(wait_for(State::stopped)) << trouble_;
  EXPECT_EQ(player_->removed(), ground_truth.removed);
}

TEST_F(DrillPlayerTest, SaysWhyAMillingCannotBe) {
  document_.set_paths({test::burr_path()});
  player_->start({.tool_operator = "milling"});
  EXPECT_THAT(trouble_, HasSubstr("choose its file"));
  EXPECT_EQ(player_->state(), State::idle);
  Milling milling = test::entry_milling();
  milling.apart_mm = 5.0;
  player_->start({.tool_operator = "milling", .milling = std::make_shared<const Milling>(milling)});
  ASSERT_TRUE(wait_for(State::idle));
  EXPECT_THAT(trouble_, HasSubstr("5"));
}

TEST_F(DrillPlayerTest, DrillsByTheEngineThatIsChosen) {
  const DrillPath path = test::phantom_paths().front();
  std::vector<std::size_t> removed;
  for (const EngineKind engine : {EngineKind::ring, EngineKind::leaf, EngineKind::voxel}) {
    const DrillPlan plan{.tool_operator = "tremor", .feed_mm_s = 3.0, .speed = kAsFastAsItGoes, .engine = engine};
    drill_through(plan);
    EXPECT_EQ(player_->setup()->engine, engine);
    EXPECT_EQ(player_->removed(), drilled_in_one_go(path, plan).removed);
    removed.push_back(player_->removed());
    player_->undo_hole();
  }
  EXPECT_EQ(removed[1], removed[0]) << "the same points";
  EXPECT_NE(removed[2], removed[0]) << "voxels lie elsewhere";
  drill_through({.tool_operator = "tremor", .speed = kAsFastAsItGoes});
  EXPECT_EQ(player_->setup()->engine, EngineKind::ring);
}

TEST_F(DrillPlayerTest, WritesTheFilesOfADrilling) {
  drill_through({.feed_mm_s = 5.0, .speed = kAsFastAsItGoes});
  const test::TemporaryFolder folder;
  write_report(*player_->done(), folder.path() / "drilled");
  for (const char* name : {"report.html", "drilled.vdb", "drilled.stl", "log.csv", "events.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "drilled" / name)) << name;
  }
}

TEST_F(DrillPlayerTest, StopsAtABreachWhereAskedTo) {
  // Straight to the middle of the canal, which lies between the pedicles.
  std::vector<DrillPath> paths = test::phantom_paths();
  paths[0].target_mm = 0.5 * (paths[0].target_mm + paths[1].entry_mm);
  document_.set_paths(paths);
  drill_through({.stops_on_breach = true, .speed = kAsFastAsItGoes});
  const auto& events = player_->events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const SessionEvent& event) { return event.kind == EventKind::stop_breach; }));
  EXPECT_LT(player_->last()->depth_mm, paths[0].length_mm() - 1.0);
  EXPECT_FALSE(player_->can_go_on());
}

TEST_F(DrillPlayerTest, IsDestroyedQuicklyWhileItPreparesAndWhileItDrills) {
  const auto destroy = [&](const char* when) {
    QElapsedTimer clock;
    clock.start();
    player_.reset();
    std::printf("destroyed while %s: %lld ms\n", when, static_cast<long long>(clock.elapsed()));
    EXPECT_LT(clock.elapsed(), 500) << when;
  };
  for (const int wait_ms : {0, 300, 1000}) {  // filling, looking for walls
    make_player();
    player_->start({});
    QElapsedTimer clock;
    clock.start();
    wait_until([&] { return clock.elapsed() >= wait_ms; });
    destroy("preparing");
  }
  for (const double speed : {1.0, kAsFastAsItGoes}) {
    make_player();
    player_->start({.tool_operator = "tremor", .speed = speed});
    ASSERT_TRUE(wait_for(State::drilling));
    destroy("drilling");
  }
}

TEST_F(DrillPlayerTest, SaysThatAPathMissesTheBone) {
  DrillPath path = test::phantom_paths().front();
  path.entry_mm += Vec3(200.0, 0.0, 0.0);
  path.target_mm += Vec3(200.0, 0.0, 0.0);
  document_.set_paths({path});
  player_->start({});
  ASSERT_TRUE(wait_until([&] { return !trouble_.empty(); }));
  EXPECT_THAT(trouble_, HasSubstr("left"));
  EXPECT_THAT(trouble_, HasSubstr("bone"));
  EXPECT_EQ(player_->state(), State::idle);
  document_.set_paths({});
  trouble_.clear();
  player_->start({});
  EXPECT_THAT(trouble_, HasSubstr("path"));
}

TEST_F(DrillPlayerTest, KeepsThePathItBeganWith) {
  player_->start({.speed = 1.0});
  ASSERT_TRUE(wait_for(State::drilling));
  const DrillPath path = *player_->path();
  document_.remove_path(0);
  EXPECT_EQ(player_->path()->target_mm, path.target_mm);
  document_.set_bone(test::phantom_bone());  // opened again: begins anew
  EXPECT_EQ(player_->state(), State::idle);
  EXPECT_EQ(player_->path(), nullptr);
}

TEST_F(DrillPlayerTest, GoesByTheClock) {
  player_->start({.feed_mm_s = 4.0, .speed = 1.0});
  ASSERT_TRUE(wait_for(State::drilling)) << trouble_;
  told_ = 0;
  QElapsedTimer clock;
  clock.start();
  EXPECT_TRUE(wait_until([&] { return clock.elapsed() >= 3000; }));
  const double clock_s = 1e-3 * static_cast<double>(clock.elapsed());
  // Behind where the computer was busy with other things, never ahead.
  EXPECT_LT(player_->seconds(), clock_s + 0.1);
  EXPECT_GT(player_->seconds(), 0.5 * clock_s);
  EXPECT_LE(told_, 31 * clock_s + 1);
  std::printf("speed 1: %.2f s in %.2f s, %.0f cycles/s, %.1f surface updates/s, told %.1f times/s\n",
              player_->seconds(), clock_s, player_->cycles_per_s(), player_->surface_updates_per_s(), told_ / clock_s);
  player_->stop();
  const double stopped_s = player_->seconds();
  const auto bit = player_->bit();
  ASSERT_TRUE(bit);
  ASSERT_TRUE(wait_until([&] { return clock.elapsed() > 3300; }));
  EXPECT_EQ(player_->seconds(), stopped_s);
  EXPECT_EQ(player_->bit()->second.tip_mm, bit->second.tip_mm);
}

}  // namespace
}  // namespace spinaltap
