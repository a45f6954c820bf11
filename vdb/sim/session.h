#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/view.h"
#include "core/session/cycle.h"
#include "core/session/operator/operator.h"
#include "core/session/real_time/real_time.h"
#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"
#include "core/tool/drill_path.h"
#include "vdb/remaining/surface_block.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

class VoxelBone;

/// How a session's cycles are recorded.
struct RecordOptions {
  std::map<std::string, std::string> words = {};  ///< beside the setup: who moved the tool, and how
  std::optional<FrameFormat> frames = {};         ///< that the record also takes, with record_view(): what cameras see
  bool may_replace = false;                       ///< a file that is there
  bool waits = true;  ///< for the disk; else a cycle that comes too fast for it is lost, and counted: for real time
};

/// A bone being drilled, along one planned path or by a free hand: owns all it stands on, and is what DrillSession is,
/// with the hole, its surface, undo and a record besides. One thread at a time.
///
/// The drilling of one hole is one session: it begins at time 0 and cycle 0. end_hole() begins the next.
///
/// Of a hole under way it keeps the poses that cut, in 20 MB that are there from the start and that only long holes
/// use up; of one that cuts for more than 294,912 cycles (4.9 minutes at 1 kHz) those that its ways need to within
/// some hundredths of a millimetre: MotionLog says why poses and not voxels, and how. Forces, events, records and what
/// drilled() and surface_changes() gave before know nothing of that; what they give then, and the hole after
/// end_hole(), is off by motion_off_mm() at most.
class Session {
 public:
  /// `setup`: all that decides what a session does; its path and its bones' fingerprints are taken from `bone` and
  /// `path`. Throws Error where the path misses the bone, and on options that make no sense.
  /// `alike`: a session whose distances to walls are taken over where it has the same bone and path, which saves
  /// working them out again; may be null.
  Session(Bone bone, const DrillPath& path, const SessionSetup& setup = {}, const Progress& progress = {},
          const Session* alike = nullptr);
  /// Through several bones of one patient, in voxels: the path is the first's, the tool takes what it meets of all.
  /// Throws Error where an engine of points is asked for with more than one.
  Session(std::vector<Bone> bones, const DrillPath& path, const SessionSetup& setup = {},
          const Progress& progress = {});
  /// Without a planned path, in voxels: any tool anywhere, as a burr in a hand goes. `setup.path.bit`: its first tool;
  /// the rest of that path counts for nothing. Depths are those of the tip below the bone's surface, clearances the
  /// canal's, and events those that neither know a path nor states: see SessionOptions::has_path. Throws Error where an
  /// engine of points is asked for.
  explicit Session(std::vector<Bone> bones, const SessionSetup& setup = {}, const Progress& progress = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// One cycle: the bit goes straight from where it was to `pose` (patient LPS, mm) in `dt_s`. What it gives holds
  /// until the next. Poses that make no sense do nothing but leave an event. Allocates and locks nothing, at any
  /// length, but for a record's sake.
  const Cycle& step(const Pose& pose, double dt_s = 0.001) { return step_input({pose, true, dt_s}); }
  /// The same of a tool whose spindle may be off, or that a device holds.
  const Cycle& step_input(const ToolInput& input);
  /// Many cycles, as fast as it goes, whatever the stop rules say: look at is_stopped(). Gives a row for each.
  std::vector<RecordedCycle> run(std::span<const ToolInput> inputs, const Progress& progress = {});
  /// An operator (planned motion, recorded poses, a pushing operator) until it ends.
  void run(Operator& tool, const CycleObserver& observe = {}, const Progress& progress = {});
  /// The same against the clock, in threads for tool, collision and display: see spinaltap::run_real_time(). A record
  /// that waits for the disk (RecordOptions) may make a cycle late.
  RealTimeReport run_real_time(Operator& tool, const RealTimeOptions& pace, const CycleObserver& observe = {},
                               const DisplayTask& display = {}, const ForceTask& output = {},
                               const Progress& progress = {});

  /// Another tool from the next cycle on, which has come from nowhere: a pedal changes a burr. At any time; time, cycle
  /// and events go on, a record takes it, and the next hole begins with it. Allocates: milliseconds, not for a thread
  /// in real time. Throws Error on a bad tool, on a plate where there are points, or a record that was begun without
  /// one, and on a session with heat; then nothing has changed.
  void set_tool(const DrillBit& bit);
  /// In use.
  const DrillBit& tool() const;

  /// The last cycle; before the first, zeros.
  const Cycle& last() const;
  /// What an operator, or a VirtualCoupling, is told next.
  ToolFeedback feedback() const;
  /// Entries, states, breaches, stops: in the order in which they began.
  std::span<const SessionEvent> events() const;
  /// The stop rules ask to stop.
  bool is_stopped() const;

  /// From here on each cycle goes to a record, an HDF5 file that replay() and `spinaltap replay` run again. Throws
  /// Error after the first cycle, and where the file cannot be made or is there already.
  void record(const std::filesystem::path& file, const RecordOptions& options = {});
  /// Writes what is left, and marks the record as whole. Throws Error when the disk is full.
  void end_record();
  /// Cycles that did not get into the record that runs, or else into the last one, also where its end threw.
  std::uint64_t record_lost() const;

  /// What is drilled from here on is another hole; the bit has come from nowhere. Ends a record.
  void end_hole();
  /// Puts the bone back to before the last hole, or to before what this one was drilled so far. False where nothing was
  /// drilled. Throws Error while a record runs: it would not know. What this session drilled is put back in place; for
  /// a hole of its setup all bone is filled again.
  bool undo();
  /// By how much the hole under way may be off what the tool did, see above; 0 for one of less than 294,912 cycles.
  double motion_off_mm() const;

  /// What a camera sees of the remaining bone, as drilled() would have it, and of the bit where it now is; the bit of a
  /// hole that has no cycle yet is nowhere. See view_bone().
  View view(const Camera& camera);
  /// The same, and puts it into the record, beside the last cycle. Throws Error where there is no record that takes
  /// frames of this size, and before the first cycle.
  View record_view(const Camera& camera);

  /// Blocks of the remaining bone's surface that changed since the last call; the first time all of them. Vertices of
  /// what they point to never change. A block without a surface is gone.
  /// `bone`: which of bones(); each has blocks of its own. Throws Error where there is none.
  std::vector<SurfaceUpdate> surface_changes(std::size_t bone = 0);
  /// The bone without all holes; of several the first.
  Bone drilled();
  /// All of them, in the order of bones().
  std::vector<Bone> drilled_bones();

  /// Of several the first.
  const Bone& bone() const;
  /// All of them, in their order.
  std::span<const Bone> bones() const;
  /// The voxels as they now are; null where it drills points. They go when the session goes.
  const VoxelBone* voxels() const;
  /// With the tool that this hole began with. Where there is no planned path (setup().options.has_path) a line through
  /// the bones, which says nothing.
  const DrillPath& path() const;
  /// What it drills, and why: "voxels of 0.1 mm of the whole bone, for no path".
  std::string chosen() const;
  /// All that decides what it does.
  const SessionSetup& setup() const;

 private:
  struct State;

  CycleObserver noting(const CycleObserver& observe);

  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
