#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/force/force_band.h"
#include "core/points/material.h"
#include "core/session/drill_session.h"

namespace spinaltap {

/// One row of the log: the cycles until the tip is deeper by `log_step_mm` than at the last row's end. Those in which
/// the bit draws back count where they happen.
struct DepthRow {
  double depth_mm = 0.0;        ///< greatest of the tip so far, beyond the entry
  std::size_t cycles = 0;       ///< the first, which puts the bit, is none
  std::size_t removed = 0;      ///< points
  std::size_t tested = 0;       ///< points
  double hu = 0.0;              ///< mean of the removed points; NaN where none was
  double density_g_cm3 = 0.0;   ///< by the material's density calibration; NaN where none was
  double thrust_n = 0.0;        ///< mean over the row's time, as are torque and lateral force
  Interval thrust_band_n = {};  ///< 5 % and 95 % of it, as sources differ; see ForceBand
  double torque_n_mm = 0.0;
  Interval torque_band_n_mm = {};
  double lateral_n = 0.0;                  ///< of cutting, across the axis
  double contact_n = 0.0;                  ///< of touching with the spindle off; mean as well
  DrillState state = DrillState::initial;  ///< at the row's end
  double outer_mm = 0.0;                   ///< min clearances; infinite where there is no wall near
  double canal_mm = 0.0;
  double temperature_c = 0.0;  ///< max of the hottest place beside the hole; NaN where heat is not worked out
  double work_n_mm = 0.0;      ///< of cutting at the material's reference feed
  double cycles_per_s = 0.0;   ///< by the time that cycles took; NaN where it was not measured
};

/// Sums a session's cycles into rows.
class DepthLog {
 public:
  /// Throws Error on a step that is not above 0. Takes room for rows over `expected_mm` of depth.
  DepthLog(double log_step_mm, const Material& material, double expected_mm);

  /// `seconds`: what the cycle took; NaN where that was not measured. Allocates nothing within the expected depth.
  void add(const Cycle& cycle, double seconds);
  /// Those that are whole.
  const std::vector<DepthRow>& rows() const { return rows_; }
  /// The rows; the last may be shorter.
  std::vector<DepthRow> finish();

 private:
  void close_row();

  double log_step_mm_;
  HuToDensity density_;
  ForceBand band_;
  std::vector<DepthRow> rows_;
  bool has_begun_ = false;
  double begin_mm_ = 0.0;  ///< of the whole log
  double deepest_mm_ = 0.0;
  double row_end_mm_ = 0.0;
  DepthRow row_;
  std::int64_t hu_sum_ = 0;
  double dt_s_ = 0.0;
  double seconds_ = 0.0;
};

/// The log as CSV, with a head line; units are in the names of the columns. A field is empty where nothing is known.
std::string log_csv(const std::vector<DepthRow>& rows);

}  // namespace spinaltap
