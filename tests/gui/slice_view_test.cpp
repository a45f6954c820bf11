#include "apps/planner/slices/slice_view.h"

#include <gmock/gmock.h>

#include <QApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "core/phantom/vertebra.h"
#include "tests/gui/phantom_bone.h"

namespace spinaltap {
namespace {

constexpr double kRounding = 1e-9;  // mm, at places of some ten

/// A pane of 700 x 450 pixels over the phantom with its two paths, the left one chosen, the crosshair in its middle.
class SliceViewTest : public testing::Test {
 protected:
  SliceViewTest() {
    document_.set_bone(test::phantom_bone());
    document_.set_paths(test::phantom_paths());
    state_.set_crosshair(middle_mm());
  }

  SliceView& open(SliceKind kind) {
    view_ = std::make_unique<SliceView>(kind, document_, state_);
    view_->resize(700, 450);
    view_->show();
    QApplication::processEvents();
    return *view_;
  }

  const DrillPath& path() const { return document_.paths().front(); }
  Vec3 middle_mm() const { return 0.5 * (path().entry_mm + path().target_mm); }
  /// On no path and no handle.
  QPointF free_place() const { return view_->place_of(middle_mm()) + QPointF(60.0, 40.0); }

  void mouse(QEvent::Type type, const QPointF& at, Qt::MouseButton button = Qt::LeftButton,
             Qt::KeyboardModifiers keys = Qt::NoModifier) {
    const bool is_down = type != QEvent::MouseButtonRelease;
    QMouseEvent event(type, at, at, at, type == QEvent::MouseMove ? Qt::NoButton : button,
                      is_down ? Qt::MouseButtons(button) : Qt::NoButton, keys);
    QApplication::sendEvent(view_.get(), &event);
  }
  void press(const QPointF& at, Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    mouse(QEvent::MouseButtonPress, at, button, keys);
  }
  /// From press to release, in four moves.
  void drag(const QPointF& from, const QPointF& by, Qt::MouseButton button = Qt::LeftButton,
            Qt::KeyboardModifiers keys = Qt::NoModifier) {
    press(from, button, keys);
    for (int n = 1; n <= 4; ++n) mouse(QEvent::MouseMove, from + 0.25 * n * by, button, keys);
    mouse(QEvent::MouseButtonRelease, from + by, button, keys);
  }
  void wheel(const QPointF& at, int notches, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    QWheelEvent event(at, at, QPoint(), QPoint(0, 120 * notches), Qt::NoButton, keys, Qt::NoScrollPhase, false);
    QApplication::sendEvent(view_.get(), &event);
  }
  void key(int code, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    QKeyEvent event(QEvent::KeyPress, code, keys);
    QApplication::sendEvent(view_.get(), &event);
  }

  PlanDocument document_;
  ViewState state_;
  std::unique_ptr<SliceView> view_;
};

TEST_F(SliceViewTest, ShowsTheCtsGreyUnderEachPixel) {
  document_.set_paths({});
  state_.set_window({1200.0, 300.0});
  for (const SliceKind kind : {SliceKind::axial, SliceKind::coronal, SliceKind::sagittal}) {
    const SliceView& view = open(kind);
    const QPointF cross = view.place_of(state_.crosshair_mm());
    const QImage picture = view_->grab().toImage();
    int seen = 0;
    for (int y = 60; y < 390; y += 7) {
      for (int x = 60; x < 640; x += 7) {
        if (std::abs(x - cross.x()) < 5 || std::abs(y - cross.y()) < 5) continue;
        const double hu = sample_hu(document_.bone()->ct, view.position_at(QPointF(x, y)));
        const double grey = std::clamp(255.0 * (hu - (300.0 - 600.0)) / 1200.0, 0.0, 255.0);
        // Rounding; and a place on the very edge of the CT may count as outside.
        if (std::abs(qRed(picture.pixel(x, y)) - grey) > 0.5 + 1e-6) {
          ADD_FAILURE() << static_cast<int>(kind) << " at " << x << ", " << y << ": " << qRed(picture.pixel(x, y))
                        << " for " << grey;
        }
        seen += grey > 20.0 && grey < 235.0 ? 1 : 0;
      }
    }
    EXPECT_GT(seen, 100);  // of real bone
  }
}

TEST_F(SliceViewTest, LooksFromTheFeetTheFrontAndTheLeft) {
  const auto letters = [&](SliceKind kind) {
    const SliceView& view = open(kind);
    const auto direction = [&](const QPointF& from, const QPointF& to) {
      return orientation_letters(view.position_at(to) - view.position_at(from));
    };
    return direction({100, 200}, {600, 200}) + direction({300, 50}, {300, 400});
  };
  EXPECT_EQ(letters(SliceKind::axial), "LP");
  EXPECT_EQ(letters(SliceKind::coronal), "LI");
  EXPECT_EQ(letters(SliceKind::sagittal), "PI");
}

TEST_F(SliceViewTest, AClickPutsTheCrosshairOnTheSlice) {
  open(SliceKind::coronal);
  const Vec3 expected_mm = view_->position_at(free_place());
  drag(free_place(), {});
  EXPECT_LT((state_.crosshair_mm() - expected_mm).norm(), kRounding);
  EXPECT_NEAR(state_.crosshair_mm().y(), middle_mm().y(), kRounding);
  // Dragged off the CT it stays at its edge.
  drag(free_place(), {3000.0, 0.0});
  EXPECT_TRUE(is_in_grid(document_.bone()->ct.geometry, state_.crosshair_mm()));
}

TEST_F(SliceViewTest, AWheelStepIsOneSliceOfTheCt) {
  const Vec3 spacing_mm = document_.bone()->ct.geometry.spacing_mm;
  const std::array<Vec3, 3> away{Vec3::UnitZ(), Vec3::UnitY(), -Vec3::UnitX()};  // from feet, front and left
  for (const SliceKind kind : {SliceKind::axial, SliceKind::coronal, SliceKind::sagittal}) {
    open(kind);
    state_.set_crosshair(middle_mm());
    const Vec3& direction = away[static_cast<std::size_t>(kind)];
    const double step_mm = std::abs(spacing_mm.dot(direction));
    wheel({300, 200}, 1);
    EXPECT_LT((state_.crosshair_mm() - middle_mm() - step_mm * direction).norm(), kRounding);
    wheel({300, 200}, -1, Qt::ShiftModifier);
    EXPECT_LT((state_.crosshair_mm() - middle_mm() + 9.0 * step_mm * direction).norm(), kRounding);
    key(Qt::Key_PageUp, Qt::ShiftModifier);
    key(Qt::Key_Down);
    EXPECT_LT((state_.crosshair_mm() - middle_mm()).norm(), kRounding);
    wheel({300, 200}, 100000);
    EXPECT_TRUE(is_in_grid(document_.bone()->ct.geometry, state_.crosshair_mm()));
  }
}

TEST_F(SliceViewTest, DraggingTheTargetMovesItInThePlaneAsOneStepBack) {
  open(SliceKind::sagittal);
  state_.set_crosshair(middle_mm() + Vec3(4.0, 0.0, 0.0));  // the target lies off this slice
  const DrillPath before = path();
  const double mm_per_px = view_->frame().pixel_mm;
  drag(view_->place_of(before.target_mm) + QPointF(3.0, -2.0), {25.0, -40.0});
  // On the sagittal slice right is posterior and down is inferior.
  const Vec3 expected_mm = before.target_mm + mm_per_px * Vec3(0.0, 25.0, 40.0);
  EXPECT_LT((path().target_mm - expected_mm).norm(), kRounding);
  EXPECT_EQ(path().entry_mm, before.entry_mm);
  EXPECT_EQ(document_.undo_stack().count(), 1);
  document_.undo_stack().undo();
  EXPECT_EQ(path().target_mm, before.target_mm);
}

TEST_F(SliceViewTest, DraggingTheEntryKeepsItOnTheBonesSurface) {
  open(SliceKind::axial);
  const Vertebra vertebra;
  const Vec3 before_mm = path().entry_mm;
  for (const QPointF& by : {QPointF(14.0, -9.0), QPointF(-20.0, 25.0)}) {
    drag(view_->place_of(path().entry_mm), by);
    double distance_mm = 1.0;
    vertebra.evaluate({&path().entry_mm, 1}, {&distance_mm, 1}, {});
    EXPECT_NEAR(distance_mm, 0.0, 0.03);  // the grid of 0.4 mm: docs/bone-vdb.md
  }
  EXPECT_GT((path().entry_mm - before_mm).norm(), 0.5);
  EXPECT_EQ(document_.undo_stack().count(), 2);
}

TEST_F(SliceViewTest, AClickOnAHandleMovesNothing) {
  open(SliceKind::axial);
  const Vec3 before_mm = state_.crosshair_mm();
  drag(view_->place_of(path().entry_mm), {1.0, 1.0});
  EXPECT_EQ(document_.undo_stack().count(), 0);
  EXPECT_EQ(state_.crosshair_mm(), before_mm);
}

TEST_F(SliceViewTest, EscapeGivesUpADrag) {
  open(SliceKind::axial);
  const DrillPath before = path();
  press(view_->place_of(before.entry_mm));
  mouse(QEvent::MouseMove, view_->place_of(before.entry_mm) + QPointF(20.0, 10.0));
  EXPECT_NE(path().entry_mm, before.entry_mm);
  key(Qt::Key_Escape);
  EXPECT_EQ(path().entry_mm, before.entry_mm);
  EXPECT_FALSE(document_.undo_stack().canUndo());
  mouse(QEvent::MouseMove, {300.0, 300.0});
  EXPECT_EQ(path().entry_mm, before.entry_mm);
}

TEST_F(SliceViewTest, AClickOnAnotherPathChoosesIt) {
  open(SliceKind::axial);
  const DrillPath other = document_.paths()[1];
  drag(view_->place_of(0.5 * (other.entry_mm + other.target_mm)), {});
  EXPECT_EQ(document_.chosen(), 1);
  drag(view_->place_of(path().target_mm), {30.0, 0.0});
  EXPECT_EQ(document_.chosen(), 0);
  EXPECT_EQ(document_.undo_stack().count(), 0);  // the press chose; a path moves only once it is chosen
}

TEST_F(SliceViewTest, KeysNudgeTheEndsInTheSlice) {
  open(SliceKind::coronal);
  const DrillPath before = path();
  key(Qt::Key_Right, Qt::AltModifier);
  EXPECT_LT((path().target_mm - before.target_mm - Vec3(0.1, 0.0, 0.0)).norm(), kRounding);
  key(Qt::Key_Up, Qt::AltModifier | Qt::ShiftModifier);
  EXPECT_LT((path().target_mm - before.target_mm - Vec3(0.1, 0.0, 1.0)).norm(), kRounding);
  EXPECT_EQ(path().entry_mm, before.entry_mm);
  key(Qt::Key_Left, Qt::ControlModifier | Qt::ShiftModifier);
  EXPECT_LT(path().entry_mm.x(), before.entry_mm.x() - 0.3);  // the surface slopes
  EXPECT_EQ(document_.undo_stack().count(), 3);
}

TEST_F(SliceViewTest, ARightDragChangesTheWindow) {
  open(SliceKind::axial);
  state_.set_window({1000.0, 200.0});
  drag({100.0, 300.0}, {350.0, -45.0}, Qt::RightButton);
  EXPECT_NEAR(state_.window().width_hu, 1000.0 * std::sqrt(2.0), 1e-6);  // half a pane's width
  EXPECT_NEAR(state_.window().level_hu, 200.0 + 0.1 * 1000.0, 1e-6);     // a tenth of its height
}

TEST_F(SliceViewTest, ZoomsAboutThePointerPansAndFits) {
  open(SliceKind::coronal);
  const double fitted_mm = view_->frame().pixel_mm;
  const QPointF at(500.0, 100.0);
  const Vec3 under_mm = view_->position_at(at);
  wheel(at, 3, Qt::ControlModifier);
  EXPECT_LT(view_->frame().pixel_mm, 0.7 * fitted_mm);
  EXPECT_LT((view_->position_at(at) - under_mm).norm(), kRounding);
  drag(at, {-200.0, 150.0}, Qt::LeftButton, Qt::ShiftModifier);
  EXPECT_LT((view_->position_at({300.0, 250.0}) - under_mm).norm(), kRounding);
  drag({300.0, 250.0}, {10.0, 10.0}, Qt::MiddleButton);
  EXPECT_LT((view_->position_at({310.0, 260.0}) - under_mm).norm(), kRounding);
  mouse(QEvent::MouseButtonDblClick, free_place());
  EXPECT_EQ(view_->frame().pixel_mm, fitted_mm);
}

TEST_F(SliceViewTest, TellsWhatLiesUnderThePointer) {
  open(SliceKind::axial);
  mouse(QEvent::MouseMove, free_place(), Qt::NoButton);
  ASSERT_TRUE(state_.hovered_mm().has_value());
  EXPECT_LT((*state_.hovered_mm() - view_->position_at(free_place())).norm(), kRounding);
  EXPECT_EQ(view_->cursor().shape(), Qt::CrossCursor);
  mouse(QEvent::MouseMove, view_->place_of(path().target_mm), Qt::NoButton);
  EXPECT_EQ(view_->cursor().shape(), Qt::OpenHandCursor);
  mouse(QEvent::MouseMove, view_->place_of(document_.paths()[1].target_mm), Qt::NoButton);
  EXPECT_EQ(view_->cursor().shape(), Qt::PointingHandCursor);
  QEvent leave(QEvent::Leave);
  QApplication::sendEvent(view_.get(), &leave);
  EXPECT_FALSE(state_.hovered_mm().has_value());
}

/// How wide the blue is across the path through a place, pixels.
double blue_width_px(const QImage& picture, const SliceView& view, const Vec3& through_mm, const Vec3& across) {
  const auto blueness = [&](double off_mm) {
    const QPointF at = view.place_of(through_mm + off_mm * across);
    const QRgb pixel = picture.pixel(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    return qBlue(pixel) - qRed(pixel);
  };
  double low_mm = 0.0;
  double high_mm = 0.0;
  for (double off_mm = -3.0; off_mm <= 3.0; off_mm += 0.01) {
    if (blueness(off_mm) < 60) continue;
    low_mm = std::min(low_mm, off_mm);
    high_mm = std::max(high_mm, off_mm);
  }
  return (high_mm - low_mm) / view.frame().pixel_mm;
}

TEST_F(SliceViewTest, DrawsTheBitAsWideAsItIs) {
  open(SliceKind::axial);  // the phantom's paths are axial
  state_.set_crosshair(path().target_mm + Vec3(-12.0, -5.0, 0.0));
  const Vec3 across = path().direction().cross(Vec3::UnitZ());
  for (const double diameter_mm : {3.0, 4.5}) {
    DrillPath changed = path();
    changed.bit.diameter_mm = diameter_mm;
    document_.change_path(0, changed, "bit");
    view_->fit();
    view_->zoom(4.0, view_->place_of(middle_mm()));
    const double width_px = blue_width_px(view_->grab().toImage(), *view_, middle_mm(), across);
    // Its outline is 1.5 pixels wide, and pixels are whole ones.
    EXPECT_NEAR(width_px, diameter_mm / view_->frame().pixel_mm + 1.5, 1.6) << diameter_mm;
  }
}

TEST_F(SliceViewTest, DrawsTheDrillingBitInPlaceOfThePaths) {
  open(SliceKind::axial);
  view_->zoom(4.0, view_->place_of(middle_mm()));
  const QImage planned = view_->grab().toImage();
  view_->set_bit(std::pair(path().bit, Pose{path().entry_mm, path().direction()}));
  EXPECT_NE(view_->grab().toImage(), planned);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  view_->set_bit(std::pair(path().bit, Pose{Vec3::Constant(nan), path().direction()}));
  EXPECT_EQ(view_->grab().toImage(), planned);
  view_->set_bit(std::pair(DrillBit{-1.0}, Pose{path().entry_mm, path().direction()}));
  EXPECT_EQ(view_->grab().toImage(), planned);
}

TEST_F(SliceViewTest, StepsDownThePathFromBeforeTheEntryToBeyondTheTarget) {
  open(SliceKind::down_path);
  state_.set_crosshair(path().entry_mm + 12.0 * path().direction() + Vec3(0.0, 0.0, 3.0));
  EXPECT_EQ(view_->caption().toStdString(), "Down the path, 12.0 mm deep");
  wheel({300, 200}, 1);
  EXPECT_LT((state_.crosshair_mm() - path().entry_mm - 12.25 * path().direction()).norm(), kRounding);
  EXPECT_TRUE(view_->frame().into().isApprox(path().direction(), 1e-9));
  key(Qt::Key_Down, Qt::ShiftModifier);
  EXPECT_LT((state_.crosshair_mm() - path().entry_mm - 9.75 * path().direction()).norm(), kRounding);
  const auto depth_mm = [&] { return (view_->frame().origin_mm - path().entry_mm).dot(path().direction()); };
  wheel({300, 200}, -1000);
  EXPECT_NEAR(depth_mm(), -3.0, kRounding);
  wheel({300, 200}, 1000);
  EXPECT_NEAR(depth_mm(), path().length_mm() + 10.0, kRounding);
}

TEST_F(SliceViewTest, DragsTheTargetAcrossThePath) {
  open(SliceKind::down_path);
  const DrillPath before = path();
  state_.set_crosshair(before.target_mm);
  const SliceFrame frame = view_->frame();
  drag(view_->place_of(before.target_mm), {30.0, 20.0});
  const Vec3 expected_mm = before.target_mm + frame.pixel_mm * (30.0 * frame.right + 20.0 * frame.down);
  EXPECT_LT((path().target_mm - expected_mm).norm(), kRounding);
  EXPECT_TRUE(view_->frame().into().isApprox(path().direction(), 1e-9));  // looks down the new path
}

TEST_F(SliceViewTest, ShowsTheNextSliceInTime) {
  open(SliceKind::axial);
  std::vector<double> times_ms;
  for (int n = 0; n < 20; ++n) {
    // Of all threads together: what one core would take, whatever else the computer does.
    const std::clock_t start = std::clock();
    wheel({300, 200}, n < 10 ? 1 : -1);
    view_->repaint();
    times_ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::sort(times_ms.begin(), times_ms.end());
  RecordProperty("median_ms", std::to_string(times_ms[10]));
  EXPECT_LT(times_ms[10], 50.0);
}

TEST(SliceView, SaysInWordsWhatItLacks) {
  PlanDocument document;
  ViewState state;
  for (const SliceKind kind : {SliceKind::axial, SliceKind::coronal, SliceKind::sagittal, SliceKind::down_path}) {
    SliceView view(kind, document, state);
    view.resize(300, 200);
    const QImage empty = view.grab().toImage();
    EXPECT_GT(empty.width(), 0);
    view.step(3);
    view.zoom(2.0, {10.0, 10.0});
    view.fit();
    view.set_bit(std::pair(DrillBit{}, Pose{}));
    EXPECT_EQ(view.grab().toImage(), empty);
    document.set_bone(test::phantom_bone());
    EXPECT_NE(view.grab().toImage(), empty);
    document.set_bone(nullptr);
    EXPECT_EQ(view.grab().toImage(), empty) << static_cast<int>(kind);
  }
}

TEST_F(SliceViewTest, LivesThroughPathsThatGoAwayInADrag) {
  open(SliceKind::down_path);
  press(view_->place_of(path().target_mm));
  document_.set_paths({});
  mouse(QEvent::MouseMove, {10.0, 10.0});
  mouse(QEvent::MouseButtonRelease, {10.0, 10.0});
  view_->grab();
  EXPECT_EQ(view_->caption(), "Down the path");
}

}  // namespace
}  // namespace spinaltap
