#include "apps/report/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/nan.h"
#include "tests/unit/apps/report/times_in.h"

namespace spinaltap {
namespace {

using test::kNan;
using test::times_in;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Data of the curve's path: the one with round caps.
std::string curve_data(const std::string& svg) {
  const std::size_t end = svg.find("\" fill=\"none\" stroke=\"#0072B2\"");
  if (end == std::string::npos) return "";
  const std::size_t start = svg.rfind("d=\"", end) + 3;
  return svg.substr(start, end - start);
}

void expect_no_bad_number(std::string svg) {
  std::transform(svg.begin(), svg.end(), svg.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(SvgPlot, BreaksTheCurveAtValuesThatAreNotFinite) {
  Plot plot;
  plot.series = {{"", {0, 1, 2, 3, 4, 5, 6}, {1, 2, kNan, 3, 4, kInfinity, 5}}};
  const std::string svg = svg_plot(plot);
  expect_no_bad_number(svg);
  EXPECT_EQ(times_in(curve_data(svg), "M"), 3U);
}

TEST(SvgPlot, BreaksTheCurveAtValuesThatALogAxisCannotShow) {
  Plot plot;
  plot.log_y = true;
  plot.series = {{"", {0, 1, 2, 3, 4}, {10, 200, 0, -5, 3000}}};
  const std::string svg = svg_plot(plot);
  expect_no_bad_number(svg);
  EXPECT_EQ(times_in(curve_data(svg), "M"), 2U);
}

TEST(SvgPlot, DrawsWithoutDataAndWithOneValue) {
  for (const bool log : {false, true}) {
    Plot plot;
    plot.log_y = log;
    EXPECT_THAT(svg_plot(plot), HasSubstr("no data"));
    plot.series = {{"all bad", {kNan, 1.0}, {1.0, kNan}}};
    expect_no_bad_number(svg_plot(plot));
    plot.series = {{"one", {2.0}, {3.0}}};
    expect_no_bad_number(svg_plot(plot));
    EXPECT_THAT(curve_data(svg_plot(plot)), HasSubstr("h0"));
    plot.series = {{"zeros", {0.0, 1.0}, {0.0, 0.0}}};
    expect_no_bad_number(svg_plot(plot));
  }
}

TEST(SvgPlot, ThinsLongCurvesButKeepsTheirPeaks) {
  Plot plot;
  plot.series = {{"", {}, {}}};
  for (int i = 0; i < 200000; ++i) {
    plot.series[0].x.push_back(i * 1e-3);
    plot.series[0].y.push_back(i == 123456 ? 100.0 : std::sin(i * 1e-2));
  }
  const std::string svg = svg_plot(plot);
  EXPECT_LT(svg.size(), 200000U);
  // The highest value reaches the frame's upper edge, 8 units from the top without a title: 100 is a tick and the axis'
  // end.
  EXPECT_THAT(curve_data(svg), HasSubstr(" 8L"));
}

TEST(SvgPlot, HoldsValuesUntilTheNextStep) {
  Plot plot;
  plot.series = {{"", {0, 1, 2}, {0, 10, 10}, true}};
  EXPECT_EQ(times_in(curve_data(svg_plot(plot)), "L"), 3U);  // over, up, over
}

TEST(SvgPlot, DrawsEveryValueOfACloudAsADot) {
  Plot plot;
  plot.series = {{"", {3.0, 1.0, 2.0, 2.0, kNan}, {1.0, 2.0, 3.0, 3.5, 4.0}, false, true}};
  const std::string data = curve_data(svg_plot(plot));
  EXPECT_EQ(times_in(data, "M"), 4U);
  EXPECT_EQ(times_in(data, "h0"), 4U);
  EXPECT_EQ(times_in(data, "L"), 0U);
}

TEST(SvgPlot, NamesAxesUnitsMarkersAndSeries) {
  Plot plot;
  plot.title = "a < b";
  plot.x_label = "depth";
  plot.x_unit = "mm";
  plot.y_label = "density";
  plot.y_unit = "HU";
  plot.series = {{"first", {0, 1}, {1, 2}}, {"second", {0, 1}, {2, 1}}};
  plot.bands = {{"range", {0, 1}, {1, 1}, {2, 2}}};
  plot.markers = {{0.5, "Entry & more"}};
  const std::string svg = svg_plot(plot);
  for (const char* text :
       {"a &lt; b", "depth (mm)", "density (HU)", ">first<", ">second<", ">range<", "Entry &amp; more"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(SvgPlot, RejectsCurvesOfUnequalLength) {
  Plot plot;
  plot.series = {{"a", {0, 1}, {1}}};
  EXPECT_THROW(svg_plot(plot), Error);
  plot.series.clear();
  plot.bands = {{"b", {0, 1}, {1, 2}, {1}}};
  EXPECT_THROW(svg_plot(plot), Error);
}

TEST(SvgPlot, DrawsWhereItsAxesSay) {
  Plot plot;
  plot.series = {{"", {0.0, 10.0}, {0.0, 100.0}}};
  const PlotAxes axes = plot_axes(plot);
  EXPECT_EQ(curve_data(svg_plot(plot)), path_data({{axes.x(0.0), axes.y(0.0)}, {axes.x(10.0), axes.y(100.0)}}));
  plot.series[0].y.pop_back();
  EXPECT_THROW(plot_axes(plot), Error);
}

TEST(SvgPlot, LabelsANarrowAxisLessOften) {
  Plot plot;
  plot.series = {{"", {0.0, 11.0}, {0.0, 1.0}}};
  const std::size_t wide = times_in(svg_plot(plot), "text-anchor=\"middle\"");
  plot.width = 360.0;
  EXPECT_LT(times_in(svg_plot(plot), "text-anchor=\"middle\""), wide);
}

}  // namespace
}  // namespace spinaltap
