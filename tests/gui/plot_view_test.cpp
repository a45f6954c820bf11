#include "apps/spinaltap-planner/plots/plot_view.h"

#include <gmock/gmock.h>

#include <QImage>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

Plot thrust_plot(std::vector<double> x, std::vector<double> y) {
  Plot plot;
  plot.x_label = "depth";
  plot.x_unit = "mm";
  plot.y_label = "thrust";
  plot.y_unit = "N";
  plot.series = {{"thrust", std::move(x), std::move(y)}};
  return plot;
}

QImage picture_of(PlotView& view) {
  view.resize(360, 200);
  return view.grab().toImage();
}

bool is_curve_blue(const QColor& colour) {
  return colour.blue() > colour.red() + 90 && colour.blue() > colour.green() + 30;
}

/// Middle of the curve's pixels in a column; NaN where there is none.
double curve_row(const QImage& image, double x) {
  const int column = static_cast<int>(std::lround(x));
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < image.height(); ++row) {
    if (!is_curve_blue(image.pixelColor(column, row))) continue;
    sum += row + 0.5;
    ++count;
  }
  return count > 0 ? sum / count : std::nan("");
}

TEST(PlotView, ShowsTheCurveWhereItsValuesAre) {
  PlotView view;
  // From corner to corner: the ends are ticks, so the curve goes through the frame's corners.
  view.set_plot(thrust_plot({0.0, 10.0}, {0.0, 100.0}));
  const QImage image = picture_of(view);
  const PlotAxes axes = plot_axes(view.plot());
  for (const double share : {0.2, 0.5, 0.8}) {
    const double column = axes.x.from + share * (axes.x.to - axes.x.from);
    EXPECT_NEAR(curve_row(image, column), axes.y.from + share * (axes.y.to - axes.y.from), 1.5) << share;
  }
  EXPECT_TRUE(std::isnan(curve_row(image, axes.x.from - 20.0)));
}

TEST(PlotView, TellsTheValuesUnderThePointer) {
  PlotView view;
  view.set_plot(thrust_plot({0.0, 5.0, 10.0}, {0.0, 42.0, 100.0}));
  picture_of(view);
  const PlotAxes axes = plot_axes(view.plot());
  EXPECT_EQ(view.values_at(0.5 * (axes.x.from + axes.x.to) + 1.0), "depth 5.00 mm, thrust 42.0 N");
  EXPECT_EQ(view.values_at(axes.x.from + 0.25 * (axes.x.to - axes.x.from)), "");  // between the values
  EXPECT_EQ(view.values_at(axes.x.from - 5.0), "");
}

TEST(PlotView, IsWhiteButForAHintWhereThereIsNothing) {
  PlotView view;
  const QImage empty = picture_of(view);
  EXPECT_EQ(empty.pixelColor(2, 2), QColor(Qt::white));
  view.set_plot(thrust_plot({1.0, 2.0}, {std::nan(""), std::nan("")}));
  EXPECT_EQ(picture_of(view), empty);
  view.set_hint("Drill first");
  EXPECT_NE(picture_of(view), empty);
  EXPECT_EQ(view.values_at(180.0), "");
}

TEST(PlotView, RejectsCurvesThatDoNotFit) {
  PlotView view;
  EXPECT_THROW(view.set_plot(thrust_plot({1.0}, {1.0, 2.0})), Error);
}

TEST(PlotView, PaintsLongCurvesOftenEnough) {
  std::vector<double> x, y;
  for (int n = 0; n < 4000; ++n) {
    x.push_back(0.01 * n);
    y.push_back(20.0 + 5.0 * std::sin(0.37 * n) + 10.0 * std::sin(0.002 * n));
  }
  PlotView view;
  const std::clock_t begin = std::clock();  // of the processor: others may use the computer, too
  constexpr int kTimes = 30;
  for (int n = 0; n < kTimes; ++n) {
    view.set_plot(thrust_plot(x, y));
    picture_of(view);
  }
  const double ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kTimes;
  std::printf("a plot of 4,000 values: %.1f ms\n", ms);
  EXPECT_LT(ms, 66.0);  // 15 a second
}

}  // namespace
}  // namespace spinaltap
