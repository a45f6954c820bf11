#pragma once

#include "core/heat/hole_heat.h"
#include "core/session/detail/session_watch.h"
#include "core/session/drill_session.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// Heat beside the hole of a session. Allocates nothing but when it is made.
class LiveHeat {
 public:
  /// Throws Error on bad options, and on a tool that drills no hole.
  LiveHeat(const DrillPath& path, const HeatOptions& options);

  /// Before the first cycle.
  CycleHeat begin() const;
  /// After a cycle's forces, `dt_s` after the last one that had some. `rpm`: 0 where the spindle is off. Notes an event
  /// while the hottest place is above the limit, until it is half a kelvin below.
  CycleHeat update(const Cycle& cycle, double dt_s, double rpm, EventLog& log) noexcept;

 private:
  HeatOptions options_;
  double diameter_mm_;
  double wall_back_mm_;
  PathCurve curve_;
  HoleHeat hole_;
  WatchedExcess over_;
};

}  // namespace spinaltap
