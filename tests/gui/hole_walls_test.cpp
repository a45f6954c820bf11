#include "apps/spinaltap-planner/slices/hole_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "tests/gui/drilled_phantom.h"
#include "tests/gui/slice_pane.h"

namespace spinaltap {
namespace {

using test::DrilledPhantom;

/// The plane across a path, its origin on the axis.
SliceFrame across(const DrillPath& path, double depth_mm) {
  SliceFrame frame;
  frame.right = path.direction().cross(Vec3::UnitZ()).normalized();
  frame.down = path.direction().cross(frame.right);
  frame.origin_mm = path.entry_mm + depth_mm * path.direction();
  frame.pixel_mm = 0.1;
  return frame;
}

TEST(HoleWalls, AcrossThePathAreClosedAndLieOnTheBitsCircle) {
  DrilledPhantom phantom;
  HoleWalls walls;
  walls.update(phantom.drill());
  const SliceFrame frame = across(phantom.path, 25.0);  // in the body: bone all around
  const auto pieces = walls.section(frame);
  std::map<std::pair<long, long>, int> ends;
  double length_mm = 0.0;
  for (const auto& piece : pieces) {
    length_mm += frame.pixel_mm * (piece[1] - piece[0]).norm();
    for (const Eigen::Vector2d& end : piece) {
      EXPECT_NEAR(frame.pixel_mm * end.norm(), 0.5 * phantom.path.bit.diameter_mm, 0.06);
      ++ends[{std::lround(1e3 * end.x()), std::lround(1e3 * end.y())}];
    }
  }
  for (const auto& [end, times] : ends) EXPECT_EQ(times % 2, 0) << end.first << ", " << end.second;
  EXPECT_NEAR(length_mm, std::numbers::pi * phantom.path.bit.diameter_mm, 0.2);
}

TEST(HoleWalls, EndWithTheHoleAndGoWithItsUndoing) {
  DrilledPhantom phantom;
  HoleWalls walls;
  EXPECT_TRUE(walls.section(across(phantom.path, 25.0)).empty());
  walls.update(phantom.drill());
  EXPECT_FALSE(walls.section(across(phantom.path, 25.0)).empty());
  EXPECT_TRUE(walls.section(across(phantom.path, phantom.path.length_mm() + 1.0)).empty());
  EXPECT_TRUE(walls.section(across(phantom.path, -5.0)).empty());  // before the bone
  HoleWalls opened;
  for (const auto& block : phantom.surface.blocks()) opened.update(std::array{SurfaceUpdate{block->block, block}});
  EXPECT_EQ(opened.section(across(phantom.path, 25.0)).size(), walls.section(across(phantom.path, 25.0)).size());
  phantom.remaining.undo();
  walls.update(phantom.surface.update());
  EXPECT_TRUE(walls.section(across(phantom.path, 25.0)).empty());
}

TEST_F(SlicePane, ShowsTheWallsOfAHole) {
  open(SliceKind::axial);  // the phantom's paths are axial
  view_->zoom(4.0, view_->place_of(middle_mm()));
  const Vec3 out = path().direction().cross(Vec3::UnitZ());
  // How green a place's surroundings are at most: the screw and bits are not.
  const auto greenness = [&](const Vec3& p_mm) {
    const QImage image = picture();
    const QPoint at = view_->place_of(p_mm).toPoint();
    int max = 0;
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        const QRgb pixel = image.pixel(at + QPoint(x, y));
        max = std::max(max, qGreen(pixel) - std::max(qRed(pixel), qBlue(pixel)));
      }
    }
    return max;
  };
  const Vec3 wall_mm = middle_mm() + 0.5 * path().bit.diameter_mm * out + 4.0 * path().direction();
  EXPECT_LT(greenness(wall_mm), 20);
  DrilledPhantom phantom;
  view_->update_surface(phantom.drill());
  EXPECT_GT(greenness(wall_mm), 40);
  document_.set_bone(test::phantom_bone());
  document_.set_paths(test::phantom_paths());
  EXPECT_LT(greenness(wall_mm), 20);
}

}  // namespace
}  // namespace spinaltap
