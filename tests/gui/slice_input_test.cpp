// What mouse and keys do in a slice.
#include <array>
#include <cmath>

#include "core/phantom/vertebra.h"
#include "tests/gui/slice_pane.h"

namespace spinaltap {
namespace {

using SliceInputTest = SlicePane;

TEST_F(SliceInputTest, AClickPutsTheCrosshairOnTheSlice) {
  open(SliceKind::coronal);
  const Vec3 expected_mm = view_->position_at(free_place());
  drag(free_place(), {});
  EXPECT_LT((state_.crosshair_mm() - expected_mm).norm(), kRounding);
  EXPECT_NEAR(state_.crosshair_mm().y(), middle_mm().y(), kRounding);
  // Dragged off the CT it stays at its edge.
  drag(free_place(), {3000.0, 0.0});
  EXPECT_TRUE(is_in_grid(document_.bone()->ct.geometry, state_.crosshair_mm()));
}

TEST_F(SliceInputTest, AWheelStepIsOneSliceOfTheCt) {
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

TEST_F(SliceInputTest, DraggingTheTargetMovesItInThePlaneAsOneStepBack) {
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

TEST_F(SliceInputTest, DraggingTheEntryKeepsItOnTheBonesSurface) {
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

TEST_F(SliceInputTest, AClickOnAHandleMovesNothing) {
  open(SliceKind::axial);
  const Vec3 before_mm = state_.crosshair_mm();
  drag(view_->place_of(path().entry_mm), {1.0, 1.0});
  EXPECT_EQ(document_.undo_stack().count(), 0);
  EXPECT_EQ(state_.crosshair_mm(), before_mm);
}

TEST_F(SliceInputTest, EscapeGivesUpADrag) {
  open(SliceKind::axial);
  document_.move_end(0, PathEnd::target, path().target_mm + Vec3(0.0, 0.0, 1.0));
  document_.undo_stack().undo();
  const DrillPath before = path();
  press(view_->place_of(before.entry_mm));
  mouse(QEvent::MouseMove, view_->place_of(before.entry_mm) + QPointF(20.0, 10.0));
  EXPECT_NE(path().entry_mm, before.entry_mm);
  key(Qt::Key_Escape);
  EXPECT_EQ(path().entry_mm, before.entry_mm);
  EXPECT_FALSE(document_.undo_stack().canUndo());
  mouse(QEvent::MouseMove, {300.0, 300.0});
  EXPECT_EQ(path().entry_mm, before.entry_mm);
  EXPECT_TRUE(document_.undo_stack().canRedo());
  document_.undo_stack().redo();
  EXPECT_EQ(path().target_mm, Vec3(before.target_mm + Vec3(0.0, 0.0, 1.0)));
}

TEST_F(SliceInputTest, AClickOnAnotherPathChoosesIt) {
  open(SliceKind::axial);
  const DrillPath other = document_.paths()[1];
  drag(view_->place_of(0.5 * (other.entry_mm + other.target_mm)), {});
  EXPECT_EQ(document_.chosen(), 1);
  drag(view_->place_of(path().target_mm), {30.0, 0.0});
  EXPECT_EQ(document_.chosen(), 0);
  EXPECT_EQ(document_.undo_stack().count(), 0);  // the press chose; a path moves only once it is chosen
}

TEST_F(SliceInputTest, KeysNudgeTheEndsInTheSlice) {
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

TEST_F(SliceInputTest, ARightDragChangesTheWindow) {
  open(SliceKind::axial);
  state_.set_window({1000.0, 200.0});
  drag({100.0, 300.0}, {350.0, -45.0}, Qt::RightButton);
  EXPECT_NEAR(state_.window().width_hu, 1000.0 * std::sqrt(2.0), 1e-6);  // half a pane's width
  EXPECT_NEAR(state_.window().level_hu, 200.0 + 0.1 * 1000.0, 1e-6);     // a tenth of its height
}

TEST_F(SliceInputTest, ZoomsAboutThePointerPansAndFits) {
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

TEST_F(SliceInputTest, TellsWhatLiesUnderThePointer) {
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

TEST_F(SliceInputTest, StepsDownThePathFromBeforeTheEntryToBeyondTheTarget) {
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

TEST_F(SliceInputTest, DragsTheTargetAcrossThePath) {
  open(SliceKind::down_path);
  const DrillPath before = path();
  state_.set_crosshair(before.target_mm);
  const SliceFrame frame = view_->frame();
  drag(view_->place_of(before.target_mm), {30.0, 20.0});
  const Vec3 expected_mm = before.target_mm + frame.pixel_mm * (30.0 * frame.right + 20.0 * frame.down);
  EXPECT_LT((path().target_mm - expected_mm).norm(), kRounding);
  EXPECT_TRUE(view_->frame().into().isApprox(path().direction(), 1e-9));  // looks down the new path
}

TEST_F(SliceInputTest, LivesThroughPathsThatGoAwayInADrag) {
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
