#include "apps/report/study_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/study_map_drawing.h"
#include "apps/report/study_plots.h"
#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::Not;

const StudyDesign kBreachDesign{{{StudyFactor::entry_left_mm, FactorDistribution::Kind::normal, {}, 0.0, 1.0},
                                 {StudyFactor::entry_head_mm, FactorDistribution::Kind::normal, {}, 0.0, 1.0},
                                 {StudyFactor::bit_diameter_mm, FactorDistribution::Kind::levels, {3.0, 4.0}}},
                                100};

/// Entries beyond 1 mm to the left breach the canal, beyond 1 mm to the right the outer surface.
std::vector<StudyRow> random_rows() {
  std::vector<StudyRow> rows;
  for (std::size_t n = 0; n < 200; ++n) {
    StudyRow row;
    row[StudyColumn::run] = static_cast<double>(n);
    row[StudyFactor::entry_left_mm] = random_normal(1, n);
    row[StudyFactor::entry_head_mm] = random_normal(2, n);
    row[StudyFactor::bit_diameter_mm] = n % 2 == 0 ? 3.0 : 4.0;
    row[StudyColumn::breach_canal_mm] = std::max(0.0, row[StudyFactor::entry_left_mm] - 1.0);
    row[StudyColumn::breach_outer_mm] = std::max(0.0, -row[StudyFactor::entry_left_mm] - 1.0);
    row[StudyColumn::breach] = std::abs(row[StudyFactor::entry_left_mm]) > 1.0 ? 1.0 : 0.0;
    row[StudyColumn::grade] = row[StudyColumn::breach];
    row[StudyColumn::max_thrust_n] = 20.0 + random_normal(3, n);
    row[StudyColumn::plunge_depth_mm] = n % 3 == 0 ? random_uniform(4, n) : test::kNan;
    row[StudyColumn::min_clearance_canal_mm] = std::numeric_limits<double>::infinity();
    rows.push_back(row);
  }
  return rows;
}

StudyReportData made_data() {
  const std::vector<StudyRow> rows = random_rows();
  return {"A <study>", {{"Path", "left & right", ""}}, rows, summarise_study(rows, StudyRuns(kBreachDesign))};
}

TEST(StudyReport, ShowsWhatWasFoundAndIsTheSameEveryTime) {
  const std::string html = study_report(made_data());
  EXPECT_EQ(html, study_report(made_data()));
  EXPECT_THAT(html, HasSubstr("A &lt;study&gt;"));
  EXPECT_THAT(html, HasSubstr("left &amp; right"));
  EXPECT_THAT(html, HasSubstr("not a medical device"));
  EXPECT_THAT(html, HasSubstr("Breach of the canal"));
  EXPECT_THAT(html, HasSubstr("Breach over diameter of the bit"));
  EXPECT_THAT(html, HasSubstr("Runs by max thrust"));
  EXPECT_THAT(html, HasSubstr("Runs by plunge depth"));
  EXPECT_THAT(html, HasSubstr("Breaches by entry, error to the left"));
  EXPECT_THAT(html, Not(HasSubstr("beyond the cylinder")));
  EXPECT_THAT(html, Not(HasSubstr("Runs by min clearance to the canal")));  // there is none
  EXPECT_THAT(html, Not(HasSubstr(">nan")));
}

TEST(StudyReport, WarnsOfRunsThatLeftThePoints) {
  StudyReportData data = made_data();
  data.rows[3][StudyColumn::outside_volume_mm] = 0.4;
  data.summary = summarise_study(data.rows, StudyRuns(kBreachDesign));
  EXPECT_THAT(study_report(data), HasSubstr("1 runs cut beyond the cylinder"));
  data.rows.clear();
  EXPECT_THROW(study_report(data), Error);
}

TEST(StudyPlots, HistogramCountsEveryRunOnce) {
  const std::vector<StudyRow> rows = random_rows();
  for (const auto& [column, count] :
       {std::pair{StudyColumn::max_thrust_n, 200.0}, {StudyColumn::plunge_depth_mm, 67.0}}) {
    const Plot plot = histogram(rows, column);
    ASSERT_EQ(plot.series.size(), 1U);
    const PlotSeries& bars = plot.series[0];
    // Bars begin at each x but the first, which rises from 0, and the last two, which close the last bar.
    double sum = 0.0;
    for (std::size_t n = 1; n + 2 < bars.y.size(); ++n) sum += bars.y[n];
    EXPECT_EQ(sum, count);
    EXPECT_GE(bars.x.size(), 15U);
    EXPECT_TRUE(std::is_sorted(bars.x.begin(), bars.x.end()));
  }
  EXPECT_TRUE(histogram(rows, StudyColumn::min_clearance_canal_mm).series.empty());
}

TEST(StudyPlots, HistogramOfOneValueHasOneBar) {
  std::vector<StudyRow> rows(5);
  for (StudyRow& row : rows) row[StudyColumn::time_s] = 3.0;
  const PlotSeries bars = histogram(rows, StudyColumn::time_s).series.at(0);
  EXPECT_EQ(*std::max_element(bars.y.begin(), bars.y.end()), 5.0);
}

TEST(StudyPlots, ScatterPartsRunsByWhatTheyBreached) {
  const std::vector<StudyRow> rows = random_rows();
  const Plot plot = scatter(rows, StudyFactor::entry_left_mm, StudyFactor::entry_head_mm, 150);
  ASSERT_EQ(plot.series.size(), 3U);
  EXPECT_EQ(plot.series[0].x.size() + plot.series[1].x.size() + plot.series[2].x.size(), 150U);
  for (const double left_mm : plot.series[0].x) EXPECT_LE(std::abs(left_mm), 1.0);
  for (const double left_mm : plot.series[1].x) EXPECT_GT(left_mm, 1.0);   // canal
  for (const double left_mm : plot.series[2].x) EXPECT_LT(left_mm, -1.0);  // outer surface
}

TEST(StudyPlots, BreachOverAFactorLiesWithinItsIntervals) {
  const StudySummary summary = summarise_study(random_rows(), StudyRuns(kBreachDesign));
  const Plot plot = breach_plot(summary.factors.at(0));
  ASSERT_EQ(plot.series.size(), plot.bands.size());
  for (std::size_t curve = 0; curve < plot.series.size(); ++curve) {
    for (std::size_t n = 0; n < plot.series[curve].y.size(); ++n) {
      EXPECT_GE(plot.series[curve].y[n], plot.bands[curve].low[n]);
      EXPECT_LE(plot.series[curve].y[n], plot.bands[curve].high[n]);
    }
  }
  // Rare in the middle, certain at both ends.
  EXPECT_LT(plot.series[0].y[4], 20.0);
  EXPECT_GT(plot.series[0].y.front(), 80.0);
  EXPECT_GT(plot.series[0].y.back(), 80.0);
}

TEST(StudyReport, DrawsAMapOfBreachesAndPalesWhatFewRunsTell) {
  StudyMap map{"L3", OffPlan::entry, {}};
  map.cells.push_back({0, 0, {100, 3, {}}, {}});     // 3 %
  map.cells.push_back({1, 0, {100, 60, {}}, {}});    // 60 %
  map.cells.push_back({-2, 1, {9, 9, {}}, {}});      // of too few runs for a number
  map.cells.push_back({40, 0, {100, 100, {}}, {}});  // beyond what is drawn
  const std::string svg = study_map_svg(map);
  EXPECT_THAT(svg, HasSubstr("Breach where the entry lies, L3"));
  EXPECT_THAT(svg, HasSubstr("mm medial"));
  EXPECT_THAT(svg, HasSubstr(">3</text>"));
  EXPECT_THAT(svg, HasSubstr(">60</text>"));
  EXPECT_THAT(svg, Not(HasSubstr(">100</text>")));
  EXPECT_THAT(svg, HasSubstr("fill=\"#e8603c\" fill-opacity=\"0.35\""));
  const auto squares = [](const std::string& drawn) {
    std::size_t count = 0;
    for (auto at = drawn.find("<rect"); at != std::string::npos; at = drawn.find("<rect", at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(squares(svg), 3U + 1U + 5U) << "three squares, the frame of the plan, and five of the key";
  map.off = OffPlan::direction;
  EXPECT_THAT(study_map_svg(map), HasSubstr("degrees cranial"));
}

}  // namespace
}  // namespace spinaltap
