// What the window must keep to on two cores that draw by software, at 1400 x 900. Nine frames of ten: a machine may be
// called away for a moment. A host that gives a virtual machine's processors to others for longer is not what is
// tested: a round that misses its limit fails only where the machine had its processors to itself, and is repeated
// elsewhere.
#include <algorithm>
#include <cstdio>

#include "apps/spinaltap-planner/scene/scene_view.h"
#include "tests/gui/frame_watch.h"
#include "tests/gui/planner_window.h"
#include "tests/gui/stolen_time.h"

namespace spinaltap::test {
namespace {

constexpr double kMaxFrameMs = 50.0;
constexpr double kMaxOpeningS = 3.0;
constexpr double kMinFramesPerS = 15.0;

using PlannerSpeed = PlannerWindow;

/// Until a round keeps to its limit.
void expect_in_a_round(const std::function<bool()>& keeps_to_its_limit) {
  constexpr int kMaxRounds = 8;
  constexpr double kLittle = 0.05;
  for (int round = 0; round < kMaxRounds; ++round) {
    const StolenTime stolen;
    if (keeps_to_its_limit()) return;
    const double share = stolen.share();
    std::printf("over the limit, while the host kept %.0f %% of the processors\n", 100.0 * share);
    if (share < kLittle) {
      ADD_FAILURE() << "over the limit, and the processors were this machine's";
      return;
    }
    let_work(3000);
  }
  GTEST_SKIP() << "the host kept the processors in all of " << kMaxRounds << " rounds";
}

/// Of frames, with their place in words.
bool are_quick(const char* what, std::vector<double> frames_ms) {
  std::sort(frames_ms.begin(), frames_ms.end());
  const double max_ms = frames_ms[9 * frames_ms.size() / 10];
  std::printf("%s: %.1f ms to the next frame, nine of ten within %.1f ms\n", what, median(frames_ms), max_ms);
  return max_ms < kMaxFrameMs;
}

TEST_F(PlannerSpeed, OpensTheBakedPhantom) {
  const std::filesystem::path file = phantom_file();
  expect_in_a_round([&] {
    std::vector<double> seconds;
    for (int run = 0; run < 3; ++run) {
      QElapsedTimer clock;
      clock.start();
      planner().open(file);
      EXPECT_TRUE(wait_until([&] { return !planner().job().is_running(); }, 60000));
      window->settle();
      seconds.push_back(1e-3 * static_cast<double>(clock.elapsed()));
    }
    std::printf("opened in %.2f s\n", median(seconds));
    return median(seconds) < kMaxOpeningS;
  });
}

TEST_F(PlannerSpeed, ScrollsSlices) {
  show_phantom();
  for (const char* name : {"axial", "coronal", "sagittal"}) {
    SliceView& view = slice(name);
    input.move(view, view.rect().center());
    FrameWatch watch(view);
    expect_in_a_round([&] {
      std::vector<double> ms;
      for (int n = 0; n < 30; ++n) ms.push_back(watch.ms_to_next_frame([&] { input.wheel(n < 15 ? 1 : -1); }));
      return are_quick(name, ms);
    });
  }
}

TEST_F(PlannerSpeed, DragsEndsOnASlice) {
  show_phantom();
  SliceView& axial = slice("axial");
  for (const Vec3& end_mm : {document().chosen_path()->target_mm, document().chosen_path()->entry_mm}) {
    const QPoint end = pixel_of(axial, end_mm);
    expect_in_a_round([&] {
      input.move(axial, end);
      input.press();
      FrameWatch watch(axial);
      std::vector<double> ms;
      for (int n = 1; n <= 30; ++n)
        ms.push_back(watch.ms_to_next_frame([&] { input.nudge(axial, end + QPoint(n / 2, n)); }));
      input.release();
      document().undo_stack().undo();
      return are_quick("dragged on a slice", ms);
    });
  }
}

TEST_F(PlannerSpeed, DragsEndsIn3D) {
  show_phantom();
  SceneView& scene = window->panes().scene();
  for (const Vec3& end_mm : {document().chosen_path()->target_mm, document().chosen_path()->entry_mm}) {
    const QPoint end = scene.to_pixel(end_mm).toPoint();
    expect_in_a_round([&] {
      input.move(scene, end);
      input.press();
      FrameWatch watch(scene);
      std::vector<double> ms;
      constexpr int kNoClick = 5;  // pixels from where the button was pressed: what is less may be a click
      for (int n = 0; n < 20; ++n) {
        let_work(80);  // until the frame before has been drawn
        ms.push_back(watch.ms_to_next_frame([&] { input.nudge(scene, end + QPoint(n / 2, kNoClick + n)); }));
      }
      input.release();
      EXPECT_TRUE(document().undo_stack().canUndo());
      document().undo_stack().undo();
      return are_quick("dragged in 3D", ms);
    });
  }
}

TEST_F(PlannerSpeed, DrillingShowsFrames) {
  show_phantom();
  DrillPlayer& player = planner().player();
  expect_in_a_round([&] {
    player.start({.tool_operator = "tremor", .feed_mm_s = 2.0, .speed = 1.0});
    EXPECT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::drilling; }, 60000));
    let_work(2000);  // into the bone
    FrameWatch scene(window->panes().scene());
    FrameWatch axial(slice("axial"));
    QElapsedTimer clock;
    clock.start();
    let_work(5000);
    const double seconds = 1e-3 * static_cast<double>(clock.elapsed());
    std::printf("drilling: %.1f frames a second in 3D, %.1f on a slice\n", scene.frames() / seconds,
                axial.frames() / seconds);
    EXPECT_EQ(player.state(), DrillPlayer::State::drilling);
    player.stop();
    EXPECT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }));
    player.undo_hole();
    return scene.frames() / seconds >= kMinFramesPerS;
  });
}

}  // namespace
}  // namespace spinaltap::test
