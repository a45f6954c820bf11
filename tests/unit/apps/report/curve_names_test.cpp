#include "apps/report/curve_names.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/svg_plot.h"

namespace spinaltap {
namespace {

using Rectangle = Eigen::AlignedBox2d;

bool covers(const Rectangle& a, const Rectangle& b) {
  return (a.min().array() < b.max().array()).all() && (b.min().array() < a.max().array()).all();
}

std::vector<NamedCurve> waves() {
  std::vector<NamedCurve> curves;
  for (int n = 0; n < 3; ++n) {
    PlotRun run;
    for (int i = 0; i <= 100; ++i) run.emplace_back(4.0 * i, 60.0 + 40.0 * n + 15.0 * std::sin(0.1 * i * (n + 1)));
    curves.push_back({n == 0 ? "outer surface" : n == 1 ? "canal" : "entry opening", {run}});
  }
  return curves;
}

TEST(CurveNames, StandBesideTheirOwnCurveAndLieOnNothing) {
  const std::vector<NamedCurve> curves = waves();
  const Rectangle room(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(400.0, 200.0));
  const Rectangle taken(Eigen::Vector2d(300.0, 0.0), Eigen::Vector2d(400.0, 80.0));
  const std::vector<Rectangle> places = place_curve_names(curves, room, 13.0, {taken});
  ASSERT_EQ(places.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    ASSERT_FALSE(places[n].isEmpty());
    EXPECT_TRUE(room.contains(places[n]));
    EXPECT_FALSE(covers(places[n], taken));
    std::array<double, 3> nearest{1e9, 1e9, 1e9};
    for (std::size_t other = 0; other < 3; ++other) {
      EXPECT_TRUE(other == n || !covers(places[n], places[other]));
      for (const Eigen::Vector2d& p : curves[other].runs[0]) {
        EXPECT_FALSE(places[n].contains(p)) << curves[n].name << " on " << curves[other].name;
        nearest[other] = std::min(nearest[other], places[n].exteriorDistance(p));
      }
    }
    EXPECT_EQ(std::min_element(nearest.begin(), nearest.end()) - nearest.begin(), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(CurveNames, NeverCoverEachOtherWhereThereIsNoRoomBesideTheCurves) {
  std::vector<NamedCurve> curves;
  for (int n = 0; n < 5; ++n) {
    PlotRun run;
    for (int i = 0; i <= 60; ++i) run.emplace_back(2.0 * i, 5.0 + 50.0 * ((i + n) % 2));  // back and forth
    curves.push_back({"a name", {run}});
  }
  const std::vector<Rectangle> places =
      place_curve_names(curves, Rectangle(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(120.0, 60.0)), 13.0);
  for (std::size_t a = 0; a < places.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (places[a].isEmpty() || places[b].isEmpty()) continue;
      EXPECT_FALSE(covers(places[a], places[b]));
    }
  }
}

TEST(CurvesCutToHeights, LeaveAndComeBackWhereTheyCrossTheHeight) {
  const std::vector<PlotRun> parts =
      cut_to_heights({{{0.0, 10.0}, {10.0, -10.0}, {20.0, 10.0}, {30.0, 50.0}}}, 0.0, 30.0);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0], (PlotRun{{0.0, 10.0}, {5.0, 0.0}}));
  EXPECT_EQ(parts[1], (PlotRun{{15.0, 0.0}, {20.0, 10.0}, {25.0, 30.0}}));
  EXPECT_TRUE(cut_to_heights({{{0.0, -1.0}, {5.0, -2.0}}}, 0.0, 30.0).empty());
  // Over the whole height within one segment.
  EXPECT_EQ(cut_to_heights({{{0.0, -10.0}, {10.0, 40.0}}}, 0.0, 30.0),
            (std::vector<PlotRun>{{{2.0, 0.0}, {8.0, 30.0}}}));
}

TEST(LineLabels, StandAtTheirLinesAndCoverNeitherLabelsNorLines) {
  std::vector<LineLabel> labels;
  for (const double x : {10.0, 30.0, 32.0, 90.0, 95.0, 96.0, 180.0, 195.0}) labels.push_back({x, 60.0});
  constexpr double kEnd = 200.0, kGap = 4.0;
  lay_out_line_labels(labels, kEnd, kGap);
  const auto low = [](const LineLabel& one) { return one.is_left ? one.x - kGap - one.width : one.x + kGap; };
  for (const LineLabel& a : labels) {
    EXPECT_GE(low(a), 0.0);
    EXPECT_LE(low(a) + a.width, kEnd);
    for (const LineLabel& b : labels) {
      if (&a == &b) continue;
      const bool apart = low(a) + a.width <= low(b) || low(b) + b.width <= low(a);
      EXPECT_TRUE(a.row != b.row || apart) << a.x << " on " << b.x;
      const bool crosses = b.row > a.row && b.x > low(a) && b.x < low(a) + a.width;
      EXPECT_FALSE(crosses) << "the line at " << b.x << " through the label at " << a.x;
    }
  }
}

TEST(SvgPlot, EndsItsAxisWhereItIsToldAndNamesZonesAndCurves) {
  Plot plot;
  plot.series = {{"outer", {0.0, 10.0, 20.0}, {12.0, 2.0, -1.0}}, {"canal", {0.0, 20.0}, {3.0, 4.0}}};
  plot.names_at_curves = true;
  plot.y_low = -2.0;
  plot.y_high = 5.0;
  plot.zones = {{-100.0, 0.0, "breach", "#c62828"}};
  const PlotAxes axes = plot_axes(plot);
  EXPECT_EQ(axes.y.low, -2.0);
  EXPECT_EQ(axes.y.high, 5.0);
  const std::string svg = svg_plot(plot);
  // The outer curve comes in at the top where it is 5 mm: after 7 of 10 mm.
  EXPECT_NE(
      svg.find(path_data({{axes.x(7.0), axes.y(5.0)}, {axes.x(10.0), axes.y(2.0)}, {axes.x(20.0), axes.y(-1.0)}})),
      std::string::npos);
  for (const char* name : {">breach<", ">outer<", ">canal<"}) EXPECT_NE(svg.find(name), std::string::npos) << name;
  EXPECT_EQ(svg.find(">10<"), svg.rfind(">10<")) << "of x alone: no tick beyond the y axis";
}

}  // namespace
}  // namespace spinaltap
