#include "apps/spinaltap/placement_options.h"

#include <algorithm>

#include "apps/spinaltap/command.h"
#include "core/files/placement_errors_file.h"
#include "core/files/registration_file.h"
#include "core/registration/registered_probabilities.h"

namespace spinaltap {

void PlacementOptions::add_to(CLI::App& app) {
  app.add_option("--errors", errors,
                 "How screws err, for the probability of each grade: a model (robot_726, navigation_209, "
                 "freehand_experienced, freehand_novice), standard deviations of entry and direction, or none")
      ->capture_default_str()
      ->type_name("NAME|MM,DEG");
  app.add_option("--registration", registration,
                 "A registration that guides the screws: its error is added to that of --errors, which with none is "
                 "its own alone")
      ->type_name("FILE");
}

PlacementModel PlacementOptions::model() const {
  PlacementModel model;
  if (errors != "none") model.errors = placement_errors_of(errors);
  if (!registration.empty()) {
    model.registration = read_registration(registration);
    model.registration_name = registration.filename().string();
  }
  return model;
}

namespace {

GradeProbabilities probabilities_of(const Bone& bone, const DrillPath& path, const PlacementModel& model,
                                    const PlacementErrors& errors, const Progress& progress) {
  if (!model.registration) return grade_probabilities(bone.walls(), path, errors, {}, progress);
  return registered_probabilities(bone.walls(), path, errors, model.registration->covariance, {}, progress);
}

PlacementErrors no_errors() {
  PlacementErrors none = plain_errors(0.0, 0.0);
  none.name = "none of their own";
  none.title = "None of the screw's own";
  return none;
}

}  // namespace

void add_uncertainty(const Bone& bone, const PlacementModel& model, std::vector<GradedPath>& graded,
                     const Progress& progress) {
  for (GradedPath& one : graded) {
    one.surface = bone.surface_error();
    if ((!model.errors && !model.registration) || one.path.is_curved()) continue;
    const PlacementErrors errors = model.errors.value_or(no_errors());
    one.placed = PlacedGrade{errors, probabilities_of(bone, one.path, model, errors, progress),
                             breach_map(bone.walls(), one.path, {}, progress)};
    if (!model.registration) continue;
    const PoseCovariance& covariance = model.registration->covariance;
    one.placed->registration =
        AddedRegistration{model.registration_name, target_error_mm(covariance, one.path.entry_mm),
                          target_error_mm(covariance, one.path.target_mm), model.registration->warnings};
  }
}

void check_registration(const PlacementModel& model, const Bone& bone, const PlanCheckOptions& options,
                        PlanFindings& findings) {
  if (!model.registration) return;
  options.check_registration(model.registration_name, model.registration->bone, bone.identity(), findings.notes);
}

void print_uncertainty(const std::vector<GradedPath>& graded) {
  for (const GradedPath& one : graded) {
    if (one.placed) print_figure(one.path.name + " grades to expect", probabilities_in_words(*one.placed));
    if (one.path.is_curved()) print_figure(one.path.name + " grades to expect", "not judged for a curved path");
    if (one.surface) print_figure(one.path.name + " surface", surface_in_words(one));
  }
  const auto with = std::find_if(graded.begin(), graded.end(),
                                 [](const GradedPath& one) { return one.placed && one.placed->registration; });
  if (with == graded.end()) return;
  const AddedRegistration& added = *with->placed->registration;
  for (const std::string& warning : added.warnings) print_figure("warning", added.name + ": " + warning);
}

}  // namespace spinaltap
