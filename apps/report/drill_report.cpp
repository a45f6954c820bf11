#include "apps/report/drill_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "apps/report/depth_bins.h"
#include "apps/report/fixation_report.h"
#include "apps/report/session_report.h"
#include "apps/report/slice_figure.h"
#include "apps/report/svg_plot.h"
#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/grading/path_side.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

using Curve = std::vector<double>;

constexpr double kHapticRate = 1000.0;  ///< cycles per second that a steady force needs
constexpr double kDrillPlotHeight = 230.0;
constexpr std::size_t kDepthBins = 480;  ///< under two drawing units each

std::string position(const Vec3& p) {
  return readable_number(p.x(), 1) + ", " + readable_number(p.y(), 1) + ", " + readable_number(p.z(), 1);
}

/// Smallest, largest and median of the finite values; NaN where there is none.
struct Spread {
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
};

Spread spread(const Curve& values) {
  Spread result;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    result.min = std::fmin(result.min, value);
    result.max = std::fmax(result.max, value);
  }
  result.median = finite_median(values);
  return result;
}

void check(const DrillReportData& data) {
  if (!(data.path.length_mm() > 0.0))
    fail("drill report: expected a path longer than 0 mm, found ", data.path.length_mm());
  const std::array<std::pair<const char*, const Curve*>, 14> curves{{{"hu", &data.hu},
                                                                     {"density_g_cm3", &data.density_g_cm3},
                                                                     {"thrust_n", &data.thrust_n},
                                                                     {"torque_n_mm", &data.torque_n_mm},
                                                                     {"p05_thrust_n", &data.p05_thrust_n},
                                                                     {"p95_thrust_n", &data.p95_thrust_n},
                                                                     {"p05_torque_n_mm", &data.p05_torque_n_mm},
                                                                     {"p95_torque_n_mm", &data.p95_torque_n_mm},
                                                                     {"lateral_n", &data.lateral_n},
                                                                     {"clearance_outer_mm", &data.clearance_outer_mm},
                                                                     {"clearance_canal_mm", &data.clearance_canal_mm},
                                                                     {"temperature_c", &data.temperature_c},
                                                                     {"cycles_per_s", &data.cycles_per_s},
                                                                     {"removed", &data.removed}}};
  for (const auto& [name, curve] : curves) {
    if (!curve->empty() && curve->size() != data.depth_mm.size()) {
      fail("drill report: expected ", data.depth_mm.size(), " values of ", name, ", one a depth, found ",
           curve->size());
    }
  }
}

/// The angle by which a direction leans, with the side it leans to: "12.3° to the right".
std::string lean(double angle_rad, std::string_view positive, std::string_view negative) {
  const std::string size = readable_number(std::abs(angle_rad) * 180.0 / std::numbers::pi, 1);
  return size == "0.0" ? size + "°" : size + "° to the " + std::string(angle_rad > 0.0 ? positive : negative);
}

std::vector<ReportRow> summary(const DrillReportData& data) {
  const DrillPath& path = data.path;
  const Vec3 direction = PathCurve(path).direction_at(0.0);
  const std::string where = path.is_curved() ? ", at its entry" : "";
  std::vector<ReportRow> rows;
  if (!path.name.empty()) rows.push_back({"Path", path.name, ""});
  rows.push_back({path.is_curved() ? "Length, along its curve" : "Length, entry to target",
                  readable_number(path.length_mm(), 1), "mm"});
  rows.push_back({"Entry (x, y, z)", position(path.entry_mm), "mm"});
  rows.push_back({"Target (x, y, z)", position(path.target_mm), "mm"});
  const double across = direction.head<2>().norm();
  if (data.bone != nullptr && data.bone->no_landmarks().empty()) {
    const Landmarks& marks = data.bone->landmarks();
    const bool is_left = (path.entry_mm - marks.origin_mm).dot(marks.left()) > 0.0;
    const PathAngles angles = path_angles(direction, marks.axes, is_left);
    rows.push_back(
        {"Convergence, to the vertebra's midline" + where, readable_number(angles.convergence_deg, 1) + "°", ""});
    rows.push_back(
        {"Inclination, to its transverse plane" + where, readable_number(angles.inclination_deg, 1) + "°", ""});
  } else if (across > 1e-6) {
    // Seen from the feet: away from the sagittal plane, whether the path runs forward or back.
    rows.push_back({"Leans in the CT's axial plane" + where,
                    lean(std::atan2(direction.x(), std::abs(direction.y())), "left", "right"), ""});
  }
  rows.push_back(
      {"Leans out of the CT's axial plane" + where, lean(std::atan2(direction.z(), across), "head", "feet"), ""});
  const std::vector<ReportRow> of_tool = tool_rows(path.bit);
  rows.insert(rows.end(), of_tool.begin(), of_tool.end());
  if (data.ct != nullptr) {
    const GridGeometry& grid = data.ct->geometry;
    rows.push_back(
        {"CT, voxels",
         std::to_string(grid.size[0]) + " × " + std::to_string(grid.size[1]) + " × " + std::to_string(grid.size[2]),
         ""});
    rows.push_back({"CT, voxel size",
                    readable_number(grid.spacing_mm.x(), 3) + " × " + readable_number(grid.spacing_mm.y(), 3) + " × " +
                        readable_number(grid.spacing_mm.z(), 3),
                    "mm"});
    if (!data.ct->source_hash.empty()) rows.push_back({"CT, fingerprint", data.ct->source_hash, ""});
  }
  const auto add = [&](const char* name, double value, int decimals, const char* unit) {
    if (std::isfinite(value)) rows.push_back({name, readable_number(value, decimals), unit});
  };
  add("Median CT number of the bone removed", spread(data.hu).median, 0, "HU");
  add("Median density of the bone removed", spread(data.density_g_cm3).median, 2, "g/cm³");
  add("Max thrust", spread(data.thrust_n).max, 1, "N");
  add("Max torque", spread(data.torque_n_mm).max, 0, "N·mm");
  add("Min clearance to the outer surface", spread(data.clearance_outer_mm).min, 2, "mm");
  add("Min clearance to the canal", spread(data.clearance_canal_mm).min, 2, "mm");
  add("Max temperature beside the hole, while drilling", spread(data.temperature_c).max, 1, "°C");
  add("Slowest cycles", spread(data.cycles_per_s).min, 0, "cycles/s");
  return rows;
}

void add_slices(const DrillReportData& data, HtmlReport& report) {
  report.add_heading("CT with the planned hole");
  report.add_text(
      "Planes through the middle of the path, bone window (level 500, width 1,800 HU), all at one scale. Blue and "
      "solid: "
      "where the plane cuts the bit at the target, at its true width. Dashed: the bit projected onto the plane. Axial "
      "is "
      "seen from the feet, coronal from the front, sagittal from the patient's left. Yellow: the bone's surface; pink: "
      "the canal's wall.");
  SliceScene scene;
  scene.path = data.path;
  scene.path.screw.reset();  // what is drilled
  OutlinedBone outline;
  if (data.bone != nullptr) {
    outline = outlined(*data.bone);
    scene.bone = &outline;
  }
  report.add_svgs(path_slices(*data.ct, scene, data.bone_bounds_mm));
}

class DepthPlots {
 public:
  DepthPlots(const DrillReportData& data, HtmlReport& report) : data_(data), report_(report) {}

  Plot plot(const std::string& title, const std::string& y_label, const std::string& y_unit, const Curve& y) const {
    Plot plot;
    plot.title = title;
    plot.x_label = "depth of the tip";
    plot.x_unit = "mm";
    plot.y_label = y_label;
    plot.y_unit = y_unit;
    if (y.size() < 4 * kDepthBins) {
      plot.series = {{y_label, data_.depth_mm, y}};
    } else {  // a thousand cycles a mm would be a thick blur
      const DepthBins bins = bin_by_depth(data_.depth_mm, y, kDepthBins);
      plot.series = {{"median", bins.depth, bins.median}};
      plot.bands = {{"min to max", bins.depth, bins.min, bins.max}};
    }
    plot.markers = {{0.0, "Entry"}, {data_.path.length_mm(), "Target"}};
    const Spread depths = spread(data_.depth_mm);  // all panels reach as far
    plot.x_low = depths.min;
    plot.x_high = depths.max;
    plot.height = kDrillPlotHeight;
    return plot;
  }

  void add(const std::string& title, const std::string& y_label, const std::string& y_unit, const Curve& y,
           bool from_zero = true) {
    if (y.empty()) return;
    Plot panel = plot(title, y_label, y_unit, y);
    panel.y_from_zero = from_zero;
    report_.add_svg(svg_plot(panel));
  }

  /// With the states of drilling, and shaded between two more curves, where they are.
  void add_force(const std::string& title, const std::string& y_label, const std::string& y_unit, const Curve& y,
                 const Curve& low, const Curve& high) {
    if (y.empty()) return;
    Plot panel = plot(title, y_label, y_unit, y);
    if (!low.empty() && !high.empty()) {
      panel.series.front().name = "the law's";
      panel.bands = {{"5 to 95 % of sources", panel.series.front().x, binned(low), binned(high)}};
    }
    mark_states(panel);
    panel.y_from_zero = true;
    report_.add_svg(svg_plot(panel));
  }

 private:
  /// As plot() has its curve: by bins where there are many values.
  Curve binned(const Curve& y) const {
    return y.size() < 4 * kDepthBins ? y : bin_by_depth(data_.depth_mm, y, kDepthBins).median;
  }

  /// Where states begin takes the place of the entry, which is where the first does.
  void mark_states(Plot& panel) const {
    std::vector<PlotMarker> states = state_markers(data_.events);
    if (states.empty()) return;
    states.push_back(panel.markers.back());
    std::sort(states.begin(), states.end(), [](const PlotMarker& a, const PlotMarker& b) { return a.x < b.x; });
    panel.markers = std::move(states);
  }

  const DrillReportData& data_;
  HtmlReport& report_;
};

/// Nothing of a curve without a finite value: a bone without that wall needs no panel that says so.
Curve where_known(const Curve& values) { return std::isfinite(spread(values).max) ? values : Curve(); }

void add_speed(const DrillReportData& data, HtmlReport& report) {
  if (data.cycles_per_s.empty()) return;
  const Spread speed = spread(data.cycles_per_s);
  Plot plot = DepthPlots(data, report).plot("Speed of the cycles", "cycles per second", "", data.cycles_per_s);
  plot.log_y = speed.min > 0.0 && speed.max > 20.0 * speed.min;
  plot.y_from_zero = true;
  plot.height = 300.0;
  report.add_heading("Speed along the depth");
  std::string caption;
  if (std::isfinite(speed.min)) {
    caption = "Slowest " + readable_number(speed.min, 0) + ", median " + readable_number(speed.median, 0) +
              " cycles per second; haptic devices ask for " + readable_number(kHapticRate, 0) + ".";
  }
  report.add_svg(svg_plot(plot), caption);
}

}  // namespace

std::vector<ReportRow> tool_rows(const DrillBit& bit) {
  const auto by = [](double a, double b) { return readable_number(a, 1) + " × " + readable_number(b, 1); };
  if (bit.is_plate()) {
    const bool is_saw = bit.stroke_mm > 0.0;
    std::vector<ReportRow> rows{{is_saw ? "Saw, width × thickness × length" : "Osteotome, width × thickness × length",
                                 by(bit.diameter_mm, bit.thickness_mm) + " × " + readable_number(bit.length_mm, 1),
                                 "mm"}};
    if (is_saw) rows.push_back({"Saw, stroke", readable_number(bit.stroke_mm, 1), "mm"});
    return rows;
  }
  const bool is_profile = bit.shape == BitShape::profile;
  return {{"Bit, diameter × length", by(bit.diameter_mm, bit.length_mm), "mm"},
          {is_profile ? "Bit, from its tip to its widest place" : "Bit, conical tip",
           readable_number(bit.tip_length_mm, 1), "mm"}};
}

std::string drill_report(const DrillReportData& data) {
  check(data);
  HtmlReport report(data.title);
  report.add_made(data.date, data.command);
  report.add_heading("Summary");
  report.add_table(summary(data));
  for (const std::string& note : data.notes) report.add_note(note);
  if (data.ct != nullptr) add_slices(data, report);
  if (!data.renders.empty()) {
    report.add_heading("The bone before and after");
    report.add_pictures(data.renders);
  }
  if (!data.hu.empty() || !data.density_g_cm3.empty() || !data.thrust_n.empty() || !data.removed.empty()) {
    report.add_heading("Forces, bone and clearances along the depth");
    DepthPlots plots(data, report);
    plots.add_force("Thrust", "thrust", "N", data.thrust_n, data.p05_thrust_n, data.p95_thrust_n);
    plots.add_force("Torque", "torque", "N·mm", data.torque_n_mm, data.p05_torque_n_mm, data.p95_torque_n_mm);
    plots.add("Lateral force", "lateral force", "N", data.lateral_n);
    plots.add("CT number of the bone removed", "CT number", "HU", data.hu);
    plots.add("Density of the bone removed", "density", "g/cm³", data.density_g_cm3);
    plots.add("Clearance to the outer surface, beyond the entry opening", "clearance", "mm",
              where_known(data.clearance_outer_mm));
    plots.add("Clearance to the canal", "clearance", "mm", where_known(data.clearance_canal_mm));
    plots.add("Hottest bone " + readable_number(data.heat_distance_mm, 2) + " mm from the wall", "temperature", "°C",
              where_known(data.temperature_c), false);
    if (data.has_voxels) {
      plots.add("Voxels removed at each step", "voxels", "", data.removed);
    } else {
      plots.add("Points removed at each step", "points", "", data.removed);
    }
  }
  if (data.fixation) {
    report.add_heading("The screw that the hole is for");
    report.add_table(fixation_rows(*data.fixation));
    report.add_svg(svg_plot(insertion_torque_plot(*data.fixation)));
  }
  add_events(data.events, data.events_lost, report);
  if (data.real_time) add_real_time(*data.real_time, report);
  add_speed(data, report);
  if (!data.figures.empty()) {
    report.add_heading("Figures");
    report.add_table(data.figures);
  }
  return report.html();
}

}  // namespace spinaltap
