#include "core/session/depth_log.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

DepthRow empty_row() {
  DepthRow row;
  row.outer_mm = kInfinity;
  row.canal_mm = kInfinity;
  row.temperature_c = std::numeric_limits<double>::quiet_NaN();
  return row;
}

}  // namespace

DepthLog::DepthLog(double log_step_mm, const Material& material, double expected_mm)
    : log_step_mm_(log_step_mm), density_(material.density), band_(material), row_(empty_row()) {
  if (!(log_step_mm > 0.0)) fail("drilling: expected a log step above 0 mm, found ", log_step_mm);
  constexpr double kMaxRows = 1e6;  // further ones are allocated when they come
  rows_.reserve(static_cast<std::size_t>(std::clamp(expected_mm / log_step_mm, 0.0, kMaxRows)) + 2);
}

void DepthLog::add(const Cycle& cycle, double seconds) {
  row_.removed += cycle.step.removed;
  row_.tested += cycle.step.tested;
  hu_sum_ += cycle.step.removed_hu;
  row_.work_n_mm += cycle.step.work_n_mm;
  row_.state = cycle.state;
  row_.outer_mm = std::fmin(row_.outer_mm, cycle.clearance.outer_mm);
  row_.canal_mm = std::fmin(row_.canal_mm, cycle.clearance.canal_mm);
  row_.temperature_c = std::fmax(row_.temperature_c, cycle.heat.temperature_c);
  // An invalid pose has a depth that is none.
  const bool has_depth = std::isfinite(cycle.depth_mm);
  if (!has_begun_) {
    if (!has_depth) return;
    has_begun_ = true;
    begin_mm_ = deepest_mm_ = cycle.depth_mm;
    row_end_mm_ = begin_mm_ + log_step_mm_;
    return;
  }
  ++row_.cycles;
  const double dt_s = cycle.input.dt_s;
  if (dt_s > 0.0) {
    dt_s_ += dt_s;
    row_.thrust_n += cycle.force.thrust_n * dt_s;
    row_.torque_n_mm += cycle.force.torque_n_mm * dt_s;
    row_.lateral_n += cycle.force.lateral_n.norm() * dt_s;
    row_.contact_n += cycle.force.contact_n.norm() * dt_s;
  }
  seconds_ += seconds;
  if (has_depth) deepest_mm_ = std::max(deepest_mm_, cycle.depth_mm);
  // Rows end at whole multiples of the log step, whatever the advance; half a nanometre forgives rounding.
  if (deepest_mm_ >= row_end_mm_ - 5e-7) close_row();
}

void DepthLog::close_row() {
  row_.depth_mm = deepest_mm_;
  row_.hu = row_.removed > 0 ? static_cast<double>(hu_sum_) / static_cast<double>(row_.removed)
                             : std::numeric_limits<double>::quiet_NaN();
  row_.density_g_cm3 = row_.removed > 0 ? density_.density_g_cm3(row_.hu) : row_.hu;
  if (dt_s_ > 0.0) {
    row_.thrust_n /= dt_s_;
    row_.torque_n_mm /= dt_s_;
    row_.lateral_n /= dt_s_;
    row_.contact_n /= dt_s_;
  }
  row_.thrust_band_n = band_.thrust_n(row_.thrust_n);
  row_.torque_band_n_mm = band_.torque_n_mm(row_.torque_n_mm);
  row_.cycles_per_s = static_cast<double>(row_.cycles) / std::max(seconds_, 1e-12);
  if (std::isnan(seconds_)) row_.cycles_per_s = seconds_;
  rows_.push_back(row_);
  const double rows_done = std::floor((deepest_mm_ - begin_mm_ + 5e-7) / log_step_mm_);
  row_end_mm_ = begin_mm_ + (rows_done + 1.0) * log_step_mm_;
  row_ = empty_row();
  hu_sum_ = 0;
  dt_s_ = 0.0;
  seconds_ = 0.0;
}

std::vector<DepthRow> DepthLog::finish() {
  if (row_.cycles > 0) close_row();
  return std::move(rows_);
}

std::string log_csv(const std::vector<DepthRow>& rows) {
  TextWriter csv(7);
  csv << "depth_mm,cycles,removed_points,tested_points,mean_hu,mean_density_g_cm3,mean_thrust_n,mean_torque_n_mm,"
         "p05_thrust_n,p95_thrust_n,p05_torque_n_mm,p95_torque_n_mm,mean_lateral_n,mean_contact_n,state,min_clearance_"
         "outer_mm,min_clearance_canal_mm,max_temperature_c,cycles_per_s\n";
  const auto number = [&](double value) {
    csv << ',';
    if (std::isfinite(value)) csv << value;  // empty where it is none, as append_csv_number() has it
  };
  for (const DepthRow& row : rows) {
    csv << row.depth_mm << ',' << row.cycles << ',' << row.removed << ',' << row.tested;
    for (const double value :
         {row.hu, row.density_g_cm3, row.thrust_n, row.torque_n_mm, row.thrust_band_n.low, row.thrust_band_n.high,
          row.torque_band_n_mm.low, row.torque_band_n_mm.high, row.lateral_n, row.contact_n})
      number(value);
    csv << ',' << name_of(row.state);
    for (const double value : {row.outer_mm, row.canal_mm, row.temperature_c, row.cycles_per_s}) number(value);
    csv << '\n';
  }
  return csv.str();
}

}  // namespace spinaltap
