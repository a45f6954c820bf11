#include "apps/spinaltap-planner/scene/scene_view.h"

#include <gmock/gmock.h>

#include <QApplication>
#include <QElapsedTimer>
#include <QMouseEvent>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "apps/spinaltap-planner/colours.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/gui/drilled_phantom.h"
#include "tests/gui/x_input.h"

namespace spinaltap {
namespace {

constexpr int kWidth = 700;
constexpr int kHeight = 450;

/// A pane with the phantom, shown.
class SceneViewTest : public testing::Test {
 protected:
  PlanDocument document_;
  ViewState state_;
  SceneView view_{document_, state_};

  void SetUp() override {
    view_.resize(kWidth, kHeight);
    view_.show();
    document_.set_bone(test::phantom_bone());
    settle();
  }

  static void settle() {
    for (int n = 0; n < 5; ++n) QCoreApplication::processEvents();
  }

  void send(QEvent::Type type, const QPointF& pixel, Qt::MouseButton button, Qt::MouseButtons held) {
    QWidget* const pane = view_.focusProxy();
    QMouseEvent event(type, pixel, pane->mapToGlobal(pixel.toPoint()), button, held, Qt::NoModifier);
    QCoreApplication::sendEvent(pane, &event);
    settle();
  }
  void press(const QPointF& pixel) { send(QEvent::MouseButtonPress, pixel, Qt::LeftButton, Qt::LeftButton); }
  void move(const QPointF& pixel) { send(QEvent::MouseMove, pixel, Qt::NoButton, Qt::LeftButton); }
  void release(const QPointF& pixel) { send(QEvent::MouseButtonRelease, pixel, Qt::LeftButton, Qt::NoButton); }
  void key(int which) {
    QKeyEvent event(QEvent::KeyPress, which, Qt::NoModifier);
    QCoreApplication::sendEvent(view_.focusProxy(), &event);
    settle();
  }
  void drag(const QPointF& from, const QPointF& to) {
    press(from);
    for (int n = 1; n <= 4; ++n) move(from + 0.25 * n * (to - from));
    release(to);
  }

  QColor colour_at(const Vec3& p_mm) { return view_.picture().pixelColor(view_.to_pixel(p_mm).toPoint()); }
};

/// The bone is warm and light, the background blue and dark.
bool is_bone(const QColor& colour) { return colour.red() > 90 && colour.red() > colour.blue(); }

/// The largest difference of two colours in a channel.
int difference(const QColor& a, const QColor& b) {
  return std::max({std::abs(a.red() - b.red()), std::abs(a.green() - b.green()), std::abs(a.blue() - b.blue())});
}

/// From a place to the phantom's true surface.
double surface_mm(const Vec3& p_mm) {
  double distance_mm = 1.0;
  Vertebra().evaluate({&p_mm, 1}, {&distance_mm, 1}, {});
  return distance_mm;
}

TEST_F(SceneViewTest, DrawsTheBoneWithinItsProjectedBoxAndFillsItsMiddle) {
  const Box3 bounds_mm = test::phantom_bone()->model().bounds_mm();
  for (const char* name : {"behind", "left", "above"}) {
    view_.look_from(name);
    const QImage picture = view_.picture();
    double left = kWidth, right = 0.0, top = kHeight, bottom = 0.0;
    for (int n = 0; n < 8; ++n) {
      const QPointF corner = view_.to_pixel(bounds_mm.corner(static_cast<Box3::CornerType>(n)));
      left = std::min(left, corner.x());
      right = std::max(right, corner.x());
      top = std::min(top, corner.y());
      bottom = std::max(bottom, corner.y());
    }
    int inside = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (x < 90 && y > kHeight - 90) continue;  // the marker
        if (!is_bone(picture.pixelColor(x, y))) continue;
        ++inside;
        ASSERT_TRUE(x > left - 2.0 && x < right + 2.0 && y > top - 2.0 && y < bottom + 2.0) << name << x << "," << y;
      }
    }
    EXPECT_GT(inside, 0.25 * (right - left) * (bottom - top)) << name;
    EXPECT_TRUE(is_bone(colour_at(vertebra_ground_truth(Vertebra()).left.target_mm))) << name;
  }
}

TEST_F(SceneViewTest, LooksFromBehindWithThePatientsLeftOnTheLeftAndTheHeadUp) {
  view_.look_from("behind");
  const Vec3 middle = test::phantom_bone()->model().bounds_mm().center();
  const QPointF centre = view_.to_pixel(middle);
  EXPECT_NEAR(centre.x(), 0.5 * kWidth, 1e-6);
  EXPECT_NEAR(centre.y(), 0.5 * kHeight, 1e-6);
  EXPECT_LT(view_.to_pixel(middle + 10.0 * Vec3::UnitX()).x(), centre.x());
  EXPECT_LT(view_.to_pixel(middle + 10.0 * Vec3::UnitZ()).y(), centre.y());
  view_.look_from("above");  // the patient's front is up
  EXPECT_LT(view_.to_pixel(middle - 10.0 * Vec3::UnitY()).y(), centre.y());
  EXPECT_LT(view_.to_pixel(middle + 10.0 * Vec3::UnitX()).x(), centre.x());
  view_.look_from("below");
  EXPECT_LT(view_.to_pixel(middle - 10.0 * Vec3::UnitY()).y(), centre.y());
  EXPECT_GT(view_.to_pixel(middle + 10.0 * Vec3::UnitX()).x(), centre.x());
}

TEST_F(SceneViewTest, ShowsTheWallOfADrilledHoleAndTheBoneAgainAfterAReset) {
  test::DrilledPhantom phantom;
  const DrillPath& path = phantom.path;
  document_.set_paths({path});
  view_.update_surface(phantom.drill());
  // Away from the bone, so that it hides nothing.
  view_.set_bit(std::pair{path.bit, Pose{path.entry_mm + Vec3(0.0, 0.0, 80.0), path.direction()}});
  view_.look_from("hole");
  // The eye looks askew into the hole and sees the wall on the far side; cancellous bone is red there.
  const QImage drilled = view_.picture();
  const QPoint entry = view_.to_pixel(path.entry_mm).toPoint();
  const auto reddest = [&](const QImage& picture) {
    int max = 0;
    for (int y = -25; y <= 25; ++y) {
      for (int x = -25; x <= 25; ++x) {
        const QColor colour = picture.pixelColor(entry + QPoint(x, y));
        max = std::max(max, colour.red() - colour.green());
      }
    }
    return max;
  };
  EXPECT_GT(reddest(drilled), 40);
  phantom.remaining.reset();
  view_.update_surface(phantom.surface.update());
  EXPECT_LT(reddest(view_.picture()), 30);
}

TEST_F(SceneViewTest, DraggingTheTargetMovesItInTheViewsPlane) {
  document_.set_paths(test::phantom_paths());
  view_.look_from("behind");
  settle();
  const Vec3 before = document_.paths()[0].target_mm;
  const QPointF from = view_.to_pixel(before);
  // From behind, the plane is the coronal one through the target; 10 mm in it are so many pixels.
  const double pixels_in_10_mm = view_.to_pixel(before - 10.0 * Vec3::UnitX()).x() - from.x();
  drag(from + QPointF(2.0, 1.0), from + QPointF(32.0, 21.0));
  const Vec3 moved = document_.paths()[0].target_mm - before;
  EXPECT_NEAR(moved.x(), -300.0 / pixels_in_10_mm, 1e-6);
  EXPECT_NEAR(moved.y(), 0.0, 1e-9);
  EXPECT_NEAR(moved.z(), -200.0 / pixels_in_10_mm, 1e-6);
  EXPECT_EQ(document_.undo_stack().count(), 1);
  document_.undo_stack().undo();
  EXPECT_EQ(document_.paths()[0].target_mm, before);
}

TEST_F(SceneViewTest, DraggingTheEntryKeepsItOnTheBoneUnderThePointer) {
  document_.set_paths(test::phantom_paths());
  view_.look_from("behind");
  settle();
  const QPointF from = view_.to_pixel(document_.paths()[0].entry_mm);
  const QPointF to = from + QPointF(4.0, 26.0);
  drag(from, to);
  const Vec3 entry_mm = document_.paths()[0].entry_mm;
  EXPECT_NEAR(surface_mm(entry_mm), 0.0, 0.03);  // the grid of 0.4 mm: docs/bone-vdb.md
  EXPECT_NEAR(view_.to_pixel(entry_mm).x(), to.x(), 0.5);
  EXPECT_NEAR(view_.to_pixel(entry_mm).y(), to.y(), 0.5);
}

TEST_F(SceneViewTest, EscapePutsADraggedEndBack) {
  document_.set_paths(test::phantom_paths());
  document_.remove_path(1);
  document_.undo_stack().undo();
  settle();
  const Vec3 before = document_.paths()[0].target_mm;
  const QPointF from = view_.to_pixel(before);
  press(from);
  move(from + QPointF(20.0, 0.0));
  EXPECT_NE(document_.paths()[0].target_mm, before);
  key(Qt::Key_Escape);
  EXPECT_EQ(document_.paths()[0].target_mm, before);
  move(from + QPointF(40.0, 0.0));
  release(from + QPointF(40.0, 0.0));
  EXPECT_EQ(document_.paths()[0].target_mm, before);
  EXPECT_FALSE(document_.undo_stack().canUndo());
  EXPECT_TRUE(document_.undo_stack().canRedo());
}

TEST_F(SceneViewTest, HoveringAHandleChangesCursorAndPicture) {
  document_.set_paths(test::phantom_paths());
  settle();
  const QPointF place = view_.to_pixel(document_.paths()[0].entry_mm);
  const QImage before = view_.picture();
  send(QEvent::MouseMove, place, Qt::NoButton, Qt::NoButton);
  EXPECT_EQ(view_.focusProxy()->cursor().shape(), Qt::OpenHandCursor);
  EXPECT_NE(view_.picture(), before);
  send(QEvent::MouseMove, QPointF(20.0, 20.0), Qt::NoButton, Qt::NoButton);
  EXPECT_EQ(view_.focusProxy()->cursor().shape(), Qt::ArrowCursor);
  EXPECT_EQ(view_.picture(), before);
}

TEST_F(SceneViewTest, AClickChoosesThePathUnderIt) {
  document_.set_paths(test::phantom_paths());
  settle();
  const DrillPath& right = document_.paths()[1];
  const QPointF place = view_.to_pixel(0.5 * (right.entry_mm + right.target_mm));
  press(place);
  release(place);
  EXPECT_EQ(document_.chosen(), 1);
}

TEST_F(SceneViewTest, ADoubleClickPutsTheCrosshairOnTheBone) {
  const QPointF place(0.5 * kWidth, 0.6 * kHeight);
  send(QEvent::MouseButtonDblClick, place, Qt::LeftButton, Qt::LeftButton);
  EXPECT_NEAR(surface_mm(state_.crosshair_mm()), 0.0, 0.03);
  EXPECT_NEAR(view_.to_pixel(state_.crosshair_mm()).x(), place.x(), 0.01);
  EXPECT_NEAR(view_.to_pixel(state_.crosshair_mm()).y(), place.y(), 0.01);
}

TEST_F(SceneViewTest, GuidePlanesAppearInTheirFramesAndHideAgain) {
  state_.set_crosshair(vertebra_ground_truth(Vertebra()).left.target_mm);
  view_.look_from("above");
  const QImage without = view_.picture();
  state_.show_guide(Plane::kAxial, true);
  settle();
  const QImage with = view_.picture();
  // The frame stands a few mm around the bone, so that it is seen in the picture from above.
  const QColor wanted = plane_colour(Plane::kAxial);
  int framed = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      framed += difference(with.pixelColor(x, y), wanted) < 12 ? 1 : 0;
    }
  }
  EXPECT_GT(framed, kHeight);
  state_.show_guide(Plane::kAxial, false);
  settle();
  EXPECT_EQ(view_.picture(), without);
}

TEST_F(SceneViewTest, ATransparentBoneShowsWhatIsInIt) {
  document_.set_paths(test::phantom_paths());
  view_.look_from("left");
  const DrillPath& path = document_.paths()[0];
  // Beside the axis, within the bit, 12 mm before the target.
  const Vec3 in_bit = path.target_mm - 12.0 * path.direction() + 0.9 * Vec3::UnitZ();
  EXPECT_TRUE(is_bone(colour_at(in_bit)));
  state_.set_bone_opacity(0.3);
  settle();
  EXPECT_FALSE(is_bone(colour_at(in_bit)));  // the bit is blue
  state_.set_bone_opacity(0.0);
  settle();
  EXPECT_FALSE(is_bone(colour_at(test::phantom_bone()->model().bounds_mm().center() - 15.0 * Vec3::UnitY())));
}

TEST_F(SceneViewTest, DrawsAScrewsHead) {
  std::vector<DrillPath> paths{test::phantom_paths()[0]};
  paths[0].screw = PedicleScrew{"6.5 x 45", 6.5, 45.0, 4.0};
  document_.set_paths(paths);
  view_.look_from("behind");
  state_.set_bone_opacity(0.0);
  settle();
  // Beside bit and thread, within the tulip.
  const Vec3 in_tulip = paths[0].target_mm - 55.0 * paths[0].direction() + 5.0 * Vec3::UnitZ();
  const QColor with_head = colour_at(in_tulip);
  paths[0].screw->head.diameter_mm = 0.0;
  document_.set_paths(paths);
  settle();
  EXPECT_NE(with_head, colour_at(in_tulip));
}

TEST_F(SceneViewTest, ToolsCanBeHiddenSoThatAHoleIsSeenInto) {
  document_.set_paths(test::phantom_paths());
  view_.look_from("behind");
  const DrillPath& path = document_.paths()[0];
  // The shaft, before the bone and beside the axis.
  const Vec3 shaft = path.entry_mm - 3.0 * path.direction() + 0.9 * Vec3::UnitZ();
  const auto blueness = [&](const QColor& colour) { return colour.blue() - colour.red(); };
  EXPECT_GT(blueness(colour_at(shaft)), 40);
  state_.show_tools(false);
  settle();
  EXPECT_LT(blueness(colour_at(shaft)), 40);
  view_.set_bit(std::pair{path.bit, Pose{path.target_mm, path.direction()}});
  const QImage hidden = view_.picture();
  state_.show_tools(true);
  settle();
  EXPECT_NE(view_.picture(), hidden);
}

TEST_F(SceneViewTest, FramesThatBeginWithTheBoneAsItWasAreThoseThatDrawItAnew) {
  state_.show_guide(Plane::kSagittal, true);
  for (const double opacity : {1.0, 0.4, 1.0}) {
    state_.set_bone_opacity(opacity);
    document_.set_paths(test::phantom_paths());
    view_.picture();
    DrillPath path = document_.paths().front();
    path.target_mm += Vec3(3.0, 4.0, -2.0);
    document_.change_path(0, path, "moved");
    state_.set_crosshair(path.target_mm);
    const QImage kept = view_.picture();
    view_.resize(kWidth - 1, kHeight);
    view_.picture();
    view_.resize(kWidth, kHeight);
    EXPECT_EQ(view_.picture(), kept) << opacity;
  }
}

TEST_F(SceneViewTest, DrawsManyChangesInOneFrameAndNothingWithoutAny) {
  view_.picture();  // of all that has changed so far
  const int before = view_.frames();
  for (int n = 0; n < 20; ++n) {
    state_.set_crosshair(Vec3(n, 0.0, 0.0));
    state_.set_bone_opacity(0.5 + 0.01 * n);
  }
  EXPECT_EQ(view_.frames(), before);
  settle();
  view_.picture();
  EXPECT_EQ(view_.frames(), before + 2);  // one at once, a smooth one at rest
  settle();
  EXPECT_EQ(view_.frames(), before + 2);
}

TEST_F(SceneViewTest, AFrameIsSmoothAtRestButNotWhileAButtonIsHeld) {
  view_.picture();
  press(QPointF(60.0, 60.0));
  const int before = view_.frames();
  move(QPointF(80.0, 60.0));
  test::let_work(500);
  EXPECT_EQ(view_.frames(), before + 1);
  release(QPointF(80.0, 60.0));
  test::let_work(500);
  EXPECT_EQ(view_.frames(), before + 3);  // one at once, a smooth one at rest
}

TEST_F(SceneViewTest, SurvivesResizingHidingAndAnotherBone) {
  view_.hide();
  document_.set_paths(test::phantom_paths());
  state_.set_bone_opacity(0.5);
  settle();
  view_.resize(300, 500);
  view_.show();
  settle();
  EXPECT_EQ(view_.picture().size(), QSize(300, 500) * view_.devicePixelRatioF());
  document_.set_bone(nullptr);
  settle();
  EXPECT_FALSE(view_.picture().isNull());
  document_.set_bone(test::phantom_bone());
  state_.set_bone_opacity(1.0);
  settle();
  EXPECT_TRUE(is_bone(colour_at(vertebra_ground_truth(Vertebra()).left.target_mm)));
}

TEST_F(SceneViewTest, AnOrbitingFrameTakesUnderATenthOfASecondOfProcessorTime) {
  document_.set_paths(test::phantom_paths());
  view_.picture();
  constexpr int kSteps = 20;
  std::vector<double> frames_ms;
  QPointF pixel(60.0, 60.0);
  press(pixel);
  const std::clock_t begin = std::clock();
  for (int n = 0; n < kSteps; ++n) {
    pixel += QPointF(15.0, n % 2 == 0 ? 3.0 : -3.0);
    const int before = view_.frames();
    QElapsedTimer took;
    took.start();
    move(pixel);
    while (view_.frames() == before) QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents);
    frames_ms.push_back(1e-6 * static_cast<double>(took.nsecsElapsed()));
  }
  const double processor_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kSteps;
  release(pixel);
  std::sort(frames_ms.begin(), frames_ms.end());
  std::printf("an orbiting frame of %d x %d pixels: median %.1f ms, longest %.1f ms, %.1f ms of processor time\n",
              kWidth, kHeight, frames_ms[kSteps / 2], frames_ms.back(), processor_ms);
  // Of all threads together, so that what else runs on this computer does not count.
  EXPECT_LT(processor_ms, 100.0);
}

TEST_F(SceneViewTest, ShowsAPlateAsItsSideLies) {
  // From above into the bone, seen from behind: its width across the view, and away from the eye.
  const DrillBit plate = plate_bit(16.0, 2.0, 70.0);
  const Vec3 tip_mm = test::phantom_bone()->model().bounds_mm().center();
  view_.look_from("behind");
  const auto with_plate = [&](const Vec3& side) {
    view_.set_bit(std::pair{plate, Pose{tip_mm, -Vec3::UnitZ(), side}});
    return view_.picture();
  };
  view_.set_bit(std::nullopt);
  const QImage without = view_.picture();
  const auto changed = [&](const QImage& picture) {
    int count = 0;
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) count += picture.pixel(x, y) != without.pixel(x, y) ? 1 : 0;
    }
    return count;
  };
  const double wide = changed(with_plate(Vec3::UnitX())), thin = changed(with_plate(Vec3::UnitY()));
  // 8 by its sizes; the view is not parallel, and shows the thin one's faces a little.
  EXPECT_GT(thin, 200.0);
  EXPECT_GT(wide, 4.0 * thin);
  EXPECT_LT(wide, 10.0 * thin);
  // Not said, it lies along the patient's head and feet; there it lies along the axis, which is no pose of a plate.
  DrillBit along_x = plate;
  along_x.width_along = Vec3::UnitX();
  view_.set_bit(std::pair{along_x, Pose{tip_mm, -Vec3::UnitZ()}});
  EXPECT_NEAR(changed(view_.picture()), wide, 0.02 * wide);
}

}  // namespace
}  // namespace spinaltap
