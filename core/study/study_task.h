#pragma once

#include <memory>

#include "core/session/operator/operator.h"
#include "core/study/study_spec.h"

namespace spinaltap {

/// One run's inputs.
struct StudyTask {
  std::size_t screw = 0;  ///< of screws_of()
  FactorValues values{};
  PlacementError error;    ///< of the screw, as its factors scale it; 0 where the study has none
  PoseError registration;  ///< likewise
  DrillPath path;          ///< the line that the bit really takes, and the run's bit
  Material material;
  StudyOperator tool_operator;
  std::uint64_t seed = 1;  ///< of the tremor
};

/// Unit vectors across a path (patient LPS), at right angles: one to the patient's left as far as the path lets it, one
/// to the head. Of a path along the body's length the head's is replaced by the back.
struct AcrossPath {
  Vec3 left;
  Vec3 head;
};
AcrossPath across(const DrillPath& path);

/// What run n drills. The spec's paths must be known, and their frames where it has errors. Throws Error that names the
/// run and the factor whose value makes no sense.
StudyTask study_task(const StudySpec& spec, const StudyRuns& runs, std::size_t n);

/// Radius of the cylinder around a planned path, from its lead-in to `beyond_mm` past the target, in which the bits of
/// all runs stay, with 0.2 mm to spare, mm. Looks at every run, so it also finds those that make no sense: throws
/// Error as study_task().
double radius_of_all_runs_mm(const StudySpec& spec, const StudyRuns& runs, double beyond_mm);

/// The operator that does a run: along the task's own line, from `lead_in_mm` before its entry. `spindle`: the
/// session's.
std::unique_ptr<Operator> make_study_operator(const StudyTask& task, double lead_in_mm, const Spindle& spindle);

}  // namespace spinaltap
