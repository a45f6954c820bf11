#include "apps/report/grade_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/report/fixation_report.h"
#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "core/base/text_writer.h"
#include "core/grading/path_doubt.h"

namespace spinaltap {
namespace {

/// A field of a CSV file: in quotes where it needs them.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

Json json_of(const Approach& approach) {
  if (!std::isfinite(approach.clearance_mm)) return nullptr;
  return {{"clearance_mm", approach.clearance_mm}, {"depth_mm", approach.depth_mm}, {"side", name_of(approach.side)}};
}

Json json_of(const Finding& finding, const DrillPath& path) {
  return {{"part", name_of(finding.part, path)},
          {"structure", name_of(finding.structure)},
          {"is_warning", finding.is_warning},
          {"depth_mm", finding.depth_mm},
          {"at_mm", finding.at_mm},
          {"place_mm", to_json(finding.place_mm)},
          {"words", finding.words}};
}

Json json_of(const PathDoubt& doubt) {
  const bool is_unsure = doubt.kind == PathDoubt::Kind::unsure_bone;
  return {{"kind", is_unsure ? "unsure_bone" : "made_up_slices"},
          {"length_mm", doubt.length_mm},
          {"depth_mm", doubt.depth_mm},
          {"place_mm", to_json(doubt.place_mm)},
          {"clearance_without_mm", is_unsure ? Json(doubt.without_mm) : Json(nullptr)},
          {"words", in_words(doubt)}};
}

Json json_of(const NeighbourContact& contact, const DrillPath& path) {
  Json json{{"depth_mm", contact.depth_mm}};
  if (!(contact.depth_mm > 0.0)) return json;
  json.update(Json{{"level", level_name(contact.level)},
                   {"part", name_of(contact.part, path)},
                   {"at_mm", contact.at_mm},
                   {"place_mm", to_json(contact.place_mm)}});
  return json;
}

/// "pullout_n", "p05_pullout_n" and "p95_pullout_n".
void add_banded(Json& json, const std::string& name, const FixationFigure& figure) {
  json[name] = figure.median;
  json["p05_" + name] = figure.p05;
  json["p95_" + name] = figure.p95;
}

Json json_of(const ScrewFixation& fixation, bool with_rows) {
  Json json = Json::object();
  add_banded(json, "pullout_n", fixation.pullout_n);
  add_banded(json, "stiffness_n_mm", fixation.stiffness_n_mm);
  add_banded(json, "max_torque_n_mm", fixation.max_torque_n_mm);
  json["cortical_share"] = fixation.cortical_share;
  json["engaged_mm"] = fixation.engaged_mm;
  if (!with_rows) return json;
  json["rows"] = Json::array();
  for (const FixationRow& row : fixation.rows) {
    json["rows"].push_back(
        {{"depth_mm", row.depth_mm}, {"torque_n_mm", row.torque_n_mm}, {"shear_mpa", row.shear_mpa}});
  }
  return json;
}

Json json_of(const InstrumentContacts& instrument) {
  return {{"head_clearance_mm", number_or_null(instrument.head_clearance_mm)},
          {"driver_clearance_mm", number_or_null(instrument.driver_clearance_mm)},
          {"cut_behind_mm", instrument.cut_behind_mm},
          {"joint_depth_mm", instrument.joint_depth_mm},
          {"is_beside_joint", instrument.is_beside_joint}};
}

constexpr std::array kPathSides{PathSide::medial, PathSide::lateral, PathSide::cranial, PathSide::caudal,
                                PathSide::anterior};

Json json_of(const Interval& interval) { return {interval.low, interval.high}; }

Json json_of(const Probability& probability) {
  return {{"share", probability.share}, {"interval_95", json_of(probability.interval)}};
}

Json json_of(const CrossErrors& errors) {
  return {{"medial", {{"mean", errors.medial_bias}, {"sd", errors.medial}}},
          {"cranial", {{"mean", errors.cranial_bias}, {"sd", errors.cranial}}},
          {"shape", errors.shape}};
}

Json json_of(const PlacementErrors& errors) {
  return {{"name", errors.name},
          {"title", errors.title},
          {"entry_mm", json_of(errors.entry_mm)},
          {"direction_deg", json_of(errors.direction_deg)},
          {"along_mm", {{"mean", errors.along_bias_mm}, {"sd", errors.along_mm}}},
          {"correlation", errors.correlation},
          {"sources", errors.sources}};
}

Json json_of(const AddedRegistration& added) {
  return {{"file", added.name},
          {"error_at_entry_mm", added.entry_mm},
          {"error_at_target_mm", added.target_mm},
          {"warnings", added.warnings}};
}

Json json_of(const BreachLattice& lattice) { return {{"errors", lattice.errors}, {"breach_mm", lattice.breach_mm}}; }

Json json_of(const PlacedGrade& placed, bool with_map) {
  Json grades = Json::object();
  for (std::size_t n = 0; n < placed.probabilities.grades.size(); ++n) {
    grades[std::string(1, letter_of(static_cast<Grade>(n)))] = json_of(placed.probabilities.grades[n]);
  }
  Json json{{"errors", json_of(placed.errors)},
            {"registration", placed.registration ? json_of(*placed.registration) : Json(nullptr)},
            {"draws", placed.probabilities.draws},
            {"seed", placed.probabilities.seed},
            {"grades", grades},
            {"a_or_b", json_of(placed.probabilities.acceptable)},
            {"canal_breach", json_of(placed.probabilities.canal)},
            {"mean_breach_mm", placed.probabilities.mean_breach_mm},
            {"p95_breach_mm", placed.probabilities.p95_breach_mm}};
  if (with_map) {
    json["map"] = {{"entry_shift_mm", json_of(placed.map.shift_mm)}, {"turn_deg", json_of(placed.map.turn_deg)}};
  }
  return json;
}

/// Where the clearance to one of a grade's walls lies: by the CT, and where bone may be another's, without that.
Interval band_of(const CtSurfaceError& surface, const PathGrade& grade, const Approach& wall) {
  Interval band = surface.band(wall.clearance_mm, wall.normal);
  if (&wall != &grade.outer) return band;
  for (const PathDoubt& doubt : grade.doubts) {
    if (doubt.kind == PathDoubt::Kind::unsure_bone) band.low = std::min(band.low, doubt.without_mm);
  }
  return band;
}

/// The wall above which least is left for sure; the nearer one where the surface is known alike at both.
struct LeastSure {
  const Approach* wall;
  Interval band;
};

LeastSure least_sure(const CtSurfaceError& surface, const PathGrade& grade) {
  const Interval outer = band_of(surface, grade, grade.outer), canal = band_of(surface, grade, grade.canal);
  return canal.low < outer.low ? LeastSure{&grade.canal, canal} : LeastSure{&grade.outer, outer};
}

Json json_of(const CtSurfaceError& surface, const PathGrade& grade) {
  Json json{{"standard_error_mm", surface.standard_error_mm()},
            {"ct_noise_hu", surface.noise_hu},
            {"ct_voxel_mm", to_json(surface.sampling.voxel_mm)},
            {"ct_slice_thickness_mm", surface.sampling.slice_thickness_mm},
            {"edge_hu_per_mm", surface.edge_hu_per_mm},
            {"noise_part_mm", surface.noise_part_mm},
            {"sampling_part_mm", surface.sampling_part_mm},
            {"curved_part_mm", surface.curved_part_mm}};
  for (const auto& [name, approach] :
       {std::pair{"outer_band_95_mm", &grade.outer}, std::pair{"canal_band_95_mm", &grade.canal}}) {
    const Interval band = band_of(surface, grade, *approach);
    json[name] = std::isfinite(approach->clearance_mm) ? json_of(band) : Json(nullptr);
  }
  return json;
}

/// Whole percents from 10 on, else with one digit.
std::string percents(double share) { return readable_number(100.0 * share, share < 0.1 ? 1 : 0); }

std::vector<std::string> cells_of(const Approach& approach) {
  if (!std::isfinite(approach.clearance_mm)) return {"none", "", ""};
  return {readable_number(approach.clearance_mm, 2), readable_number(approach.depth_mm, 1), name_of(approach.side)};
}

}  // namespace

std::string tool_of(const DrillPath& path) {
  if (!path.screw) return "bit of " + short_text(path.bit.diameter_mm) + " mm";
  return "screw " + short_text(path.screw->diameter_mm) + " x " + short_text(path.screw->length_mm) + " mm";
}

std::string breach_of(const PathGrade& grade) {
  if (!(grade.breach_mm > 0.0)) return "";
  return std::string(grade.breaches_canal ? "canal, " : "outer surface, ") + name_of(grade.breach_side);
}

std::vector<std::string> band_names(const std::vector<double>& hu_bands) {
  if (hu_bands.empty()) return {"all HU"};
  std::vector<std::string> names{"below " + short_text(hu_bands.front()) + " HU"};
  for (std::size_t n = 1; n < hu_bands.size(); ++n) {
    names.push_back(short_text(hu_bands[n - 1]) + " to " + short_text(hu_bands[n]) + " HU");
  }
  names.push_back(short_text(hu_bands.back()) + " HU and above");
  return names;
}

std::string probability_in_words(const Probability& probability) {
  return percents(probability.share) + " % (" + percents(probability.interval.low) + " to " +
         percents(probability.interval.high) + ")";
}

std::string probabilities_in_words(const PlacedGrade& placed) {
  constexpr double kSmallest = 1e-3;
  std::string words;
  for (std::size_t n = 0; n < placed.probabilities.grades.size(); ++n) {
    if (n > 0 && placed.probabilities.grades[n].share < kSmallest) continue;
    words += (words.empty() ? "" : ", ") + std::string(1, letter_of(static_cast<Grade>(n))) + " " +
             probability_in_words(placed.probabilities.grades[n]);
  }
  return words + "; breach into the canal " + probability_in_words(placed.probabilities.canal) + "; by " +
         errors_in_words(placed) + ", " + std::to_string(placed.probabilities.draws) + " draws";
}

std::string errors_in_words(const PlacedGrade& placed) {
  if (!placed.registration) return placed.errors.name;
  const AddedRegistration& added = *placed.registration;
  return placed.errors.name + " and " + added.name + " (" + readable_number(added.entry_mm, 2) + " mm at the entry, " +
         readable_number(added.target_mm, 2) + " mm at the target)";
}

bool hides_breach(const GradedPath& graded) {
  if (!graded.surface || graded.grade.breach_mm > 0.0) return false;
  return least_sure(*graded.surface, graded.grade).band.low < 0.0;
}

std::string surface_in_words(const GradedPath& graded) {
  const CtSurfaceError& surface = *graded.surface;
  const auto [wall, band] = least_sure(surface, graded.grade);
  std::string words = "found to " + readable_number(surface.standard_error_mm(), 2) + " mm (standard error)";
  if (!std::isfinite(wall->clearance_mm)) return words;
  const double there_mm = surface.standard_error_mm(wall->normal);
  if (readable_number(there_mm, 2) != readable_number(surface.standard_error_mm(), 2)) {
    words += ", to " + readable_number(there_mm, 2) + " mm where it is nearest";
  }
  return words + ": clearance to the " + (wall == &graded.grade.canal ? "canal " : "outer surface ") +
         readable_number(wall->clearance_mm, 2) + " mm is " + readable_number(band.low, 2) + " to " +
         readable_number(band.high, 2) + " mm" + (hides_breach(graded) ? ": a breach may hide in the CT's error" : "");
}

Json uncertainty_json(const GradedPath& graded, bool with_map) {
  Json json = Json::object();
  if (graded.placed) json["placement"] = json_of(*graded.placed, with_map);
  if (graded.surface) json["surface"] = json_of(*graded.surface, graded.grade);
  return json;
}

Json to_json(const GradedPath& graded, const std::vector<double>& hu_bands, bool with_rows) {
  const PathGrade& grade = graded.grade;
  Json json{{"name", graded.path.name},
            {"tool", tool_of(graded.path)},
            {"entry_mm", to_json(graded.path.entry_mm)},
            {"target_mm", to_json(graded.path.target_mm)},
            {"pedicle", grade.is_left ? "left" : "right"},
            {"grade", std::string(1, letter_of(grade.grade))},
            {"breach_mm", grade.breach_mm}};
  if (graded.path.is_curved()) {
    json["via_mm"] = Json::array();
    for (const Vec3& via_mm : graded.path.via_mm) json["via_mm"].push_back(to_json(via_mm));
  }
  if (grade.breach_mm > 0.0) {
    json["breach"] = {{"into", grade.breaches_canal ? "canal" : "outer surface"},
                      {"depth_mm", grade.breach_depth_mm},
                      {"side", name_of(grade.breach_side)}};
  } else {
    json["breach"] = nullptr;
  }
  json["rampersaud"] = std::string(1, grade.rampersaud);
  json["heary"] = name_of(grade.heary);
  json["facet_babu"] = grade.facet;
  json["side_breach_mm"] = Json::object();
  for (const PathSide side : kPathSides) {
    json["side_breach_mm"][name_of(side)] = grade.side_breach_mm.at(static_cast<std::size_t>(side));
  }
  json["doubts"] = Json::array();
  for (const PathDoubt& doubt : grade.doubts) json["doubts"].push_back(json_of(doubt));
  json["findings"] = Json::array();
  for (const Finding& finding : grade.findings) json["findings"].push_back(json_of(finding, graded.path));
  json["neighbour"] = grade.neighbour ? json_of(*grade.neighbour, graded.path) : Json(nullptr);
  json["instrument"] = json_of(grade.instrument);
  json["opening_end_mm"] = grade.opening_end_mm;
  json["bearing_mm"] = number_or_null(grade.bearing_mm);
  json["entry_slant_deg"] = number_or_null(grade.entry_slant_deg);
  json["outer"] = json_of(grade.outer);
  json["canal"] = json_of(grade.canal);
  json["entry_end_mm"] = grade.entry_end_mm;
  json["mean_hu"] = number_or_null(grade.hu);
  json["hu_bands"] = Json::array();
  const std::vector<std::string> names = band_names(hu_bands);
  for (std::size_t n = 0; n < names.size(); ++n) {
    json["hu_bands"].push_back({{"band", names[n]}, {"share", grade.hu_band_shares.at(n)}});
  }
  json["max_thrust_n"] = grade.max_thrust_n;
  json["fixation"] = grade.fixation ? json_of(*grade.fixation, with_rows) : Json(nullptr);
  json["p05_thrust_n"] = grade.max_thrust_band_n.low;
  json["p95_thrust_n"] = grade.max_thrust_band_n.high;
  json.update(uncertainty_json(graded, with_rows));
  if (!with_rows) return json;
  json["rows"] = Json::array();
  for (const GradeRow& row : grade.rows) {
    json["rows"].push_back({{"depth_mm", row.depth_mm},
                            {"radius_mm", row.radius_mm},
                            {"clearance_outer_mm", number_or_null(row.outer_mm)},
                            {"outer_side", name_of(row.outer_side)},
                            {"clearance_canal_mm", number_or_null(row.canal_mm)},
                            {"canal_side", name_of(row.canal_side)},
                            {"is_opening", row.is_opening},
                            {"is_entry", row.is_entry},
                            {"hu", number_or_null(row.hu)},
                            {"hu_band_shares", row.hu_band_shares},
                            {"thrust_n", row.thrust_n},
                            {"p05_thrust_n", row.thrust_band_n.low},
                            {"p95_thrust_n", row.thrust_band_n.high}});
  }
  return json;
}

std::string grades_csv(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands) {
  TextWriter csv(7);
  csv << "path,depth_mm,radius_mm,clearance_outer_mm,outer_side,clearance_canal_mm,canal_side,is_opening,is_entry,hu,"
         "thrust_n,p05_thrust_n,p95_thrust_n";
  for (std::string name : band_names(hu_bands)) {
    std::replace(name.begin(), name.end(), ' ', '_');
    csv << ",share_" << name;
  }
  csv << '\n';
  const auto number = [&](double value) {
    if (std::isfinite(value)) csv << value;  // empty where it is none, as append_csv_number() has it
  };
  const auto field = [&](double value) {
    number(value);
    csv << ',';
  };
  for (const GradedPath& graded : paths) {
    for (const GradeRow& row : graded.grade.rows) {
      csv << csv_field(graded.path.name) << ',';
      field(row.depth_mm);
      field(row.radius_mm);
      field(row.outer_mm);
      csv << name_of(row.outer_side) << ',';
      field(row.canal_mm);
      csv << name_of(row.canal_side) << ',' << (row.is_opening ? 1 : 0) << ',' << (row.is_entry ? 1 : 0) << ',';
      field(row.hu);
      field(row.thrust_n);
      field(row.thrust_band_n.low);
      number(row.thrust_band_n.high);
      for (const double share : row.hu_band_shares) {
        csv << ',';
        number(share);
      }
      csv << '\n';
    }
  }
  return csv.str();
}

namespace {

/// How the paths' screws hold, a line each; empty where none has one.
std::string fixation_table(const std::vector<GradedPath>& paths) {
  TextTable table({{"path", "", false},
                   {"pull-out (5 to 95 %)", "N"},
                   {"of it by cortex", "%"},
                   {"stiffness, at most", "N/mm"},
                   {"max insertion torque (5 to 95 %)", "N·mm"},
                   {"thread in bone", "mm"}});
  bool has_screw = false;
  for (const GradedPath& graded : paths) {
    if (!graded.grade.fixation) continue;
    const ScrewFixation& fixation = *graded.grade.fixation;
    has_screw = true;
    table.add_row({graded.path.name, banded_text(fixation.pullout_n),
                   readable_number(100.0 * fixation.cortical_share, 0), banded_text(fixation.stiffness_n_mm),
                   banded_text(fixation.max_torque_n_mm), readable_number(fixation.engaged_mm, 1)});
  }
  return has_screw ? "\n" + table.aligned() : std::string();
}

}  // namespace

std::string grades_table(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands) {
  TextTable walls({{"path", "", false},
                   {"tool", "", false},
                   {"grade", "", false},
                   {"breach", "mm"},
                   {"into", "", false},
                   {"outer", "mm"},
                   {"at depth", "mm"},
                   {"side", "", false},
                   {"canal", "mm"},
                   {"at depth", "mm"},
                   {"side", "", false}});
  std::vector<TextTable::Column> columns{{"path", "", false}, {"mean", "HU"}};
  for (const std::string& name : band_names(hu_bands)) columns.push_back({name, "%"});
  columns.push_back({"max thrust", "N"});
  columns.push_back({"5 to 95 %", "N"});
  TextTable bone(columns);
  TextTable scales({{"path", "", false},
                    {"Gertzbein-Robbins", "", false},
                    {"Rampersaud", "", false},
                    {"Heary", "", false},
                    {"facet (Babu)", ""},
                    {"bone to head", "mm"},
                    {"to driver", "mm"},
                    {"cut behind entry", "mm"},
                    {"entry slants", "°"}});
  std::string findings;
  for (const GradedPath& graded : paths) {
    const PathGrade& grade = graded.grade;
    const std::string letter = std::string(1, letter_of(grade.grade)) + (grade.doubts.empty() ? "" : ", but");
    std::vector<std::string> cells{graded.path.name, tool_of(graded.path), letter, readable_number(grade.breach_mm, 2),
                                   breach_of(grade)};
    for (const Approach& approach : {grade.outer, grade.canal}) {
      for (const std::string& cell : cells_of(approach)) cells.push_back(cell);
    }
    walls.add_row(cells);
    cells = {graded.path.name, readable_number(grade.hu, 0)};
    for (const double share : grade.hu_band_shares) cells.push_back(readable_number(100.0 * share, 1));
    cells.push_back(readable_number(grade.max_thrust_n, 1));
    cells.push_back(interval_text(grade.max_thrust_band_n, 1));
    bone.add_row(cells);
    const InstrumentContacts& instrument = grade.instrument;
    scales.add_row({graded.path.name, std::string(1, letter_of(grade.grade)), std::string(1, grade.rampersaud),
                    name_of(grade.heary), std::to_string(grade.facet), readable_number(instrument.head_clearance_mm, 2),
                    readable_number(instrument.driver_clearance_mm, 2), readable_number(instrument.cut_behind_mm, 2),
                    readable_number(grade.entry_slant_deg, 0)});
    for (const Finding& finding : grade.findings) {
      findings += graded.path.name + (finding.is_warning ? ", warning: " : ": ") + finding.words + "\n";
    }
  }
  return walls.aligned() + "\n" + scales.aligned() + "\n" + bone.aligned() + fixation_table(paths) +
         (findings.empty() ? "" : "\n") + findings;
}

}  // namespace spinaltap
