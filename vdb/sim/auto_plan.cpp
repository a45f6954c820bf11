#include "vdb/sim/auto_plan.h"

#include "core/anatomy/wall_distance.h"
#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/planning_rules_file.h"
#include "core/files/screw_file.h"

namespace spinaltap {

std::array<std::filesystem::path, 4> files_of(const AutoPlanOptions& options) {
  const auto file = [](const std::filesystem::path& named, const char* shipped) {
    return named.empty() ? std::filesystem::path(data_file(shipped)) : named;
  };
  return {file(options.rules, "planning/pedicle.json"), file(options.screws, "screws/pedicle.json"),
          file(options.density, "densities/vertebra.json"), file(options.material, "materials/vertebra.json")};
}

std::vector<Suggestion> auto_plan(const WallDistance& walls, const HuSampler& hu, const AutoPlanOptions& options,
                                  const Progress& progress) {
  const auto [rules, screw_table, density_line, cutting_model] = files_of(options);
  SuggestOptions settings = read_planning_rules(rules);
  if (options.margin_mm) settings.margin_mm = settings.min_margin_mm = *options.margin_mm;
  settings.is_bicortical = options.is_bicortical;
  settings.sagittal = options.sagittal;
  settings.technique = options.technique;
  settings.level = options.level;
  settings.bit = options.bit;
  const std::vector<PedicleScrew> screws = read_screws(screw_table);
  const HuToDensity density = read_density_calibration(density_line).line;
  const Material material = read_material(cutting_model, density);
  return suggest_paths(walls, hu, material, screws, settings, progress);
}

}  // namespace spinaltap
