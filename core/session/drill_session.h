#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/engine/drill_engine.h"
#include "core/force/drill_forces.h"
#include "core/points/occupied_bone.h"
#include "core/session/compliant_tool.h"
#include "core/session/cycle.h"
#include "core/session/session_setup.h"
#include "core/session/tool_clearance.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// One drilling, cycle by cycle: removes bone, works out forces and clearances, recognises states, notes events and
/// when to stop. The same inputs bring the same results, whatever the engine, the threads or the pace.
class DrillSession {
 public:
  /// `engine` drills what `bone` tells of; what both stand on must outlive the session, as must `clearances`, which may
  /// be null: then there are none. Throws Error on bad options, and where the path leaves the bone's box or cylinder or
  /// there is no occupied bone.
  DrillSession(const DrillPath& path, std::unique_ptr<const OccupiedBone> bone, std::unique_ptr<DrillEngine> engine,
               const Material& material, const ClearanceField* clearances, const SessionOptions& options = {});
  /// `volumes`: filled, end to end along the path; they are drilled in place.
  DrillSession(const DrillPath& path, std::span<PointVolume> volumes, std::unique_ptr<DrillEngine> engine,
               const Material& material, const ClearanceField* clearances, const SessionOptions& options = {});
  ~DrillSession();

  /// Runs a cycle. Allocates and locks nothing; poses that make no sense do nothing but leave an event.
  const Cycle& step(const ToolInput& input) noexcept;

  /// Another tool from the next cycle on, which has come from nowhere: as a pedal changes it. `engine` drills the same
  /// bone with it. Time, cycles, states and events go on, and leaves an event. Allocates: not in real time. Throws
  /// Error on a bad tool, on a session with heat, and without an engine; then nothing has changed.
  void set_tool(const DrillBit& bit, std::unique_ptr<DrillEngine> engine);
  /// In use.
  const DrillBit& tool() const { return path_.bit; }

  const Cycle& last() const { return cycle_; }
  /// Notes how an operator ended that is not asked again: one short of its target leaves an event.
  void end(OperatorEnd end) noexcept;
  /// What the operator is told next.
  ToolFeedback feedback() const noexcept;
  /// In the order in which they began. The last kMaxEvents are kept room for; further ones are counted, not kept.
  /// Values of breaches still under way may grow.
  std::span<const SessionEvent> events() const;
  std::size_t events_lost() const;
  /// The rules ask to stop.
  bool is_stopped() const;
  const DrillPath& path() const { return path_; }
  const SessionOptions& options() const { return options_; }
  const DrillEngine& engine() const { return *engine_; }

  static constexpr std::size_t kMaxEvents = 4096;

 private:
  struct Tracking;

  DrillForces forces_for(const DrillBit& bit) const;
  Pose bent(const Pose& commanded, double dt_s) noexcept;
  void place(const Pose& pose, const ToolInput& input) noexcept;
  void tell_depth() noexcept;

  DrillPath path_;
  std::unique_ptr<const OccupiedBone> bone_;
  std::unique_ptr<DrillEngine> engine_;
  Material material_;
  SessionOptions options_;
  DrillForces forces_;
  const ClearanceField* clearances_;
  StateRecogniser states_;
  Cycle cycle_;
  std::unique_ptr<Tracking> tracking_;
};

/// As fast as it goes, in lock-step: the operator's next pose, a cycle, and so on until the operator ends.
void run_session(DrillSession& session, Operator& tool_operator, const CycleObserver& observe = {},
                 const Progress& progress = {});

}  // namespace spinaltap
