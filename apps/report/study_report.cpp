#include "apps/report/study_report.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "apps/report/study_plots.h"
#include "apps/report/text.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

std::string percent(double probability) { return readable_number(100.0 * probability, 1); }

std::string with_interval(const StudyShare& share) {
  return percent(share.probability()) + " (" + percent(share.interval.low) + " to " + percent(share.interval.high) +
         ")";
}

std::vector<ReportRow> shares_of(const StudySummary& summary) {
  std::vector<ReportRow> rows{{"Runs", std::to_string(summary.runs), ""},
                              {"Breach of any wall", with_interval(summary.breach), "%"},
                              {"Breach of the outer surface", with_interval(summary.outer), "%"},
                              {"Breach of the canal", with_interval(summary.canal), "%"}};
  for (std::size_t n = 0; n < summary.grades.size(); ++n) {
    rows.push_back({std::string("Grade ") + static_cast<char>('A' + n), with_interval(summary.grades[n]), "%"});
  }
  rows.push_back({"Bit met bone", with_interval(summary.contact), "%"});
  rows.push_back({"Tip left the bone at the far side", with_interval(summary.breakthrough), "%"});
  rows.push_back({"Asked to stop", with_interval(summary.stopped), "%"});
  return rows;
}

std::vector<ReportRow> spread_rows(const StudySpread& spread) {
  const auto number = [](double value) { return readable_number(value, 2); };
  const StudyTitle title = title_of(spread.column);
  std::string name = title.name;
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return {{name + ", median", number(spread.quantiles[3]), title.unit},
          {"5 % to 95 %", number(spread.quantiles[1]) + " to " + number(spread.quantiles[5]), title.unit},
          {"least to greatest", number(spread.quantiles[0]) + " to " + number(spread.quantiles[6]), title.unit}};
}

bool differs(const StudySummary& summary, StudyFactor factor) {
  return std::any_of(summary.factors.begin(), summary.factors.end(),
                     [&](const StudySummary::ByFactor& by) { return by.factor == factor; });
}

void add_scatters(const StudyReportData& data, HtmlReport& report) {
  constexpr std::size_t kMostDots = 4000;
  std::vector<ReportDrawing> drawings;
  for (const auto& [across, up] : {std::pair{StudyFactor::entry_left_mm, StudyFactor::entry_head_mm},
                                   std::pair{StudyFactor::angle_left_deg, StudyFactor::angle_head_deg}}) {
    if (!differs(data.summary, across) || !differs(data.summary, up)) continue;
    drawings.push_back({svg_plot(scatter(data.rows, across, up, kMostDots)),
                        data.rows.size() > kMostDots ? "The first " + std::to_string(kMostDots) + " runs." : ""});
  }
  if (!drawings.empty()) report.add_svgs(drawings);
}

}  // namespace

std::string study_report(const StudyReportData& data) {
  if (data.rows.empty()) fail("study report: expected one run or more, found none");
  const StudySummary& summary = data.summary;
  HtmlReport report(data.title);
  report.add_note("Research and training software, not a medical device: a person must judge what it says.");
  if (summary.left_volume.count > 0) {
    report.add_note(
        std::to_string(summary.left_volume.count) +
        " runs cut beyond the cylinder of points: their forces miss bone. Give \"volume\" a larger radius.");
  }
  report.add_heading("What was studied");
  report.add_table(data.inputs);
  report.add_heading("How likely");
  report.add_text(
      "Shares of the runs, in brackets their 95 % intervals after Wilson (1927). A breach is any way of the bit's "
      "surface beyond a wall of the bone; the hole's mouth does not count. Grades after Gertzbein & Robbins, by the "
      "deeper breach.");
  report.add_table(shares_of(summary));
  if (!summary.factors.empty()) report.add_heading("Breach over each factor");
  for (const StudySummary::ByFactor& by : summary.factors) report.add_svg(svg_plot(breach_plot(by)));
  add_scatters(data, report);
  report.add_heading("Forces, overshoot, clearance");
  std::vector<ReportRow> rows;
  for (const StudySpread& spread : summary.spreads) {
    if (spread.runs == 0) continue;
    const std::vector<ReportRow> more = spread_rows(spread);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  report.add_table(rows);
  for (const StudyColumn column : {StudyColumn::most_thrust_n, StudyColumn::most_torque_n_mm, StudyColumn::overshoot_mm,
                                   StudyColumn::least_outer_mm, StudyColumn::least_canal_mm}) {
    const auto has = [&](const StudyRow& row) { return std::isfinite(row[column]); };
    if (std::any_of(data.rows.begin(), data.rows.end(), has)) report.add_svg(svg_plot(histogram(data.rows, column)));
  }
  return report.html();
}

}  // namespace spinaltap
