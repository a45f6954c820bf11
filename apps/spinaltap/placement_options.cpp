#include "apps/spinaltap/placement_options.h"

#include "apps/spinaltap/command.h"
#include "core/files/placement_errors_file.h"

namespace spinaltap {

void PlacementOptions::add_to(CLI::App& app) {
  app.add_option("--errors", errors,
                 "How screws err, for the probability of each grade: a model (robot_726, navigation_209, "
                 "freehand_experienced, freehand_novice), standard deviations of entry and direction, or none")
      ->capture_default_str()
      ->type_name("NAME|MM,DEG");
}

std::optional<PlacementErrors> PlacementOptions::model() const {
  if (errors == "none") return std::nullopt;
  return placement_errors_of(errors);
}

void add_uncertainty(const Bone& bone, const std::optional<PlacementErrors>& errors, std::vector<GradedPath>& graded,
                     const Progress& progress) {
  for (GradedPath& one : graded) {
    one.surface = bone.surface_error();
    if (!errors || one.path.is_curved()) continue;
    one.placed = PlacedGrade{*errors, grade_odds(bone.walls(), one.path, *errors, {}, progress),
                             breach_map(bone.walls(), one.path, {}, progress)};
  }
}

void print_uncertainty(const std::vector<GradedPath>& graded) {
  for (const GradedPath& one : graded) {
    if (one.placed) print_figure(one.path.name + " grades to expect", odds_in_words(*one.placed));
    if (one.path.is_curved()) print_figure(one.path.name + " grades to expect", "not judged for a curved path");
    if (one.surface) print_figure(one.path.name + " surface", surface_in_words(one));
  }
}

}  // namespace spinaltap
