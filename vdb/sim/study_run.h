#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/grading/neighbour_contact.h"
#include "core/grading/screw_breach.h"
#include "core/study/study_row.h"
#include "core/study/study_task.h"
#include "core/study/study_work.h"
#include "core/uncertainty/placement_errors.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/drilled_bone.h"

namespace spinaltap {

/// What all runs of one screw share: its walls and, where they drill, the points, or voxels, along the planned path, of
/// which each run drills a copy, and the distances to the walls around it.
class StudyBench {
 public:
  /// `spec`, whose paths must be known, and `runs` must outlive this. `reach_mm`: radius_of_all_runs_mm(). Throws Error
  /// where the planned path misses the bone.
  StudyBench(const Bone& bone, const StudySpec& spec, std::size_t screw, const StudyRuns& runs, double reach_mm,
             const Progress& progress = {});

  /// For one thread: does runs of the screw, one after the other, in a copy of its own.
  StudyRunner make_runner() const;

  /// Points, or voxels of bone.
  std::size_t point_count() const;
  std::size_t memory_bytes() const { return whole_.memory_bytes(); }

 private:
  void fill(double reach_mm, const Progress& progress);
  StudyRow run(std::size_t n, DrilledBone& bone) const;
  void drill(const StudyTask& task, DrilledBone& bone, StudyRow& row) const;
  void grade_screw(const StudyTask& task, StudyRow& row) const;

  Bone bone_;
  const StudySpec& spec_;
  const StudyRuns& runs_;
  DrillPath path_;
  double side_;
  DrilledBone whole_;
  std::unique_ptr<const ClearanceField> clearances_;
  std::optional<ErrorFrame> frame_;  ///< with grader_, where there are landmarks
  std::optional<ScrewGrader> grader_;
  std::vector<Neighbour> neighbours_;
};

/// The cylinder's radius: the one given, or `reach_mm`, that which holds every run. Throws Error on one above 15 mm
/// that was not asked for.
double study_radius_mm(const StudySpec& spec, double reach_mm);

}  // namespace spinaltap
