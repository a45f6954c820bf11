#include "vdb/sim/auto_plan.h"

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/planning_rules_file.h"
#include "core/files/screw_file.h"

namespace spinaltap {

std::vector<Suggestion> auto_plan(const WallDistance& walls, const HuSampler& hu, const AutoPlanOptions& options,
                                  const Progress& progress) {
  SuggestOptions settings =
      read_planning_rules(options.rules.empty() ? data_file("planning/pedicle.json") : options.rules);
  if (options.margin_mm) settings.margin_mm = settings.min_margin_mm = *options.margin_mm;
  settings.is_bicortical = options.is_bicortical;
  settings.sagittal = options.sagittal;
  settings.technique = options.technique;
  settings.level = options.level;
  settings.bit = options.bit;
  const std::vector<PedicleScrew> screws =
      read_screws(options.screws.empty() ? data_file("screws/pedicle.json") : options.screws);
  const HuToDensity density =
      read_density_calibration(options.density.empty() ? data_file("densities/vertebra.json") : options.density).line;
  const Material material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density);
  return suggest_paths(walls, hu, material, screws, settings, progress);
}

std::vector<DrillPath> paths_of(const std::vector<Suggestion>& suggestions) {
  std::vector<DrillPath> paths;
  std::string rejections;
  for (const Suggestion& suggestion : suggestions) {
    if (suggestion.best) {
      paths.push_back(suggestion.best->path);
    } else {
      rejections += (rejections.empty() ? "" : "; ") + suggestion.rejection;
    }
  }
  if (paths.empty()) fail("no path to suggest: ", rejections);
  return paths;
}

}  // namespace spinaltap
