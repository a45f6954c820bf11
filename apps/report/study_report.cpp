#include "apps/report/study_report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "apps/report/study_map_drawing.h"
#include "apps/report/study_plots.h"
#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/files/study_summary_json.h"

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
  rows.push_back({"Gave up short of the target", with_interval(summary.gave_up), "%"});
  return rows;
}

std::vector<ReportRow> spread_rows(const StudySpread& spread) {
  const auto number = [](double value) { return readable_number(value, 2); };
  const StudyTitle title = title_of(spread.column);
  const std::string name = upper_case(title.name.substr(0, 1)) + title.name.substr(1);
  return {{name + ", median", number(spread.quantiles[3]), title.unit},
          {"5 % to 95 %", number(spread.quantiles[1]) + " to " + number(spread.quantiles[5]), title.unit},
          {"min to max", number(spread.quantiles[0]) + " to " + number(spread.quantiles[6]), title.unit}};
}

/// One row for each group of screws.
void add_screws(const std::vector<StudyScrews>& screws, HtmlReport& report) {
  if (screws.empty()) return;
  report.add_heading("Screws");
  report.add_text(
      "The planned screw where it would lie, by its deepest breach (Gertzbein & Robbins), % of the runs. In brackets "
      "the 95 % interval for patients like these: runs of one patient resemble each other. With one patient it says "
      "nothing of others.");
  std::vector<std::vector<std::string>> rows;
  for (const StudyScrews& one : screws) {
    std::vector<std::string> row{one.what, std::to_string(one.runs), std::to_string(one.patients)};
    for (const StudyShare& grade : one.grades) row.push_back(percent(grade.probability()));
    row.push_back(with_interval(one.acceptable));
    row.push_back(with_interval(one.canal));
    row.push_back(percent(one.anterior.probability()));
    row.push_back(one.neighbour.runs > 0 ? percent(one.neighbour.probability()) : "n/a");
    rows.push_back(std::move(row));
  }
  report.add_table({"of", "runs", "patients", "A", "B", "C", "D", "E", "A or B", "canal", "anterior", "other vertebra"},
                   rows);
}

void add_tolerances(const std::vector<StudyTolerance>& tolerances, HtmlReport& report) {
  if (tolerances.empty()) return;
  report.add_heading("How small errors must be for 95 % grade A");
  std::vector<ReportRow> rows;
  for (const StudyTolerance& tolerance : tolerances) {
    const std::string name = name_of(tolerance);
    rows.push_back({upper_case(name.substr(0, 1)) + name.substr(1) + ", up to", words_of(tolerance), ""});
  }
  report.add_table(rows);
  for (const StudyTolerance& tolerance : tolerances) report.add_svg(svg_plot(tolerance_plot(tolerance)));
}

void add_sensitivities(const StudySummary& summary, HtmlReport& report) {
  if (summary.sensitivities.empty()) return;
  report.add_heading("Which error is to blame");
  report.add_text(
      "Sobol's indices: the share of a result's variance that an input explains alone, and the share that would be "
      "left if all but it were known. In brackets their 95 % intervals. \"direction\" is what of the direction's error "
      "does "
      "not go with the entry's.");
  for (const StudySensitivity& one : summary.sensitivities) {
    std::vector<std::vector<std::string>> rows;
    const auto text = [](double share, const Interval& interval) {
      return readable_number(share, 2) + " (" + readable_number(interval.low, 2) + " to " +
             readable_number(interval.high, 2) + ")";
    };
    for (std::size_t n = 0; n < summary.inputs.size(); ++n) {
      const SobolIndex& index = one.indices.groups.at(n);
      rows.push_back({summary.inputs[n], text(index.first_order, index.first_order_interval),
                      text(index.total, index.total_interval)});
    }
    report.add_table({one.result, "alone", "with others"}, rows);
  }
}

/// Of all, and of each level where the entry lies.
void add_maps(const std::vector<StudyMap>& maps, HtmlReport& report) {
  if (maps.empty()) return;
  std::vector<ReportDrawing> drawings;
  for (const StudyMap& map : maps) {
    const bool is_of_level = level_from_name(map.what).has_value();
    if (map.what == "all" || (is_of_level && map.off == OffPlan::entry)) drawings.push_back({study_map_svg(map), ""});
  }
  report.add_heading("Breach over where screws lie");
  report.add_text(
      "All else of the errors being as it comes. Within the darkest squares 95 % of the screws stay in the bone. "
      "breach_map.csv has the numbers and their intervals, also by side, and for breaches of 2 mm and more.");
  report.add_svgs(drawings);
}

bool differs(const StudySummary& summary, StudyFactor factor) {
  return std::any_of(summary.factors.begin(), summary.factors.end(),
                     [&](const StudySummary::ByFactor& by) { return by.factor == factor; });
}

void add_scatters(const StudyReportData& data, HtmlReport& report) {
  constexpr std::size_t kMaxDots = 4000;
  std::vector<ReportDrawing> drawings;
  for (const auto& [across, up] : {std::pair{StudyFactor::entry_left_mm, StudyFactor::entry_head_mm},
                                   std::pair{StudyFactor::angle_left_deg, StudyFactor::angle_head_deg}}) {
    if (!differs(data.summary, across) || !differs(data.summary, up)) continue;
    drawings.push_back({svg_plot(scatter(data.rows, across, up, kMaxDots)),
                        data.rows.size() > kMaxDots ? "The first " + std::to_string(kMaxDots) + " runs." : ""});
  }
  if (!drawings.empty()) report.add_svgs(drawings);
}

std::string text_of(double number) {
  std::string text;
  append_number(number, text);
  return text;
}

ReportRow row_of(const FactorDistribution& distribution) {
  const StudyTitle title = title_of(distribution.factor);
  const std::string name = upper_case(title.name.substr(0, 1)) + title.name.substr(1);
  switch (distribution.kind) {
    case FactorDistribution::Kind::normal:
      return {name, "normal, mean " + text_of(distribution.a) + ", deviation " + text_of(distribution.b), title.unit};
    case FactorDistribution::Kind::uniform:
      return {name, "even, " + text_of(distribution.a) + " to " + text_of(distribution.b), title.unit};
    case FactorDistribution::Kind::spread:
      return {name,
              "as sources differ: median " + text_of(distribution.a) + ", scale of the logarithm " +
                  text_of(distribution.b) + ", " + std::to_string(distribution.degrees) + " degrees of freedom",
              title.unit};
    case FactorDistribution::Kind::levels:
      break;
  }
  std::string levels;
  for (const double level : distribution.levels) levels += (levels.empty() ? "" : ", ") + text_of(level);
  return {name, levels, title.unit};
}

void add_drilling(const IdentifiedStudy& study, std::vector<ReportRow>& rows) {
  const SessionSetup& setup = study.setup;
  const StudyOperator& tool_operator = study.tool_operator;
  const auto add = [&](const std::string& name, const std::string& value, const std::string& unit) {
    rows.push_back({name, value, unit});
  };
  add("Bit, diameter × length", text_of(setup.path.bit.diameter_mm) + " × " + text_of(setup.path.bit.length_mm), "mm");
  add("Spindle", text_of(setup.options.spindle.rpm), "rpm");
  if (tool_operator.kind == StudyOperator::Kind::feed) {
    add("Operator",
        "feeds at " + text_of(tool_operator.feed_mm_s) + " mm/s in steps of " + text_of(tool_operator.step_mm) + " mm",
        "");
  } else {
    add("Operator",
        "pushes with " + text_of(tool_operator.push_n) + " N, " + text_of(tool_operator.rate_hz) + " cycles a second",
        "");
  }
  if (tool_operator.tremor_mm > 0.0) add("Tremor", text_of(tool_operator.tremor_mm), "mm");
  const StopRules& stop = setup.options.stop;
  if (std::isfinite(stop.thrust_n)) add("Asked to stop at a thrust of", text_of(stop.thrust_n), "N");
  if (std::isfinite(stop.clearance_mm)) add("Asked to stop at a clearance of", text_of(stop.clearance_mm), "mm");
  if (stop.on_breach) add("Asked to stop", "on a breach", "");
  if (const std::optional<HeatOptions>& heat = setup.options.heat) {
    add("Temperature of the bone, so far from the hole", text_of(heat->distance_mm), "mm");
    if (heat->is_irrigated) add("The hole's wall", "cooled by water", "");
  }
  const bool has_voxels = setup.engine == EngineKind::voxel;
  add(has_voxels ? "Voxels" : "Points, spacing", text_of(setup.volume.spacing_mm), "mm");
  add(has_voxels ? "Voxels, radius of the cylinder whose box they fill" : "Points, radius of the cylinder",
      readable_number(setup.volume.radius_mm, 2), "mm");
}

void write_runs(const StudyRows& rows, const std::filesystem::path& file, StagedOutput& output) {
  std::string csv = study_csv_head() + "\n";
  std::size_t size = csv.size();
  for (const auto& [run, text] : rows) size += text.size() + 1;
  csv.reserve(size);
  for (const auto& [run, text] : rows) csv.append(study_csv_for_others(text)).append(1, '\n');
  output.write(file, csv);
}

}  // namespace

std::string study_report(const StudyReportData& data) {
  if (data.rows.empty()) fail("study report: expected one run or more, found none");
  const StudySummary& summary = data.summary;
  HtmlReport report(data.title);
  report.add_note("Research and training software, not a medical device: a person must judge what it says.");
  if (summary.outside_volume.count > 0) {
    report.add_note(
        std::to_string(summary.outside_volume.count) +
        " runs cut beyond the cylinder of points: their forces miss bone. Give \"volume\" a larger radius.");
  }
  report.add_heading("What was studied");
  report.add_table(data.inputs);
  add_screws(summary.screws, report);
  add_maps(summary.maps, report);
  add_tolerances(summary.tolerances, report);
  add_sensitivities(summary, report);
  if (summary.has_drilled) {
    report.add_heading("The bit: how likely");
    report.add_text(
        "Shares of the runs, in brackets their 95 % intervals after Wilson (1927). A breach is any way of the bit's "
        "surface beyond a wall of the bone; the entry opening does not count. Grades after Gertzbein & Robbins, by the "
        "deeper breach.");
    report.add_table(shares_of(summary));
  }
  if (!summary.factors.empty()) report.add_heading("Breach over each factor");
  for (const StudySummary::ByFactor& by : summary.factors) report.add_svg(svg_plot(breach_plot(by)));
  add_scatters(data, report);
  report.add_heading(summary.has_drilled ? "Forces, plunge depth, clearance, errors" : "Errors");
  std::vector<ReportRow> rows;
  for (const StudySpread& spread : summary.spreads) {
    if (spread.runs == 0) continue;
    const std::vector<ReportRow> more = spread_rows(spread);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  report.add_table(rows);
  for (const StudyColumn column :
       {StudyColumn::max_thrust_n, StudyColumn::max_torque_n_mm, StudyColumn::plunge_depth_mm,
        StudyColumn::min_clearance_outer_mm, StudyColumn::min_clearance_canal_mm, StudyColumn::screw_pullout_n,
        StudyColumn::max_temperature_c, StudyColumn::off_entry_mm, StudyColumn::off_target_mm,
        StudyColumn::off_angle_deg, StudyColumn::screw_breach_mm}) {
    const auto has = [&](const StudyRow& row) { return std::isfinite(row[column]); };
    if (std::any_of(data.rows.begin(), data.rows.end(), has)) report.add_svg(svg_plot(histogram(data.rows, column)));
  }
  return report.html();
}

StudyInputs study_inputs(const StudyIdentity& identity, const std::filesystem::path& file) {
  const IdentifiedStudy study = study_of(identity, file);
  const SessionSetup& setup = study.setup;
  StudyInputs inputs{study.name, study.design, study.ground(), {}};
  const auto add = [&](const std::string& name, const std::string& value, const std::string& unit) {
    inputs.rows.push_back({name, value, unit});
  };
  std::set<std::size_t> patients;
  std::size_t screws = 0;
  for (const StudyBone& bone : study.bones) {
    patients.insert(bone.patient);
    screws += bone.paths.size();
  }
  if (screws > 1) {
    add("Patients", std::to_string(patients.size()), "");
    add("Bones", std::to_string(study.bones.size()), "");
    add("Screws", std::to_string(screws), "");
  } else {
    if (!setup.path.name.empty()) add("Path", setup.path.name, "");
    add("Length, entry to target", readable_number(setup.path.length_mm(), 1), "mm");
    if (setup.path.screw) {
      add("Screw, diameter × length",
          text_of(setup.path.screw->diameter_mm) + " × " + text_of(setup.path.screw->length_mm), "mm");
    }
  }
  if (study.errors) add("Errors of placement", study.errors->title, "");
  if (study.registration) add("Registration, drawn for each", std::string(name_of(*study.registration)), "");
  if (study.kind == StudyKind::drilling) add_drilling(study, inputs.rows);
  for (const FactorDistribution& distribution : inputs.design.distributions)
    inputs.rows.push_back(row_of(distribution));
  add("Runs", std::to_string(identity.runs), "");
  add("Sampling", std::string(name_of(inputs.design.sampling)), "");
  add("Seed", std::to_string(inputs.design.seed), "");
  for (std::size_t n = 0; study.bones.size() < 20 && n < study.bones.size(); ++n) {
    add("Bone, fingerprint", study.bones[n].hash, "");
  }
  add("Study, fingerprint", identity.hash(), "");
  return inputs;
}

StudySummary write_study_results(const std::filesystem::path& folder, const StudyIdentity& identity,
                                 const StudyRows& rows) {
  if (rows.size() != identity.runs) {
    std::size_t missing = 0;
    while (rows.contains(missing)) ++missing;
    fail("expected all ", identity.runs, " runs of the study, found ", rows.size(), "; run ", missing,
         " is the first that is missing: let every shard finish, and name all their folders");
  }
  StagedOutput output;
  write_runs(rows, folder / "runs.csv", output);
  StudyReportData report;
  report.rows.reserve(rows.size());
  for (const auto& [run, text] : rows) report.rows.push_back(read_study_csv(text));
  const StudyInputs inputs = study_inputs(identity, folder / "study.json");
  report.title = inputs.title;
  report.inputs = inputs.rows;
  report.summary = summarise_study(report.rows, StudyRuns(inputs.design, inputs.ground));
  output.write(folder / "summary.json", to_json(report.summary).dump(2) + "\n");
  output.write(folder / "breach_map.csv", study_map_csv(report.summary.maps));
  output.write(folder / "report.html", study_report(report));
  output.commit();
  return std::move(report.summary);
}

}  // namespace spinaltap
