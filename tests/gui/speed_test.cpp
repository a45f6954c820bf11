// What the window must keep to on two cores that draw by software, at 1400 x 900. Medians: a machine may be called away
// for a moment.
#include <cstdio>

#include "apps/spinaltap-planner/scene/scene_view.h"
#include "tests/gui/frame_watch.h"
#include "tests/gui/planner_window.h"

namespace spinaltap::test {
namespace {

constexpr double kMostFrameMs = 50.0;

double ninth_tenth(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[9 * values.size() / 10];
}

constexpr double kMostOpeningS = 3.0;
constexpr double kLeastFramesPerS = 15.0;

using PlannerSpeed = PlannerWindow;

TEST_F(PlannerSpeed, OpensTheBakedPhantom) {
  const std::filesystem::path file = phantom_file();
  std::vector<double> seconds;
  for (int run = 0; run < 3; ++run) {
    QElapsedTimer clock;
    clock.start();
    planner().open(file);
    ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }, 60000));
    window->settle();
    seconds.push_back(1e-3 * static_cast<double>(clock.elapsed()));
  }
  std::printf("opened in %.2f s\n", median(seconds));
  EXPECT_LT(median(seconds), kMostOpeningS);
}

TEST_F(PlannerSpeed, ScrollsSlicesAndDragsEnds) {
  show_phantom();
  for (const char* name : {"axial", "coronal", "sagittal"}) {
    SliceView& view = slice(name);
    input.move(view, view.rect().center());
    FrameWatch watch(view);
    std::vector<double> ms;
    for (int n = 0; n < 30; ++n) ms.push_back(watch.ms_to_next_frame([&] { input.wheel(n < 15 ? 1 : -1); }));
    std::printf("%s: %.1f ms from the wheel to the next frame, nine of ten within %.1f ms\n", name, median(ms),
                ninth_tenth(ms));
    EXPECT_LT(median(ms), kMostFrameMs) << name;
  }
  SliceView& axial = slice("axial");
  const QPoint target = pixel_of(axial, document().chosen_path()->target_mm);
  const QPoint entry = pixel_of(axial, document().chosen_path()->entry_mm);
  for (const QPoint& end : {target, entry}) {
    input.move(axial, end);
    input.press();
    FrameWatch watch(axial);
    std::vector<double> ms;
    for (int n = 1; n <= 30; ++n)
      ms.push_back(watch.ms_to_next_frame([&] { input.nudge(axial, end + QPoint(n / 2, n)); }));
    input.release();
    std::printf("%.1f ms from a move of the mouse to the next frame, nine of ten within %.1f ms\n", median(ms),
                ninth_tenth(ms));
    EXPECT_LT(median(ms), kMostFrameMs);
  }
}

TEST_F(PlannerSpeed, DragsEndsIn3D) {
  show_phantom();
  SceneView& scene = window->panes().scene();
  for (const Vec3& end_mm : {document().chosen_path()->entry_mm, document().chosen_path()->target_mm}) {
    const QPoint end = scene.to_pixel(end_mm).toPoint();
    input.move(scene, end);
    input.press();
    FrameWatch watch(scene);
    std::vector<double> ms;
    for (int n = 1; n <= 20; ++n) {
      let_work(80);  // until the frame before has been drawn
      ms.push_back(watch.ms_to_next_frame([&] { input.nudge(scene, end + QPoint(n / 2, n)); }));
    }
    input.release();
    std::printf("3D: %.1f ms from a move of the mouse to the next frame, nine of ten within %.1f ms\n", median(ms),
                ninth_tenth(ms));
    EXPECT_LT(median(ms), kMostFrameMs);
    EXPECT_TRUE(document().undo_stack().canUndo());
    document().undo_stack().undo();
  }
}

TEST_F(PlannerSpeed, DrillingShowsFrames) {
  show_phantom();
  DrillPlayer& player = planner().player();
  player.start({.hand = "tremor", .feed_mm_s = 2.0, .speed = 1.0});
  ASSERT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::drilling; }, 60000));
  let_work(2000);  // into the bone
  FrameWatch scene(window->panes().scene());
  FrameWatch axial(slice("axial"));
  QElapsedTimer clock;
  clock.start();
  let_work(5000);
  const double seconds = 1e-3 * static_cast<double>(clock.elapsed());
  std::printf("drilling: %.1f frames a second in 3D, %.1f on a slice\n", scene.frames() / seconds,
              axial.frames() / seconds);
  EXPECT_GE(scene.frames() / seconds, kLeastFramesPerS);
  EXPECT_EQ(player.state(), DrillPlayer::State::drilling);
  player.stop();
  EXPECT_TRUE(wait_until([&] { return player.state() == DrillPlayer::State::stopped; }));
}

}  // namespace
}  // namespace spinaltap::test
