#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/base/progress.h"
#include "core/session/drill_session.h"
#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/sim/replay.h"

namespace spinaltap {

/// Gives a session the tool that its record changed to.
using ToolChanger = std::function<void(const RecordedTool& tool)>;

/// Feeds a new session the record's inputs, and compares every number that comes out, bit for bit, then the events. Of
/// a record that was cut short, events that were still under way may have grown. Throws Error on a record that changes
/// its tool where nothing is there to change it.
Replay replay_record(DrillSession& session, const SessionRecord& record, const Progress& progress = {},
                     const ToolChanger& change_tool = {});

/// The bone at any moment of a recorded drilling.
class RecordedHole {
 public:
  /// `bone`: the one that the session was built on; holes that the setup names are drilled first. The record must
  /// outlive this. Throws Error on a record without cycles.
  RecordedHole(const BoneModel& bone, const SessionRecord& record, const SessionSetup& setup);

  double end_s() const { return record_.cycles.back().time_s; }
  /// Drills on, or begins again, up to the last cycle that is not later than `time_s`.
  void go_to(double time_s);
  /// As it is at that moment.
  const BoneModel& drilled() { return cutter_.bone(); }
  /// Of the bit at that moment.
  Pose pose() const;
  /// The bit then.
  const DrillBit& tool() const { return tools_[tools_taken_ - 1]; }

 private:
  void begin();
  void add_to(std::size_t cycles);

  BoneModel bone_;  ///< when the session began
  const SessionRecord& record_;
  std::vector<DrillBit> tools_;  ///< the setup's, then those of the record
  double longest_jump_mm_;
  HoleCutter cutter_;
  std::size_t cycles_ = 0;       ///< that were drilled
  std::size_t tools_taken_ = 0;  ///< by the cutter
};

}  // namespace spinaltap
