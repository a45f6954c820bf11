#include "core/study/study_task.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/registration/registered_probabilities.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

double of(const FactorValues& values, StudyFactor factor) { return values.at(static_cast<std::size_t>(factor)); }

double in_rad(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// The planned line as the run's errors make it: shifted across, and leaning about the shifted entry.
DrillPath with_errors(const DrillPath& planned, const AcrossPath& sides, const FactorValues& values) {
  constexpr double kMaxDeg = 60.0;
  for (const StudyFactor factor : {StudyFactor::angle_left_deg, StudyFactor::angle_head_deg}) {
    if (!(std::abs(of(values, factor)) <= kMaxDeg)) {
      fail(name_of(factor), ": expected an angle within ", kMaxDeg, " degrees, found ", of(values, factor));
    }
  }
  const Vec3 direction = (planned.direction() + std::tan(in_rad(of(values, StudyFactor::angle_left_deg))) * sides.left +
                          std::tan(in_rad(of(values, StudyFactor::angle_head_deg))) * sides.head)
                             .normalized();
  DrillPath path = planned;
  path.entry_mm += of(values, StudyFactor::entry_left_mm) * sides.left;
  path.entry_mm += of(values, StudyFactor::entry_head_mm) * sides.head;
  path.target_mm = path.entry_mm + planned.length_mm() * direction;
  return path;
}

double checked_positive(const FactorValues& values, StudyFactor factor) {
  const double value = of(values, factor);
  if (!(value > 0.0) || !std::isfinite(value)) fail(name_of(factor), ": expected a number above 0, found ", value);
  return value;
}

PoseError registration_error(const StudyRegistration& registration, const std::array<double, 6>& normals,
                             double scale) {
  PoseError error = pose_error_of(registration.covariance, Vec3(normals[0], normals[1], normals[2]),
                                  Vec3(normals[3], normals[4], normals[5]));
  error.turn_rad *= scale;
  error.shift_mm *= scale;
  return error;
}

double checked_scale(const FactorValues& values, StudyFactor factor) {
  const double scale = of(values, factor);
  if (!(scale >= 0.0 && scale <= 100.0)) fail(name_of(factor), ": expected 0 to 100, found ", scale);
  return scale;
}

/// Operator, bit and material of a run that drills.
void set_drilling(const StudySpec& spec, const DrillPath& planned, const FactorValues& values, StudyTask& task) {
  task.path.bit = resized(planned.bit, checked_positive(values, StudyFactor::bit_diameter_mm), planned.bit.length_mm);
  if (spec.tool_operator.kind == StudyOperator::Kind::push) {
    task.tool_operator.push_n = checked_positive(values, StudyFactor::push_n);
  } else {
    task.tool_operator.feed_mm_s = checked_positive(values, StudyFactor::feed_mm_s);
  }
  task.tool_operator.tremor_mm = of(values, StudyFactor::tremor_mm);
  if (!(task.tool_operator.tremor_mm >= 0.0)) {
    fail(name_of(StudyFactor::tremor_mm), ": expected a number of 0 or more, found ", task.tool_operator.tremor_mm);
  }
  const double scale = checked_positive(values, StudyFactor::density_scale);
  task.material.density.at_0_hu *= scale;
  task.material.density.per_hu *= scale;
  task.material = with_forces_times(task.material, checked_positive(values, StudyFactor::force_scale));
  check_material(task.material);
}

StudyTask task_of(const StudySpec& spec, const StudyRuns& runs, std::size_t n) {
  StudyTask task;
  task.screw = runs.screw_of(n);
  const StudyScrew screw = screw_at(spec, task.screw);
  const DrillPath& planned = path_of(spec, screw);
  task.values = runs.values(n, base_values(spec, planned));
  task.seed = runs.seed_of(n);
  task.material = spec.material;
  task.tool_operator = spec.tool_operator;
  task.path = with_errors(planned, across(planned), task.values);
  if (spec.kind == StudyKind::drilling) set_drilling(spec, planned, task.values, task);
  if (spec.errors) {
    task.error = scaled(error_of(*spec.errors, runs.placement_normals(n)),
                        checked_scale(task.values, StudyFactor::entry_error_scale),
                        checked_scale(task.values, StudyFactor::direction_error_scale));
    const std::vector<ErrorFrame>& frames = spec.bones[screw.bone].frames;
    if (screw.path >= frames.size()) fail("expected the frames of errors to be known, found none");
    ErrorFrame frame = frames[screw.path];
    // About the line as the factors have it, whose frame leans with it by as little.
    frame.along = task.path.direction();
    frame.medial = (frame.medial - frame.medial.dot(frame.along) * frame.along).normalized();
    const Vec3 cranial = frame.along.cross(frame.medial);
    frame.cranial = cranial.dot(frame.cranial) < 0.0 ? Vec3(-cranial) : cranial;
    task.path = erred_path(task.path, frame, task.error);
  }
  if (spec.registration) {
    task.registration = registration_error(*spec.registration, runs.registration_normals(n),
                                           checked_scale(task.values, StudyFactor::registration_scale));
    task.path = misregistered(task.path, task.registration, spec.registration->covariance.centre_mm);
  }
  check_path(task.path);
  return task;
}

}  // namespace

AcrossPath across(const DrillPath& path) {
  check_straight(path, "a study");
  check_turns(path.bit, "a study");
  const Vec3 direction = path.direction();
  const auto part_across = [&](const Vec3& side) { return Vec3(side - side.dot(direction) * direction); };
  constexpr double kAlong = 0.1;  // shorter: a path within 6 degrees of the body's length
  Vec3 head = part_across(Vec3::UnitZ());
  if (!(head.norm() > kAlong)) head = part_across(Vec3::UnitY());
  head.normalize();
  Vec3 left = head.cross(direction);
  if (left.x() < 0.0) left = -left;
  return {left, head};
}

StudyTask study_task(const StudySpec& spec, const StudyRuns& runs, std::size_t n) {
  try {
    return task_of(spec, runs, n);
  } catch (const Error& error) {
    fail("run ", n, " of the study: ", error.what());
  }
}

double radius_of_all_runs_mm(const StudySpec& spec, const StudyRuns& runs, double beyond_mm) {
  constexpr double kSpareMm = 0.2;
  double radius_mm = 0.0;
  for (std::size_t n = 0; n < runs.count(); ++n) {
    const StudyTask task = study_task(spec, runs, n);
    const StudyScrew screw = screw_at(spec, task.screw);
    const DrillPath& planned = path_of(spec, screw);
    const Vec3 axis = planned.direction();
    const Vec3 direction = task.path.direction();
    const double cosine = direction.dot(axis);
    if (!(cosine > 0.1)) fail("run ", n, " of the study: expected a line within 84 degrees of the planned one");
    // The line's distance from the path is greatest at one of the cylinder's ends.
    double line_mm = 0.0;
    for (const double depth_mm : {-spec.volume.lead_in_mm, planned.length_mm() + beyond_mm}) {
      const Vec3 way = task.path.entry_mm + depth_mm / cosine * direction - planned.entry_mm;
      line_mm = std::max(line_mm, (way - way.dot(axis) * axis).norm());
    }
    // A leaning bit's section is an ellipse; a tremor's five sinusoids on two axes come to at most √5 √2 of it.
    radius_mm = std::max(radius_mm,
                         line_mm + task.path.bit.radius_mm() / cosine + std::sqrt(10.0) * task.tool_operator.tremor_mm);
  }
  return radius_mm + kSpareMm;
}

std::unique_ptr<Operator> make_study_operator(const StudyTask& task, double lead_in_mm, const Spindle& spindle) {
  const GuideLine line{.lead_in_mm = lead_in_mm};
  if (task.tool_operator.kind == StudyOperator::Kind::push) {
    ForceControlOptions options;
    options.line = line;
    options.rate_hz = task.tool_operator.rate_hz;
    options.spindle = spindle;
    options.push_n = task.tool_operator.push_n;
    options.max_push_n = task.tool_operator.max_push_n;
    options.reaction_s = task.tool_operator.reaction_s;
    options.noticed_share = task.tool_operator.noticed_share;
    options.tremor_mm = task.tool_operator.tremor_mm;
    options.seed = task.seed;
    return std::make_unique<ForceControlled>(task.path, options);
  }
  PathMotionOptions options;
  options.line = line;
  options.rate_hz = task.tool_operator.feed_mm_s / task.tool_operator.step_mm;
  options.feed.steps = {{0.0, task.tool_operator.feed_mm_s}};
  options.tremor_mm = task.tool_operator.tremor_mm;
  options.seed = task.seed;
  return std::make_unique<PlannedMotion>(task.path, options);
}

}  // namespace spinaltap
