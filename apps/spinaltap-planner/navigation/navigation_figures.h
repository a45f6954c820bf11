#pragma once

#include <QColor>
#include <QString>
#include <optional>

#include "core/plan/distance_to_plan.h"
#include "core/session/drill_session.h"

namespace spinaltap {

/// How a figure is to be taken.
enum class Alarm {
  none,
  near,  ///< look at it
  bad    ///< beyond what was planned for
};
/// Green, amber, red, bright ones for a dark ground: told apart by brightness too.
QColor alarm_colour(Alarm alarm);

/// From where on figures are near and bad. Those of the walls are the planner's own (drill_figures_view.h); 2 mm is
/// what Gertzbein and Robbins (Spine 1990) let a screw be outside of a pedicle and still call it safe.
struct NavigationLimits {
  double near_mm = 1.0;  ///< of the tool's axis from the path, at its entry and its target
  double bad_mm = 2.0;
  double near_deg = 2.0;
  double bad_deg = 5.0;
  double near_wall_mm = 1.0;  ///< between the bit and a wall; bad: below 0
  double near_left_mm = 3.0;  ///< to the target; bad: past it by more than half a millimetre
};

/// What a navigation picture shows of one cycle. The same cycle brings the same.
struct NavigationFigures {
  DistanceToPlan plan;
  double entry_off_mm = 0.0;  ///< the lengths of what DistanceToPlan has; NaN where that has none
  double target_off_mm = 0.0;
  double tip_off_mm = 0.0;
  double outer_mm = 0.0;  ///< clearances; infinite where no wall is near
  double canal_mm = 0.0;
  double thrust_n = 0.0;
  double hand_n = 0.0;  ///< that the device is told to give; 0 without one
  bool spindle_on = false;
  bool is_lost = false;  ///< the device or the tracked tool is not heard of
  Pose pose;             ///< patient LPS

  Alarm entry = Alarm::none, target = Alarm::none, tip = Alarm::none, angle = Alarm::none;
  Alarm left = Alarm::none, outer = Alarm::none, canal = Alarm::none;
  /// The worst of them.
  Alarm worst() const;
};
NavigationFigures navigation_figures(const PathCurve& path, const Cycle& cycle, const NavigationLimits& limits = {});

/// "1.24 mm", "–" where it is none.
QString mm_words(double mm, int digits = 1);
QString degree_words(double deg);
/// "23.1 mm", "past by 0.7 mm".
QString left_words(double left_mm);
/// "2.3 mm", "out by 0.4 mm", "far".
QString wall_words(double clearance_mm);

}  // namespace spinaltap
