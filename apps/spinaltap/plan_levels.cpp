#include "apps/spinaltap/plan_levels.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/report/text.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/path_options.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "core/files/planning_json.h"
#include "core/plan/rod.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

/// A level, its bone and what is suggested for it.
struct PlannedLevel {
  Level level;
  Bone bone;
  std::vector<Suggestion> suggestions;
};

std::vector<Level> levels_of(const PlanLevelsOptions& options) {
  std::vector<Level> there = levels_in(options.spine);
  if (options.levels.size() == 1 && options.levels.front() == "all") return there;
  std::vector<Level> wanted;
  for (const std::string& name : options.levels) {
    const std::optional<Level> level = level_from_name(name);
    if (!level || std::find(there.begin(), there.end(), *level) == there.end()) {
      fail("--levels: no ", name, " in ", options.spine.string(), "; there are: ", level_names(there));
    }
    if (std::find(wanted.begin(), wanted.end(), *level) != wanted.end()) fail("--levels: ", name, " is given twice");
    wanted.push_back(*level);
  }
  std::sort(wanted.begin(), wanted.end(), [](Level a, Level b) { return level_rank(a) < level_rank(b); });
  return wanted;
}

/// Puts the choice with which a side's heads lie in line first, and gives the rod as JSON; null for fewer than two
/// heads.
Json lay_rod(std::vector<PlannedLevel>& levels, std::size_t side) {
  std::vector<RodLevel> choices;
  std::vector<PlannedLevel*> planned;
  for (PlannedLevel& level : levels) {
    const Suggestion& suggestion = level.suggestions[side];
    if (!suggestion.best) continue;
    choices.push_back({level_name(level.level), {&*suggestion.best}});
    for (const SuggestedPath& other : suggestion.others) choices.back().choices.push_back(&other);
    planned.push_back(&level);
  }
  if (choices.size() < 2) return nullptr;
  const std::vector<std::size_t> chosen = choose_for_rod(choices);
  std::vector<RodHead> heads;
  for (std::size_t n = 0; n < planned.size(); ++n) {
    Suggestion& suggestion = planned[n]->suggestions[side];
    if (chosen[n] > 0) {
      SuggestedPath other = *choices[n].choices[chosen[n]];
      other.safe = safe_zone(planned[n]->bone.walls(), other.path);
      other.trajectories_tried = suggestion.best->trajectories_tried;
      const std::vector<std::string> why_thin = std::move(other.reasons);
      other.reasons = {"not the best alone, which is a " + suggestion.best->path.screw->name +
                       " screw: its head lies in line with its neighbours' for a rod"};
      const Landmarks& marks = planned[n]->bone.landmarks();
      const double width_mm = (side == 0 ? marks.left_pedicle : marks.right_pedicle).width_mm;
      other.reasons.push_back("fills " + readable_number(100.0 * other.path.screw->diameter_mm / width_mm, 0) +
                              " % of the pedicle's width of " + readable_number(width_mm, 1) +
                              " mm; technique: " + name_of(other.technique));
      other.reasons.insert(other.reasons.end(), why_thin.begin(), why_thin.end());
      suggestion.others[chosen[n] - 1] = std::move(*suggestion.best);
      suggestion.best = std::move(other);
    }
    heads.push_back(rod_head(suggestion.best->path, choices[n].level));
  }
  const RodFit rod = fit_rod(heads);
  Json json{{"side", side == 0 ? "left" : "right"},
            {"min_bend_radius_mm", number_or_null(rod.min_bend_radius_mm)},
            {"max_offset_mm", rod.max_offset_mm()},
            {"heads", Json::array()}};
  for (std::size_t n = 0; n < heads.size(); ++n) {
    Json head{{"level", heads[n].level},
              {"centre_mm", to_json(heads[n].centre_mm)},
              {"axis", to_json(heads[n].axis)},
              {"offset_mm", rod.offset_mm[n]}};
    if (n + 1 < heads.size()) {
      head["to_next_mm"] = rod.spacing_mm[n];
      head["to_next_deg"] = rod.angle_deg[n];
    }
    json["heads"].push_back(head);
  }
  const std::string name = json["side"].get<std::string>() + " rod";
  print_figure(name + ", furthest head off it", rod.max_offset_mm(), "mm", 1);
  if (std::isfinite(rod.min_bend_radius_mm)) print_figure(name + ", bent to", rod.min_bend_radius_mm, "mm", 0);
  return json;
}

}  // namespace

Json plan_levels(const PlanLevelsOptions& options, int& exit_code, const Progress& progress) {
  const PlacementModel model = options.placement.model();
  std::vector<PlannedLevel> levels;
  Json figures{{"levels", Json::array()}, {"rods", Json::array()}};
  const std::vector<Level> wanted = levels_of(options);
  std::vector<Bone> bones;
  bones.reserve(wanted.size());
  for (const Level level : wanted) bones.push_back(Bone::load(options.spine, level));
  const std::optional<CtVolume> ct = options.page.read(bones, progress);
  PlanFindings findings;
  for (const Bone& bone : bones) check_registration(model, bone, options.check, findings);
  findings.notes.erase(std::unique(findings.notes.begin(), findings.notes.end()), findings.notes.end());
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    const Level level = wanted[n];
    const Bone& bone = bones[n];
    if (const std::string& why = bone.no_landmarks(progress); !why.empty()) {
      print_figure(level_name(level), "left out: " + why);
      figures["levels"].push_back({{"level", level_name(level)}, {"rejection", why}});
      exit_code = kAnswerIsNo;
      continue;
    }
    levels.push_back({level, bone, bone.suggest(options.suggest, progress)});
  }
  if (levels.empty()) fail("no level to plan in ", options.spine.string());
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    if (Json rod = lay_rod(levels, side); !rod.is_null()) figures["rods"].push_back(std::move(rod));
  }
  Json rods = format_head({.name = "spinaltap-rods"});
  rods.update(Json{{"frame", "LPS"}, {"unit", "mm"}, {"rods", figures["rods"]}});
  StagedOutput output;
  output.list_in(options.folder);  // a plan of an earlier run must not stand beside new rods
  output.write(options.folder / "rods.json", rods.dump(2) + "\n");
  for (PlannedLevel& level : levels) {
    const std::string name = level_name(level.level);
    print_figure("level", name);
    std::vector<GradedPath> graded = graded_paths(level.suggestions);
    add_uncertainty(level.bone, model, graded, progress);
    Json json = report_suggestions(level.bone, level.suggestions, graded);
    json["level"] = name;
    report_bone_warnings(level.bone.model(), json);
    figures["levels"].push_back(std::move(json));
    if (graded.size() < level.suggestions.size()) exit_code = kAnswerIsNo;
    CtVolume kept;
    const std::string title = options.page.title.empty() ? name : options.page.title + ", " + name;
    GradeReportData head = report_head(title, options.page.command, level.bone, ct, kept);
    head.notes = findings.lines();
    output.write(options.folder / (name + ".html"),
                 planning_report(head, level.suggestions, graded, options.suggest.screws, progress));
    if (!graded.empty()) {
      std::vector<DrillPath> paths;
      paths.reserve(graded.size());
      for (const GradedPath& one : graded) paths.push_back(one.path);
      write_plan(paths, output.stage(options.folder / (name + ".json")));
    }
  }
  output.commit();
  figures["plan_notes"] = findings.notes;
  say_findings(findings, true);
  print_figure("written", options.folder.string());
  return figures;
}

}  // namespace spinaltap
