#include "apps/report/grade_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/report/fixation_report.h"
#include "apps/report/grade_sheet.h"
#include "apps/report/html_report.h"
#include "apps/report/text.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kGradePlotHeight = 260.0;
constexpr const char* kOuterColour = "#0072B2";
constexpr const char* kCanalPlotColour = "#B0307A";

Plot empty_plot(const GradedPath& graded, const std::string& title, const std::string& y_label,
                const std::string& y_unit) {
  Plot plot;
  plot.title = title;
  plot.x_label = "depth along the path";
  plot.x_unit = "mm";
  plot.y_label = y_label;
  plot.y_unit = y_unit;
  plot.x_low = 0.0;
  plot.x_high = graded.path.length_mm();
  plot.y_from_zero = true;
  plot.height = kGradePlotHeight;
  return plot;
}

template <class Value>
Plot plot_of(const GradedPath& graded, const std::string& title, const std::string& y_label, const std::string& y_unit,
             const Value& value) {
  Plot plot = empty_plot(graded, title, y_label, y_unit);
  PlotSeries series{y_label, {}, {}};
  for (const GradeRow& row : graded.grade.rows) {
    series.x.push_back(row.depth_mm);
    series.y.push_back(value(row));
  }
  plot.series = {series};
  return plot;
}

std::string place_of(const Approach& approach) {
  return std::string(name_of(approach.side)) + ", at " + readable_number(approach.depth_mm, 1) + " mm of depth";
}

std::vector<ReportRow> figures_of(const GradedPath& graded, const std::vector<double>& hu_bands) {
  const PathGrade& grade = graded.grade;
  std::vector<ReportRow> rows{{"Tool", tool_of(graded.path), ""},
                              {"Length, entry to target", readable_number(graded.path.length_mm(), 1), "mm"},
                              {"Pedicle", grade.is_left ? "left" : "right", ""},
                              {"Gertzbein-Robbins", meaning_of(grade), ""},
                              {"Breach", readable_number(grade.breach_mm, 2), "mm"}};
  if (grade.breach_mm > 0.0) {
    rows.push_back({"Breach into", breach_of(grade), ""});
    rows.push_back({"Breach at a depth of", readable_number(grade.breach_depth_mm, 1), "mm"});
  }
  const auto add = [&](const std::string& name, const Approach& approach) {
    if (!std::isfinite(approach.clearance_mm)) return;
    rows.push_back({name + ", min clearance", readable_number(approach.clearance_mm, 2), "mm"});
    rows.push_back({name + ", nearest", place_of(approach), ""});
  };
  add("Outer surface", grade.outer);
  add("Canal", grade.canal);
  if (std::isfinite(grade.hu)) rows.push_back({"Bone in the tool's volume, mean", readable_number(grade.hu, 0), "HU"});
  const std::vector<std::string> names = band_names(hu_bands);
  for (std::size_t n = 0; n < names.size() && n < grade.hu_band_shares.size(); ++n) {
    rows.push_back({"Share " + names[n], readable_number(100.0 * grade.hu_band_shares[n], 1), "%"});
  }
  rows.push_back({"Max predicted thrust", readable_number(grade.max_thrust_n, 1), "N"});
  rows.push_back({"Max predicted thrust, 5 to 95 % of sources", interval_text(grade.max_thrust_band_n, 1), "N"});
  if (grade.fixation) {
    for (const ReportRow& row : fixation_rows(*grade.fixation)) rows.push_back(row);
  }
  if (graded.safe && !(grade.breach_mm > 0.0)) {  // else there is nothing left to err by
    const SafeZone& safe = *graded.safe;
    const auto add_error = [&](const std::string& to, double mm, double degrees) {
      rows.push_back({"May be off " + to + " until it breaches",
                      readable_number(mm, 1) + " mm or " + readable_number(degrees, 1) + "°", ""});
    };
    add_error("medially", safe.medial_mm, safe.medial_deg);
    add_error("laterally", safe.lateral_mm, safe.lateral_deg);
    add_error("cranially", safe.cranial_mm, safe.cranial_deg);
    add_error("caudally", safe.caudal_mm, safe.caudal_deg);
  }
  return rows;
}

std::vector<ReportRow> figures_of(const Landmarks& landmarks) {
  const auto size = [](const std::string& name, double width_mm, double height_mm) {
    return ReportRow{name, readable_number(width_mm, 1) + " × " + readable_number(height_mm, 1), "mm"};
  };
  const Landmarks::Body& body = landmarks.body;
  return {size("Left pedicle, width × height", landmarks.left_pedicle.width_mm, landmarks.left_pedicle.height_mm),
          size("Right pedicle, width × height", landmarks.right_pedicle.width_mm, landmarks.right_pedicle.height_mm),
          size("Canal, width × depth", landmarks.canal.width_mm, landmarks.canal.depth_mm),
          size("Body, width × depth", body.width_mm, body.depth_mm),
          {"Body, height", readable_number(body.height_mm, 1), "mm"}};
}

}  // namespace

std::string meaning_of(Grade grade) {
  switch (grade) {
    case Grade::A:
      return "A: no breach";
    case Grade::B:
      return "B: breach below 2 mm";
    case Grade::C:
      return "C: breach of 2 to below 4 mm";
    case Grade::D:
      return "D: breach of 4 to below 6 mm";
    case Grade::E:
      break;
  }
  return "E: breach of 6 mm or more";
}

std::string meaning_of(const PathGrade& grade) { return meaning_of(grade.grade) + grade_in_words(grade).substr(1); }

Plot clearance_plot(const GradedPath& graded) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Plot plot = empty_plot(graded, "Clearance", "clearance", "mm");
  PlotSeries outer{"outer surface", {}, {}};
  PlotSeries canal{"canal", {}, {}};
  PlotSeries entry_opening{"entry", {}, {}};
  outer.colour = kOuterColour;
  canal.colour = kCanalPlotColour;
  entry_opening.colour = "#7a858e";
  entry_opening.dashed = true;
  double lowest = 0.0;
  for (const GradeRow& row : graded.grade.rows) {
    for (PlotSeries* series : {&outer, &canal, &entry_opening}) series->x.push_back(row.depth_mm);
    outer.y.push_back(row.is_entry ? kNone : row.outer_mm);
    entry_opening.y.push_back(row.is_entry ? row.outer_mm : kNone);
    canal.y.push_back(row.canal_mm);
    if (!row.is_entry) lowest = std::fmin(lowest, std::fmin(row.outer_mm, row.canal_mm));
  }
  plot.series = {outer, canal, entry_opening};
  plot.names_at_curves = true;
  // Where decisions lie; a breach is shown whole, up to what makes the worst grade.
  plot.y_low = lowest < 0.0 ? std::max(-6.0, std::floor(lowest)) : -1.0;
  plot.y_high = 5.0;
  plot.zones = {{-100.0, 0.0, "breach", "#c62828"}};
  const auto mark = [&](const Approach& approach, const std::string& wall) {
    if (!std::isfinite(approach.clearance_mm)) return;
    plot.markers.push_back(
        {approach.depth_mm, wall + " " + readable_number(approach.clearance_mm, 2) + " mm, " + name_of(approach.side)});
  };
  mark(graded.grade.outer, "outer");
  mark(graded.grade.canal, "canal");
  return plot;
}

Plot hu_plot(const GradedPath& graded) {
  return plot_of(graded, "Bone in the tool's section", "mean CT number", "HU",
                 [](const GradeRow& row) { return row.hu; });
}

Plot bands_plot(const GradedPath& graded, const std::vector<double>& hu_bands) {
  Plot plot = empty_plot(graded, "Bone by CT number in the tool's section", "share", "%");
  const std::vector<std::string> names = band_names(hu_bands);
  for (std::size_t band = 0; band < names.size(); ++band) {
    PlotSeries series{names[band], {}, {}};
    for (const GradeRow& row : graded.grade.rows) {
      series.x.push_back(row.depth_mm);
      series.y.push_back(100.0 * row.hu_band_shares.at(band));
    }
    plot.series.push_back(series);
  }
  plot.names_at_curves = true;
  return plot;
}

Plot predicted_thrust_plot(const GradedPath& graded) {
  Plot plot = plot_of(graded, "Predicted thrust", "thrust", "N", [](const GradeRow& row) { return row.thrust_n; });
  PlotBand band{"5 to 95 % of sources", {}, {}, {}};
  for (const GradeRow& row : graded.grade.rows) {
    band.x.push_back(row.depth_mm);
    band.low.push_back(row.thrust_band_n.low);
    band.high.push_back(row.thrust_band_n.high);
  }
  plot.bands = {band};
  return plot;
}

std::string grade_report(const GradeReportData& data, const Progress& progress) {
  if (data.paths.empty() && data.missing.empty()) fail("grade report: expected one path or more, found none");
  if (!data.missing.empty() && data.landmarks == nullptr) {
    fail("grade report: expected landmarks of a vertebra with a pedicle without a path, found none");
  }
  HtmlReport report(data.title);
  report.add_made(data.date, data.command);
  for (const ReportSheet& sheet : grade_sheets(data, progress)) report.add_sheet(sheet);
  if (data.landmarks != nullptr) {
    report.add_heading("The vertebra");
    report.add_table(figures_of(*data.landmarks));
  }
  report.add_text(
      "Clearance is from the tool's surface to the wall; below 0 the tool is through it. The breach is how far the "
      "tool stands out of the bone. The outer surface that is pierced on purpose at the entry does not count.");
  for (std::size_t n = 0; n < data.paths.size(); ++n) {
    const GradedPath& graded = data.paths[n];
    report.add_heading("All figures: " + (graded.path.name.empty() ? std::string("path") : graded.path.name));
    report.add_table(figures_of(graded, data.hu_bands));
    if (graded.placed) report.add_text("Grades to expect: " + probabilities_in_words(*graded.placed) + ".");
    if (graded.surface) report.add_text("Surface " + surface_in_words(graded) + ".");
    for (const Finding& finding : graded.grade.findings) {
      if (finding.is_warning) {
        report.add_note(finding.words + ".");
      } else {
        report.add_text(finding.words + ".");
      }
    }
    for (const std::string& reason : n < data.reasons.size() ? data.reasons[n] : std::vector<std::string>()) {
      report.add_text("Why this path: " + reason + ".");
    }
    for (const Plot& plot : {hu_plot(graded), bands_plot(graded, data.hu_bands), predicted_thrust_plot(graded)}) {
      report.add_svg(svg_plot(plot));
    }
    if (graded.grade.fixation) report.add_svg(svg_plot(insertion_torque_plot(*graded.grade.fixation)));
  }
  return report.html();
}

}  // namespace spinaltap
