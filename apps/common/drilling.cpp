#include "apps/common/drilling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "apps/common/bone_path.h"
#include "core/base/error.h"
#include "core/drill/volume_segments.h"
#include "vdb/subtract_bit.h"

namespace spinaltap {
namespace {

std::vector<DepthRow> rows_of(const std::vector<CycleRecord>& records, const LockStepMotion& motion,
                              const Material& material, double log_step_mm) {
  std::vector<DepthRow> rows;
  std::int64_t hu_sum = 0;
  double work_n_mm = 0.0;
  double seconds = 0.0;
  double begin_mm = motion.depth_mm(0);
  DepthRow row;
  for (std::size_t cycle = 0; cycle < records.size(); ++cycle) {
    const CycleRecord& record = records[cycle];
    ++row.cycles;
    row.removed += record.removed;
    row.tested += record.tested;
    hu_sum += record.removed_hu;
    work_n_mm += static_cast<double>(record.work_n_mm);
    seconds += 1e-9 * record.wall_ns;
    // Rows end at whole multiples of the log step, whatever the advance; half a nanometre forgives rounding.
    const double end_mm = motion.depth_mm(0) + log_step_mm * static_cast<double>(rows.size() + 1) - 5e-7;
    if (record.depth_mm < end_mm && cycle + 1 < records.size()) continue;
    row.depth_mm = record.depth_mm;
    row.hu = row.removed > 0 ? static_cast<double>(hu_sum) / static_cast<double>(row.removed)
                             : std::numeric_limits<double>::quiet_NaN();
    row.density_g_cm3 = row.removed > 0 ? material.density.density_g_cm3(row.hu) : row.hu;
    row.thrust_n = work_n_mm / (record.depth_mm - begin_mm);
    row.cycles_per_s = static_cast<double>(row.cycles) / std::max(seconds, 1e-12);
    rows.push_back(row);
    begin_mm = record.depth_mm;
    row = {};
    hu_sum = 0;
    work_n_mm = 0.0;
    seconds = 0.0;
  }
  return rows;
}

BoneSampler sampler_of(const BoneModel& bone, const ScalarField* exact) {
  return [&bone, exact](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    bone.sample(points_mm, distance_mm, hu);
    if (exact == nullptr) return;
    std::vector<double> values_mm(points_mm.size());
    exact->evaluate(points_mm, values_mm, {});
    std::transform(values_mm.begin(), values_mm.end(), distance_mm.begin(),
                   [](double value_mm) { return static_cast<float>(value_mm); });
  };
}

std::vector<PointVolume> volumes_along(const BoneModel& bone, const DrillPath& path, const DrillingOptions& options) {
  if (options.fine_spacing_mm == 0.0) {
    std::vector<PointVolume> one;
    one.emplace_back(path, options.volume);
    return one;
  }
  return make_segments(
      path,
      fine_near_surface(path, options.volume.lead_in_mm, sampler_of(bone, nullptr), options.fine_near_mm,
                        options.fine_tip_mm, options.fine_spacing_mm, options.volume.spacing_mm),
      options.volume);
}

}  // namespace

Drilling drill_bone(const BoneModel& bone, const DrillPath& path, const Material& material,
                    const DrillingOptions& options, const Progress& progress) {
  if (!(options.log_step_mm > 0.0)) fail("drilling: expected a log step above 0 mm, found ", options.log_step_mm);
  const LockStepMotion motion(path, options.volume.lead_in_mm, options.motion);
  check_path_meets_bone(path, bone);
  Drilling drilling(bone);
  drilling.volumes = volumes_along(bone, path, options);
  std::vector<std::unique_ptr<DrillEngine>> engines;
  std::size_t bytes = 0;
  for (PointVolume& volume : drilling.volumes) {
    fill_volume(volume, sampler_of(bone, options.exact), progress);
    drilling.points += volume.point_count();
    drilling.points_in_bone += volume.alive_count();
    drilling.discs += volume.disc_count();
    bytes += volume.memory_bytes();
    engines.push_back(make_engine(options.engine, volume, path.bit, material));
  }
  drilling.points_per_disc = drilling.volumes.front().pattern().point_count();
  const auto engine = make_joint_engine(std::move(engines));
  bytes += engine->memory_bytes();
  drilling.bytes_per_point = static_cast<double>(bytes) / static_cast<double>(drilling.points);
  const std::vector<CycleRecord> records = run_lock_step(*engine, motion, progress);
  drilling.cycles = records.size();
  drilling.entry_depth_mm = std::numeric_limits<double>::quiet_NaN();
  for (const CycleRecord& record : records) {
    if (record.removed > 0 && std::isnan(drilling.entry_depth_mm)) drilling.entry_depth_mm = record.depth_mm;
    drilling.seconds += 1e-9 * record.wall_ns;
    drilling.removed += record.removed;
  }
  drilling.rows = rows_of(records, motion, material, options.log_step_mm);
  for (const DepthRow& row : drilling.rows) drilling.most_thrust_n = std::max(drilling.most_thrust_n, row.thrust_n);
  drilling.drilled = subtract_bit(bone, path.bit, motion.pose(0), motion.pose(motion.cycle_count()));
  return drilling;
}

std::string log_csv(const std::vector<DepthRow>& rows) {
  std::ostringstream csv;
  csv.precision(7);
  csv << "depth_mm,cycles,removed_points,tested_points,mean_hu,density_g_cm3,thrust_N,cycles_per_s\n";
  const auto number = [&](double value) {
    csv << ',';
    if (std::isfinite(value)) csv << value;  // an empty field is what pandas reads as missing
  };
  for (const DepthRow& row : rows) {
    csv << row.depth_mm << ',' << row.cycles << ',' << row.removed << ',' << row.tested;
    number(row.hu);
    number(row.density_g_cm3);
    number(row.thrust_n);
    number(row.cycles_per_s);
    csv << '\n';
  }
  return csv.str();
}

}  // namespace spinaltap
