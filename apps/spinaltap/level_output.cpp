#include "apps/spinaltap/level_output.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "core/base/text_writer.h"
#include "core/segment/level_names.h"

namespace spinaltap {
namespace {

std::string number(double value, int digits) { return readable_number(value, digits); }

Json level_figures_json(const LevelFigures& figures) {
  Json bridges;
  constexpr std::array<const char*, kContacts> kNames{"body_above",  "body_below",  "beside",
                                                      "upper_left",  "upper_right", "lower_left",
                                                      "lower_right", "left_rib",    "right_rib"};
  for (std::size_t n = 0; n < kContacts; ++n) bridges[kNames[n]] = figures.bridges[n].mm2;
  return {{"left_share", figures.left_share},
          {"left_pedicle_mm2", figures.left_pedicle_mm2},
          {"right_pedicle_mm2", figures.right_pedicle_mm2},
          {"canal_closed", figures.canal_closed},
          {"behind_canal_mm", figures.behind_canal_mm},
          {"left_reach_mm", figures.left_reach_mm},
          {"right_reach_mm", figures.right_reach_mm},
          {"bridges_mm2", bridges},
          {"is_cut_behind", figures.is_cut_behind},
          {"is_cut_left", figures.is_cut_left},
          {"is_cut_right", figures.is_cut_right},
          {"lopsided_mm3", figures.lopsided_mm3},
          {"unsure_share", figures.unsure_share},
          {"metal_mm3", figures.metal_mm3},
          {"cement_mm3", figures.cement_mm3}};
}

/// The two likeliest.
std::vector<LevelProbability> likeliest(std::vector<LevelProbability> probabilities) {
  probabilities.resize(std::min<std::size_t>(probabilities.size(), 2));
  return probabilities;
}

const char* name_of(NameSource source) {
  if (source == NameSource::given) return "given";
  return source == NameSource::hint ? "hint" : "counted";
}

}  // namespace

CLI::Option* add_level(CLI::App& app, Level& level) {
  return app
      .add_option_function<std::string>(
          "--level",
          [&level](const std::string& name) {
            const std::optional<Level> found = level_from_name(name);
            if (!found) throw CLI::ValidationError("--level", "expected a vertebra such as T11 or L3, found " + name);
            level = *found;
          },
          "Which bone is meant, such as L3, where the file holds several")
      ->type_name("LEVEL");
}

std::string words_of(NameSource source, std::span<const LevelPoint> given) {
  if (source == NameSource::hint) return "a hint from the sacrum, the ribs and the bodies' sizes: check it";
  if (source == NameSource::counted) return "counted from the top";
  TextWriter text;
  text << "counted from ";
  for (std::size_t n = 0; n < given.size(); ++n) {
    const Vec3& p = given[n].p_mm;
    text << (n == 0 ? "" : " and ") << level_name(given[n].level) << '=' << p.x() << ',' << p.y() << ',' << p.z();
  }
  return text.str();
}

void print_levels(std::span<const LevelReport> levels) {
  TextTable table({{"vertebra", "", false},
                   {"label", ""},
                   {"x", "mm"},
                   {"y", "mm"},
                   {"z", "mm"},
                   {"wide", "mm"},
                   {"deep", "mm"},
                   {"high", "mm"},
                   {"volume", "cm3"},
                   {"severity", ""},
                   {"is likely", "", false},
                   {"", "", false}});
  for (const LevelReport& level : levels) {
    const Vec3& at = level.body_centre_mm;
    const Vec3& size = level.body_size_mm;
    std::string note = level.is_suspect() ? "suspect" : "";
    if (level.is_cut || level.reaches_border) note += std::string(note.empty() ? "" : ", ") + "cut by the CT's border";
    table.add_row({level.name, std::to_string(level.label), number(at.x(), 1), number(at.y(), 1), number(at.z(), 1),
                   number(size.x(), 1), number(size.y(), 1), number(size.z(), 1), number(level.volume_mm3 / 1000.0, 2),
                   number(level.severity, 2), in_words(likeliest(level.name_probabilities)), note});
  }
  std::printf("  Middle (patient LPS) and size of the bodies:\n%s", table.aligned().c_str());
  for (const LevelReport& level : levels) {
    for (const LevelWarning& warning : level.warnings) {
      std::printf("  %s: %s (%s)\n", level.name.c_str(), warning.text.c_str(), fixed_text(warning.severity, 2).c_str());
    }
  }
}

void print_warnings(const LevelWarnings& warnings) {
  for (const std::string& warning : warnings.warnings) print_figure("warning", warning);
  if (warnings.severity > 0.0) print_figure("severity, 0 to 1", warnings.severity, "");
}

Json to_json(const LevelReport& level) {
  Json axes = Json::array();
  for (int axis = 0; axis < 3; ++axis) axes.push_back(to_json(Vec3(level.body_axes.col(axis))));
  Json warnings = Json::array();
  for (const LevelWarning& warning : level.warnings) {
    Json one{{"text", warning.text}, {"severity", warning.severity}, {"where_mm", nullptr}};
    if (warning.where_mm) one["where_mm"] = to_json(*warning.where_mm);
    warnings.push_back(one);
  }
  Json json{{"label", level.label}, {"name", level.name}, {"level", nullptr}};
  if (level.level != Level::kNone) json["level"] = level_name(level.level);
  json["name_probabilities"] = Json::array();
  for (const LevelProbability& one : level.name_probabilities) {
    json["name_probabilities"].push_back({{"level", level_name(one.level)}, {"probability", one.probability}});
  }
  json.update({{"name_source", name_of(level.name_source)},
               {"body_centre_mm", to_json(level.body_centre_mm)},
               {"body_size_mm", to_json(level.body_size_mm)},
               {"body_axes", axes},
               {"body_fit", level.body_fit},
               {"cut_area_mm2", level.cut_area_mm2},
               {"parts_dropped", level.parts_dropped},
               {"volume_mm3", level.volume_mm3},
               {"is_cut", level.is_cut},
               {"reaches_border", level.reaches_border},
               {"figures", level_figures_json(level.figures)},
               {"warnings", warnings},
               {"severity", level.severity},
               {"is_suspect", level.is_suspect()}});
  return json;
}

int say_suspect(std::span<const std::string> names, bool accepts_warnings) {
  if (names.empty()) return kDone;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return say_doubt("suspect", list, accepts_warnings);
}

int say_suspect(const std::string& name, const LevelWarnings& warnings, bool accepts_warnings) {
  const std::vector<std::string> names{name.empty() ? "the vertebra" : name};
  return say_suspect(warnings.is_suspect() ? std::span(names) : std::span<const std::string>(), accepts_warnings);
}

int say_gaps(std::span<const std::string> gaps, bool accepts_warnings, Json& figures) {
  report_warnings("gaps", gaps, figures);
  return gaps.empty() ? kDone : say_doubt("doubtful", "whether all vertebrae were found", accepts_warnings);
}

}  // namespace spinaltap
