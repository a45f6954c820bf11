#include "apps/spinaltap-planner/navigation/navigation_figures.h"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

QString navigation_tr(const char* words) { return QCoreApplication::translate("spinaltap::NavigationPanel", words); }

Alarm alarm_above(double value, double near, double bad) {
  if (std::isnan(value) || value > bad) return Alarm::bad;
  return value > near ? Alarm::near : Alarm::none;
}

Alarm alarm_below(double value, double near, double bad) {
  if (std::isnan(value) || value < bad) return Alarm::bad;
  return value < near ? Alarm::near : Alarm::none;
}

}  // namespace

QColor alarm_colour(Alarm alarm) {
  switch (alarm) {
    case Alarm::none:
      return {0x7d, 0xe0, 0x9a};
    case Alarm::near:
      return {0xff, 0xc1, 0x45};
    case Alarm::bad:
      return {0xff, 0x6b, 0x5e};
  }
  return {};
}

Alarm NavigationFigures::worst() const { return std::max({entry, target, tip, angle, left, outer, canal}); }

NavigationFigures navigation_figures(const PathCurve& path, const Cycle& cycle, const NavigationLimits& limits) {
  constexpr double kPastMm = -0.5;
  NavigationFigures figures;
  figures.pose = cycle.pose;
  figures.plan = distance_to_plan(path, cycle.pose);
  figures.entry_off_mm = figures.plan.at_entry_mm.norm();
  figures.target_off_mm = figures.plan.at_target_mm.norm();
  figures.tip_off_mm = figures.plan.at_tip_mm.norm();
  figures.outer_mm = cycle.clearance.outer_mm;
  figures.canal_mm = cycle.clearance.canal_mm;
  figures.thrust_n = cycle.force.thrust_n;
  figures.hand_n = cycle.input.device.force_n.norm();
  figures.spindle_on = cycle.input.spindle_on;
  figures.is_lost = cycle.input.device.status == DeviceStatus::lost;
  figures.entry = alarm_above(figures.entry_off_mm, limits.near_mm, limits.bad_mm);
  figures.target = alarm_above(figures.target_off_mm, limits.near_mm, limits.bad_mm);
  figures.tip = alarm_above(figures.tip_off_mm, limits.near_mm, limits.bad_mm);
  figures.angle = alarm_above(figures.plan.angle_deg, limits.near_deg, limits.bad_deg);
  figures.left = alarm_below(figures.plan.left_mm, limits.near_left_mm, kPastMm);
  figures.outer = alarm_below(figures.outer_mm, limits.near_wall_mm, 0.0);
  figures.canal = alarm_below(figures.canal_mm, limits.near_wall_mm, 0.0);
  return figures;
}

QString mm_words(double mm, int digits) {
  if (std::isnan(mm)) return QStringLiteral("–");
  if (std::isinf(mm)) return navigation_tr("far");
  return navigation_tr("%1 mm").arg(mm, 0, 'f', digits);
}

QString degree_words(double deg) {
  return std::isnan(deg) ? QStringLiteral("–") : QStringLiteral("%1°").arg(deg, 0, 'f', 1);
}

QString left_words(double left_mm) {
  if (std::isnan(left_mm)) return QStringLiteral("–");
  return left_mm < 0.0 ? navigation_tr("past by %1 mm").arg(-left_mm, 0, 'f', 1)
                       : navigation_tr("%1 mm").arg(left_mm, 0, 'f', 1);
}

QString wall_words(double clearance_mm) {
  return clearance_mm < 0.0 ? navigation_tr("out by %1 mm").arg(-clearance_mm, 0, 'f', 1) : mm_words(clearance_mm);
}

}  // namespace spinaltap
