#pragma once

#include <memory>

#include "core/study/study_row.h"
#include "core/study/study_task.h"
#include "core/study/study_work.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/drilled_bone.h"

namespace spinaltap {

/// What all runs of a study share: the points, or voxels, along the planned path, of which each run drills a copy, and
/// the distances to the bone's walls around it.
class StudyBench {
 public:
  /// `bone`, `spec` and `runs` must outlive this. Throws Error where the planned path misses the bone.
  StudyBench(const Bone& bone, const StudySpec& spec, const StudyRuns& runs, const Progress& progress = {});

  /// For one thread: drills runs, one after the other, in a copy of its own.
  StudyRunner make_runner() const;

  /// Points, or voxels of bone.
  std::size_t point_count() const;
  std::size_t memory_bytes() const { return whole_.memory_bytes(); }

 private:
  StudyRow run(std::size_t n, DrilledBone& bone) const;

  const Bone& bone_;
  const StudySpec& spec_;
  const StudyRuns& runs_;
  DrilledBone whole_;
  std::unique_ptr<const ClearanceField> clearances_;
};

/// The cylinder's radius: the one given, or that which holds every run. Looks at every run and throws Error on one that
/// makes no sense, and on a radius above 15 mm that was not asked for.
double study_radius_mm(const StudySpec& spec, const StudyRuns& runs);

}  // namespace spinaltap
