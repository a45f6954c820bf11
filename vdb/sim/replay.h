#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/engine/drill_engine.h"
#include "core/session/drill_session.h"
#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What the operator gave to a recorded cycle.
ToolInput input_of(const RecordedCycle& row);

/// What running a record again came to.
struct Replay {
  std::size_t cycles = 0;  ///< that were run and compared
  std::size_t events = 0;  ///< that were compared
  double seconds = 0.0;    ///< that running them took
  std::string difference;  ///< the first, with cycle, quantity and both values; empty: every bit is the same
  /// Where the record lacks cycles, which nobody can run again: what comes after is not compared. Empty: it does not.
  std::string gap;

  bool is_same() const { return difference.empty() && gap.empty(); }
};

/// Gives a session the tool that its record changed to.
using ToolChanger = std::function<void(const RecordedTool& tool)>;

/// Feeds a new session the record's inputs, and compares every number that comes out, bit for bit, then the events. Of
/// a record that was cut short, events that were still under way may have grown. Throws Error on a record that changes
/// its tool where nothing is there to change it.
Replay replay_record(DrillSession& session, const SessionRecord& record, const Progress& progress = {},
                     const ToolChanger& change_tool = {});

/// Runs a record again on the bone that it was drilled in, with another engine where one is given (`automatic`: the
/// record's own). Throws
/// Error as read_record() does, on a record that is none of a session, and on another bone.
Replay replay(const std::filesystem::path& record, const Bone& bone, std::optional<EngineKind> engine = {},
              const Progress& progress = {});
/// As above, of a record that was read from `file`, which messages name.
Replay replay(const SessionRecord& record, const std::filesystem::path& file, const Bone& bone,
              std::optional<EngineKind> engine = {}, const Progress& progress = {});
/// Of several bones, in the order in which they were drilled. `takes_other_ct`: other bones than those that were
/// drilled are taken all the same, which the cycles then tell.
Replay replay(const SessionRecord& record, const std::filesystem::path& file, std::span<const Bone> bones,
              std::optional<EngineKind> engine = {}, const Progress& progress = {}, bool takes_other_ct = false);

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
