#include <gmock/gmock.h>

#include <limits>

#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "apps/spinaltap-planner/slices/path_hits.h"

namespace spinaltap {
namespace {

constexpr double kRounding = 1e-9;  // mm or pixels, at values of some hundred

/// 20 x 30 x 40 voxels of 0.5 x 0.6 x 1.25 mm, whose slices are axial.
GridGeometry axial_grid() {
  GridGeometry grid;
  grid.size = {20, 30, 40};
  grid.spacing_mm = {0.5, 0.6, 1.25};
  grid.origin_mm = {-4.0, 7.0, -300.0};
  return grid;
}

/// Two paths side by side along the patient's y.
std::vector<DrillPath> two_paths() {
  return {{"left", {10.0, 20.0, 0.0}, {10.0, -10.0, 0.0}, {}}, {"right", {-10.0, 20.0, 3.0}, {-10.0, -10.0, 3.0}, {}}};
}

TEST(SliceGeometry, MapsPanesOfAllPlanesAndScreensThereAndBack) {
  for (const Plane plane : {Plane::kAxial, Plane::kCoronal, Plane::kSagittal}) {
    for (const double ratio : {1.0, 1.5, 2.0}) {
      const Vec3 through_mm(11.0, -22.0, 33.0);
      const PanePlane shown = standard_plane(plane, through_mm);
      const SliceFrame frame = pane_frame(shown, {{3.0, 4.0}, 0.13}, {701, 450, ratio});
      const QPointF place(123.0, 321.0);
      const Vec3 p_mm = patient_at(frame, ratio, place);
      EXPECT_NEAR((p_mm - through_mm).dot(shown.into()), 0.0, kRounding);
      const QPointF back = place_in_pane(frame, ratio, p_mm);
      EXPECT_NEAR(back.x(), place.x(), kRounding);
      EXPECT_NEAR(back.y(), place.y(), kRounding);
      // 10 logical pixels are 1.3 mm, whatever the screen.
      const Vec3 step_mm = patient_at(frame, ratio, place + QPointF(10.0, 0.0)) - p_mm;
      EXPECT_TRUE(step_mm.isApprox(1.3 * shown.right, 1e-9));
    }
  }
}

TEST(SliceGeometry, PutsTheMiddleOfTheViewInTheMiddleOfThePane) {
  const PanePlane plane = standard_plane(Plane::kCoronal, {0.0, 5.0, 0.0});
  const SliceFrame frame = pane_frame(plane, {{12.0, -7.0}, 0.2}, {300, 200, 2.0});
  EXPECT_EQ(frame.width, 600);
  EXPECT_EQ(frame.height, 400);
  // Down is towards the feet: 7 mm up from the anchor is z = 7.
  const Vec3 middle_mm = frame.to_patient(Vec3(299.5, 199.5, 0.0));
  EXPECT_TRUE(middle_mm.isApprox(Vec3(12.0, 5.0, 7.0), 1e-9));
}

TEST(SliceGeometry, FitsABoxAndFillsThePane) {
  const Box3 box(Vec3(-40.0, -30.0, -300.0), Vec3(44.0, 50.0, -260.0));
  for (const Plane plane : {Plane::kAxial, Plane::kCoronal, Plane::kSagittal}) {
    const PaneSize size{700, 450, 1.0};
    const PanePlane shown = standard_plane(plane, box.center());
    const SliceFrame frame = pane_frame(shown, fitted_view(shown, box, size), size);
    const Vec3 low = frame.to_pixel(box.min());
    const Vec3 high = frame.to_pixel(box.max());
    const double across = std::abs(high.x() - low.x()) / size.width;
    const double down = std::abs(high.y() - low.y()) / size.height;
    EXPECT_LT(std::max(across, down), 1.0);
    EXPECT_GT(std::max(across, down), 0.9);
    EXPECT_NEAR(0.5 * (low.x() + high.x()), 349.5, 1e-6);
    EXPECT_NEAR(0.5 * (low.y() + high.y()), 224.5, 1e-6);
  }
  EXPECT_EQ(fitted_view({}, Box3(), {700, 450, 1.0}).mm_per_px, PaneView{}.mm_per_px);
}

TEST(SliceGeometry, ZoomsAboutAPlaceThatKeepsItsPixel) {
  const PanePlane plane = standard_plane(Plane::kSagittal, {5.0, 0.0, 0.0});
  const PaneSize size{500, 400, 1.5};
  PaneView view{{3.0, 2.0}, 0.2};
  const QPointF place(71.0, 333.0);
  const Vec3 before_mm = patient_at(pane_frame(plane, view, size), size.ratio, place);
  for (const double factor : {1.2, 3.0, 0.1}) {
    view = zoomed_view(view, factor, in_plane(plane, before_mm));
    const Vec3 after_mm = patient_at(pane_frame(plane, view, size), size.ratio, place);
    EXPECT_LT((after_mm - before_mm).norm(), kRounding) << factor;
  }
  EXPECT_NEAR(view.mm_per_px, 0.2 / (1.2 * 3.0 * 0.1), kRounding);
  EXPECT_EQ(zoomed_view(view, 1e9, {0.0, 0.0}).mm_per_px, kFinestMmPerPx);
  EXPECT_EQ(zoomed_view(view, 1e-9, {0.0, 0.0}).mm_per_px, kCoarsestMmPerPx);
  EXPECT_EQ(zoomed_view(view, std::numeric_limits<double>::quiet_NaN(), {0.0, 0.0}).mm_per_px, view.mm_per_px);
}

TEST(SliceGeometry, StepsByTheCtsSpacingInEachDirection) {
  GridGeometry grid = axial_grid();
  EXPECT_EQ(slice_step_mm(grid, Vec3::UnitX()), 0.5);
  EXPECT_EQ(slice_step_mm(grid, -Vec3::UnitY()), 0.6);
  EXPECT_EQ(slice_step_mm(grid, Vec3::UnitZ()), 1.25);
  // A CT whose slices are sagittal: its thick direction is the patient's x.
  grid.directions.col(0) = Vec3::UnitY();
  grid.directions.col(1) = -Vec3::UnitZ();
  grid.directions.col(2) = -Vec3::UnitX();
  EXPECT_EQ(slice_step_mm(grid, Vec3::UnitX()), 1.25);
  EXPECT_EQ(slice_step_mm(grid, Vec3::UnitZ()), 0.6);
}

TEST(SliceGeometry, ClampsPlacesOutsideToWhereTheCtHasValues) {
  const GridGeometry grid = axial_grid();
  const Vec3 inside_mm(1.0, 10.0, -280.0);
  EXPECT_TRUE(is_in_grid(grid, inside_mm));
  EXPECT_EQ(clamped_to_grid(grid, inside_mm), inside_mm);
  for (const Vec3& p_mm : {Vec3(900.0, 10.0, -280.0), Vec3(0.0, -900.0, 900.0), Vec3(-1e6, 1e6, -1e6)}) {
    EXPECT_FALSE(is_in_grid(grid, p_mm));
    EXPECT_TRUE(is_in_grid(grid, clamped_to_grid(grid, p_mm)));
  }
  // The far corner's voxel.
  const Vec3 corner_mm = grid.to_patient(Vec3(19, 29, 39));
  EXPECT_LT((clamped_to_grid(grid, Vec3(1e4, 1e4, 1e4)) - corner_mm).norm(), 1e-5);
  EXPECT_FALSE(is_in_grid(grid, Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
}

TEST(SliceGeometry, DragsOfAPanesSizeDoubleTheWindowAndLiftTheLevel) {
  const HuWindow wider = dragged_window({1000.0, 300.0}, 1.0, 0.0);
  EXPECT_NEAR(wider.width_hu, 2000.0, kRounding);
  EXPECT_EQ(wider.level_hu, 300.0);
  const HuWindow higher = dragged_window({1000.0, 300.0}, -1.0, 0.5);
  EXPECT_NEAR(higher.width_hu, 500.0, kRounding);
  EXPECT_NEAR(higher.level_hu, 800.0, kRounding);
}

TEST(SliceGeometry, ScaleBarsAreRoundAndFit) {
  EXPECT_EQ(scale_bar_mm(0.2, 100.0), 20.0);
  EXPECT_EQ(scale_bar_mm(0.199, 100.0), 10.0);
  EXPECT_NEAR(scale_bar_mm(0.01, 60.0), 0.5, 1e-12);
}

TEST(SliceGeometry, FindsHandlesOnEverySliceAndTheChosenFirst) {
  const std::vector<DrillPath> paths = two_paths();
  // Far below both paths.
  const SliceFrame axial = pane_frame(standard_plane(Plane::kAxial, {0.0, 0.0, -50.0}), {}, {400, 400, 2.0});
  const QPointF entry = place_in_pane(axial, 2.0, paths[0].entry_mm);
  EXPECT_EQ(hit_path(axial, 2.0, paths, 0, entry), (PathHit{0, PathEnd::entry}));
  EXPECT_EQ(hit_path(axial, 2.0, paths, 0, entry + QPointF(8.9, 0.0)), (PathHit{0, PathEnd::entry}));
  EXPECT_EQ(hit_path(axial, 2.0, paths, 0, entry + QPointF(0.0, 9.1)), std::nullopt);
  EXPECT_EQ(hit_path(axial, 2.0, paths, 0, entry - QPointF(0.0, 40.0)), (PathHit{0, std::nullopt}));
  const QPointF other = place_in_pane(axial, 2.0, paths[1].target_mm);
  EXPECT_EQ(hit_path(axial, 2.0, paths, 0, other), (PathHit{1, PathEnd::target}));
  // From the side one lies before the other.
  const SliceFrame sagittal = pane_frame(standard_plane(Plane::kSagittal, {0.0, 0.0, 0.0}), {}, {400, 400, 1.0});
  for (const int chosen : {0, 1}) {
    const QPointF between = place_in_pane(sagittal, 1.0, Vec3(0.0, 20.0, 0.0) + Vec3(0.0, 0.0, 1.0));
    EXPECT_EQ(hit_path(sagittal, 1.0, paths, chosen, between + QPointF(0.0, -1.0)), (PathHit{chosen, PathEnd::entry}));
  }
}

TEST(SliceGeometry, DownThePathBothEndsAreAtHandByDepth) {
  const std::vector<DrillPath> paths = two_paths();
  for (const auto& [depth_mm, end] : {std::pair(2.0, PathEnd::entry), std::pair(28.0, PathEnd::target)}) {
    const SliceFrame frame = pane_frame(plane_down_path(paths[0], depth_mm), {}, {300, 300, 1.0});
    EXPECT_EQ(hit_path(frame, 1.0, paths, 0, place_in_pane(frame, 1.0, paths[0].entry_mm)), (PathHit{0, end}));
  }
}

TEST(SliceGeometry, FollowsACurvedPath) {
  std::vector<DrillPath> paths = two_paths();
  paths[0].via_mm = {{14.0, 5.0, 0.0}};
  paths[0].bit = steerable_head();
  check_path(paths[0]);
  const double middle_mm = depth_of_mm(paths[0], {14.0, 5.0, 0.0});
  EXPECT_NEAR(middle_mm, 0.5 * paths[0].length_mm(), 1e-6);
  EXPECT_LT((at_depth(paths[0], middle_mm) - Vec3(14.0, 5.0, 0.0)).norm(), 1e-6);
  EXPECT_TRUE(plane_down_path(paths[0], middle_mm).into().isApprox(-Vec3::UnitY(), 1e-6));
  EXPECT_LT(plane_down_path(paths[0], 0.0).into().dot(-Vec3::UnitY()), 0.99);
  const SliceFrame axial =
      pane_frame(standard_plane(Plane::kAxial, {10.0, 5.0, 0.0}), {{0.0, 0.0}, 0.1}, {400, 400, 1.0});
  EXPECT_EQ(hit_path(axial, 1.0, paths, 0, place_in_pane(axial, 1.0, {14.0, 5.0, 0.0})), (PathHit{0, std::nullopt}));
  EXPECT_EQ(hit_path(axial, 1.0, paths, 0, place_in_pane(axial, 1.0, {10.0, 5.0, 0.0})), std::nullopt);
}

TEST(SliceGeometry, LooksDownThePathWithTheHeadUp) {
  const DrillPath path{"p", {19.0, 36.0, 2.0}, {10.0, -5.0, -9.0}, {}};
  const PanePlane plane = plane_down_path(path, 7.0);
  EXPECT_TRUE(plane.into().isApprox(path.direction(), 1e-12));
  EXPECT_NEAR(plane.right.z(), 0.0, 1e-12);
  EXPECT_LT(plane.down.z(), 0.0);
  EXPECT_NEAR((plane.anchor_mm - path.entry_mm).norm(), 7.0, 1e-12);
  // From behind, the patient's right is on the right.
  EXPECT_LT(plane.right.x(), 0.0);
  const DrillPath upright{"up", {0.0, 0.0, 0.0}, {0.0, 0.0, 20.0}, {}};
  EXPECT_TRUE(plane_down_path(upright, 0.0).down.isApprox(Vec3::UnitY(), 1e-12));
}

TEST(SliceGeometry, DepthsEndBeforeTheEntryAndBeyondTheTarget) {
  const DrillPath path{"p", {0.0, 0.0, 0.0}, {0.0, -30.0, 0.0}, {}};
  EXPECT_EQ(shown_depth_mm(path, -99.0), -3.0);
  EXPECT_EQ(shown_depth_mm(path, 99.0), 40.0);
  EXPECT_EQ(depth_of_mm(path, {5.0, -12.0, 8.0}), 12.0);
  EXPECT_TRUE(at_depth(path, 12.0).isApprox(Vec3(0.0, -12.0, 0.0)));
}

}  // namespace
}  // namespace spinaltap
