#include "apps/spinaltap-planner/drill/drill_figures_view.h"

#include <QGridLayout>
#include <QLabel>
#include <QPalette>

#include <algorithm>
#include <cmath>

#include "apps/report/text.h"
#include "apps/spinaltap-planner/drill/drill_player.h"

namespace spinaltap {
namespace {

PlotSeries curve_of(std::span<const DepthRow> rows, const char* name, double DepthRow::*value) {
  PlotSeries series;
  series.name = name;
  for (const DepthRow& row : rows) {
    series.x.push_back(row.depth_mm);
    series.y.push_back(row.*value);
  }
  return series;
}

PlotBand band_of(std::span<const DepthRow> rows, Interval DepthRow::*value) {
  PlotBand band;
  band.name = "5 to 95 % of sources";
  for (const DepthRow& row : rows) {
    band.x.push_back(row.depth_mm);
    band.low.push_back((row.*value).low);
    band.high.push_back((row.*value).high);
  }
  return band;
}

constexpr double kNearMm = 1.0;

QString with_digits(double value, int digits, const char* unit) {
  return QString::fromStdString(readable_number(value, digits)) + QString::fromUtf8(unit);
}

QString told_state(const DrillPlayer& player) {
  switch (player.state()) {
    case DrillPlayer::State::idle:
      return DrillFiguresView::tr("Ready");
    case DrillPlayer::State::preparing:
      return DrillFiguresView::tr("Preparing…");
    case DrillPlayer::State::drilling:
    case DrillPlayer::State::stopped:
      break;
  }
  if (!player.last()) return {};
  const bool has_states = player.setup() == nullptr || player.setup()->options.follows_path;
  const std::string name(has_states ? name_of(player.last()->state) : "milling");
  QString where =
      DrillFiguresView::tr("%1, at %2 s").arg(QString::fromStdString(name)).arg(player.seconds(), 0, 'f', 1);
  if (player.state() == DrillPlayer::State::drilling) return where;
  return (player.is_over() ? DrillFiguresView::tr("Ended: %1") : DrillFiguresView::tr("Stopped: %1")).arg(where);
}

void show_clearance(QLabel* label, double clearance_mm) {
  label->setText(clearance_words(clearance_mm));
  const char* colour = clearance_mm < 0.0 ? "#b3261e" : clearance_mm < kNearMm ? "#8a5300" : "";
  label->setStyleSheet(*colour == '\0' ? QString() : QStringLiteral("font-weight: 600; color: %1").arg(colour));
}

void show_heat(QLabel* label, const Cycle& cycle, const SessionSetup& setup) {
  if (!setup.options.heat) {
    label->setText(DrillFiguresView::tr("not worked out: only a drilled hole has it"));
    label->setStyleSheet({});
    return;
  }
  label->setText(
      DrillFiguresView::tr("%1, at most %2")
          .arg(with_digits(cycle.heat.temperature_c, 1, " °C"), with_digits(cycle.heat.max_temperature_c, 1, " °C")));
  const bool is_hot = cycle.heat.max_temperature_c > setup.options.heat->limit_c;
  label->setStyleSheet(is_hot ? QStringLiteral("font-weight: 600; color: #b3261e") : QString());
}

}  // namespace

Plot drill_plot(DrillCurve curve, std::span<const DepthRow> rows, double length_mm) {
  Plot plot;
  plot.x_label = "depth";
  plot.x_unit = "mm";
  plot.x_low = rows.empty() ? 0.0 : std::min(0.0, rows.front().depth_mm);
  plot.x_high = length_mm;
  plot.markers = {{0.0, "Entry"}, {length_mm, "Target"}};
  plot.y_from_zero = true;
  switch (curve) {
    case DrillCurve::thrust:
      plot.y_label = "thrust";
      plot.y_unit = "N";
      plot.series = {curve_of(rows, "thrust", &DepthRow::thrust_n)};
      plot.bands = {band_of(rows, &DepthRow::thrust_band_n)};
      break;
    case DrillCurve::torque:
      plot.y_label = "torque";
      plot.y_unit = "N·mm";
      plot.series = {curve_of(rows, "torque", &DepthRow::torque_n_mm)};
      plot.bands = {band_of(rows, &DepthRow::torque_band_n_mm)};
      break;
    case DrillCurve::density:
      plot.y_label = "density";
      plot.y_unit = "HU";
      plot.series = {curve_of(rows, "density", &DepthRow::hu)};
      break;
    case DrillCurve::clearance:
      plot.y_label = "clearance";
      plot.y_unit = "mm";
      plot.series = {curve_of(rows, "outer surface", &DepthRow::outer_mm),
                     curve_of(rows, "canal", &DepthRow::canal_mm)};
      break;
    case DrillCurve::temperature:
      plot.y_label = "temperature";
      plot.y_unit = "°C";
      plot.y_from_zero = false;
      plot.series = {curve_of(rows, "bone 0.5 mm from the wall", &DepthRow::temperature_c)};
      break;
  }
  return plot;
}

QString clearance_words(double clearance_mm) {
  if (!std::isfinite(clearance_mm)) return DrillFiguresView::tr("far");
  if (clearance_mm < 0.0) return DrillFiguresView::tr("beyond by %1").arg(with_digits(-clearance_mm, 2, " mm"));
  const QString text = with_digits(clearance_mm, 2, " mm");
  return clearance_mm < kNearMm ? DrillFiguresView::tr("%1, near").arg(text) : text;
}

DrillFiguresView::DrillFiguresView(QWidget* parent) : QWidget(parent) {
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(10);
  grid->setVerticalSpacing(3);
  state_ = add("drill_state", tr("State"), 0, 0);
  grid->addWidget(state_, 0, 1, 1, 3);
  depth_ = add("drill_depth", tr("Depth"), 1, 0);
  feed_ = add("drill_feed", tr("Feed"), 1, 2);
  thrust_ = add("drill_thrust", tr("Thrust"), 2, 0);
  torque_ = add("drill_torque", tr("Torque"), 2, 2);
  cycles_ = add("drill_cycles", tr("Cycles"), 3, 0);
  cycles_->setToolTip(tr("Cycles of the session in a second: 1,000 in real time"));
  frames_ = add("drill_frames", tr("Frames"), 3, 2);
  frames_->setToolTip(tr("How often the surface in 3D was brought up to date in a second"));
  removed_ = add("drill_removed", tr("Removed"), 4, 0);
  engine_ = add("drill_engine_used", tr("Engine"), 4, 2);
  engine_->setToolTip(tr("What removes the bone: of `automatic`, the one that was taken"));
  outer_ = add("drill_outer", tr("To outer surface"), 5, 0);
  grid->addWidget(outer_, 5, 1, 1, 3);
  canal_ = add("drill_canal", tr("To canal"), 6, 0);
  grid->addWidget(canal_, 6, 1, 1, 3);
  heat_ = add("drill_heat", tr("Bone at 0.5 mm"), 7, 0);
  heat_->setToolTip(tr("The hottest bone half a millimetre from the hole's wall: now, and at most so far"));
  grid->addWidget(heat_, 7, 1, 1, 3);
  grid->setColumnStretch(1, 1);
  grid->setColumnStretch(3, 1);
}

QLabel* DrillFiguresView::add(const char* name, const QString& label, int row, int column) {
  auto* grid = static_cast<QGridLayout*>(layout());
  auto* title = new QLabel(label, this);
  QPalette colours = title->palette();
  QColor quiet = colours.color(QPalette::WindowText);
  quiet.setAlphaF(0.65F);
  colours.setColor(QPalette::WindowText, quiet);
  title->setPalette(colours);
  auto* value = new QLabel(this);
  value->setObjectName(QString::fromLatin1(name));
  value->setAccessibleName(label);
  value->setTextInteractionFlags(Qt::TextSelectableByMouse);
  grid->addWidget(title, row, column);
  grid->addWidget(value, row, column + 1);
  return value;
}

void DrillFiguresView::show_figures(const DrillPlayer& player) {
  state_->setText(told_state(player));
  const std::optional<Cycle>& cycle = player.last();
  for (QLabel* label : {depth_, thrust_, torque_, feed_, removed_, engine_, outer_, canal_, heat_, cycles_, frames_}) {
    if (!cycle) label->setText(QStringLiteral("–"));
  }
  if (!cycle) {
    for (QLabel* label : {outer_, canal_, heat_}) label->setStyleSheet({});
    return;
  }
  const double rpm = player.spindle_rpm();
  depth_->setText(with_digits(cycle->depth_mm, 2, " mm"));
  thrust_->setText(with_digits(cycle->force.thrust_n, 1, " N"));
  torque_->setText(with_digits(cycle->force.torque_n_mm, 0, " N·mm"));
  const auto tell_band = [](QLabel* label, const Interval& band, int digits, const char* unit) {
    label->setToolTip(tr("5 to 95 % of sources: %1").arg(QString::fromStdString(interval_text(band, digits))) +
                      QString::fromUtf8(unit));
  };
  tell_band(thrust_, cycle->force.thrust_band_n, 1, " N");
  tell_band(torque_, cycle->force.torque_band_n_mm, 0, " N·mm");
  feed_->setText(with_digits(cycle->force.feed_mm_per_turn * rpm / 60.0, 2, " mm/s"));
  const SessionSetup& setup = *player.setup();
  const bool has_voxels = setup.engine == EngineKind::voxel;
  removed_->setText(with_digits(static_cast<double>(player.removed()), 0, has_voxels ? " voxels" : " points"));
  engine_->setText(QString::fromStdString(name_of(setup.engine)));
  cycles_->setText(with_digits(player.cycles_per_s(), 0, " /s"));
  frames_->setText(with_digits(player.surface_updates_per_s(), 0, " /s"));
  show_heat(heat_, *cycle, setup);
  if (!setup.has_clearances) {
    for (QLabel* label : {outer_, canal_}) {
      label->setText(tr("not watched: a milling takes the walls away"));
      label->setStyleSheet({});
    }
    return;
  }
  show_clearance(outer_, cycle->clearance.outer_mm);
  show_clearance(canal_, cycle->clearance.canal_mm);
}

}  // namespace spinaltap
