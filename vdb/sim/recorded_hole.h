#pragma once

#include "core/session/record/session_record.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// The bone at any moment of a recorded drilling.
class RecordedHole {
 public:
  /// `bone`: as it was before, the one that was drilled. Bone and record must outlive this. `longest_jump_mm`: as
  /// SessionOptions has it. Throws Error on a record without cycles.
  RecordedHole(const BoneModel& bone, const SessionRecord& record, const DrillBit& bit, double longest_jump_mm);

  double end_s() const { return record_.cycles.back().time_s; }
  /// Drills on, or begins again, up to the last cycle that is not later than `time_s`.
  void go_to(double time_s);
  /// As it is at that moment.
  const BoneModel& drilled() const { return drilled_; }
  /// Of the bit at that moment.
  Pose pose() const;

 private:
  const BoneModel& bone_;
  const SessionRecord& record_;
  DrillBit bit_;
  double longest_jump_mm_;
  BoneModel drilled_;
  std::size_t cycles_ = 1;  ///< that were drilled
};

}  // namespace spinaltap
