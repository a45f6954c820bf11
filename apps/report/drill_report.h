#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "core/ct/ct_volume.h"
#include "core/session/cycle.h"
#include "core/session/real_time/real_time.h"
#include "core/tool/drill_path.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What a drilling was and how it went. The curves share `depth_mm`: each is empty or as long as it.
struct DrillReportData {
  std::string title;
  const CtVolume* ct = nullptr;  ///< for the slices; none without it
  std::string command = {};
  std::string date = {};
  const Bone* bone = nullptr;  ///< for its outline on them, and the path's angles where it has landmarks
  DrillPath path;
  Box3 bone_bounds_mm;  ///< patient LPS; empty: a box around the path

  std::vector<ReportPicture> renders;  ///< the bone before and after, from two sides, and cut open

  std::vector<double> depth_mm;       ///< of the tip along the path: 0 at the entry
  std::vector<double> hu;             ///< mean of the bone removed there; NaN where none was
  std::vector<double> density_g_cm3;  ///< the same by the material's density calibration
  std::vector<double> thrust_n;
  std::vector<double> p05_thrust_n, p95_thrust_n;  ///< as sources differ; see ForceBand
  std::vector<double> torque_n_mm;
  std::vector<double> p05_torque_n_mm, p95_torque_n_mm;
  std::vector<double> lateral_n;           ///< force of cutting across the bit's axis
  std::vector<double> clearance_outer_mm;  ///< of the bit; infinite where there is no wall near
  std::vector<double> clearance_canal_mm;
  std::vector<double> temperature_c;  ///< of the hottest place beside the hole; NaN where it is not known
  std::vector<double> cycles_per_s;   ///< how fast cycles ran there
  std::vector<double> removed;        ///< points at that step, not summed; or voxels
  bool has_voxels = false;            ///< voxels were drilled, not points
  double heat_distance_mm = 0.0;      ///< from the wall, where temperature_c is

  std::vector<SessionEvent> events;  ///< those of states also become markers in the plots of forces
  std::size_t events_lost = 0;
  std::optional<RealTimeReport> real_time;

  std::optional<ScrewFixation> fixation;  ///< of the path's screw

  std::vector<ReportRow> figures;  ///< further values for the last table
  std::vector<std::string> notes;
};

/// What a tool is, in rows for a report's table: a bit's diameter, length and tip; a plate's width, thickness, length.
std::vector<ReportRow> tool_rows(const DrillBit& bit);

/// The report on a drilling as one self-contained HTML file. Parts without data are left out.
/// Throws Error when a curve's length is not that of `depth_mm`, or the path has no length.
std::string drill_report(const DrillReportData& data);

}  // namespace spinaltap
