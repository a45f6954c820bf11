#include "apps/spinaltap-planner/slices/slice_view.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "tests/gui/slice_pane.h"

namespace spinaltap {
namespace {

using SliceViewTest = SlicePane;

TEST_F(SliceViewTest, ShowsTheCtsGreyUnderEachPixel) {
  document_.set_paths({});
  state_.set_window({1200.0, 300.0});
  for (const SliceKind kind : {SliceKind::axial, SliceKind::coronal, SliceKind::sagittal}) {
    const SliceView& view = open(kind);
    const QPointF cross = view.place_of(state_.crosshair_mm());
    const QImage image = picture();
    int seen = 0;
    for (int y = 60; y < 390; y += 7) {
      for (int x = 60; x < 640; x += 7) {
        if (std::abs(x - cross.x()) < 5 || std::abs(y - cross.y()) < 5) continue;
        const double hu = sample_hu(document_.bone()->ct, view.position_at(QPointF(x, y)));
        const double grey = std::clamp(255.0 * (hu - (300.0 - 600.0)) / 1200.0, 0.0, 255.0);
        // Rounding; and a place on the very edge of the CT may count as outside.
        if (std::abs(qRed(image.pixel(x, y)) - grey) > 0.5 + 1e-6) {
          ADD_FAILURE() << static_cast<int>(kind) << " at " << x << ", " << y << ": " << qRed(image.pixel(x, y))
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
    const double width_px = blue_width_px(picture(), *view_, middle_mm(), across);
    // Its outline is 1.5 pixels wide, and pixels are whole ones.
    EXPECT_NEAR(width_px, diameter_mm / view_->frame().pixel_mm + 1.5, 1.6) << diameter_mm;
  }
}

TEST_F(SliceViewTest, DrawsAScrewsHeadBehindIt) {
  open(SliceKind::axial);
  DrillPath changed = path();
  changed.screw = PedicleScrew{"6.5 x 45", 6.5, 45.0, 4.0};
  changed.screw->head.diameter_mm = 0.0;
  document_.change_path(0, changed, "screw");
  const QImage headless = picture();
  changed.screw->head.diameter_mm = 13.0;
  document_.change_path(0, changed, "screw");
  const QImage whole = picture();
  // On the tulip's side, beyond bit and thread, its outline is drawn: 10 mm behind its underside.
  const Vec3 across = path().direction().cross(Vec3::UnitZ());
  const Vec3 middle = path().target_mm - 55.0 * path().direction();
  int changed_px = 0;
  for (double off_mm = 5.5; off_mm <= 7.5; off_mm += 0.05) {
    const QPoint at = view_->place_of(middle + off_mm * across).toPoint();
    changed_px += whole.pixel(at) != headless.pixel(at) ? 1 : 0;
  }
  EXPECT_GT(changed_px, 4);
  const QPoint beyond = view_->place_of(middle + 10.0 * across).toPoint();
  EXPECT_EQ(whole.pixel(beyond), headless.pixel(beyond));
}

TEST_F(SliceViewTest, DrawsTheDrillingBitInPlaceOfThePaths) {
  open(SliceKind::axial);
  view_->zoom(4.0, view_->place_of(middle_mm()));
  const QImage planned = picture();
  view_->set_bit(std::pair(path().bit, Pose{path().entry_mm, path().direction()}));
  EXPECT_NE(picture(), planned);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  view_->set_bit(std::pair(path().bit, Pose{Vec3::Constant(nan), path().direction()}));
  EXPECT_EQ(picture(), planned);
  view_->set_bit(std::pair(DrillBit{-1.0}, Pose{path().entry_mm, path().direction()}));
  EXPECT_EQ(picture(), planned);
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
    const QImage empty = picture_of(view);
    EXPECT_GT(empty.width(), 0);
    view.step(3);
    view.zoom(2.0, {10.0, 10.0});
    view.fit();
    view.set_bit(std::pair(DrillBit{}, Pose{}));
    EXPECT_EQ(picture_of(view), empty);
    document.set_bone(test::phantom_bone());
    EXPECT_NE(picture_of(view), empty);
    document.set_bone(nullptr);
    EXPECT_EQ(picture_of(view), empty) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace spinaltap
