#include "vdb/sim/drilling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/session/cutting_motion.h"
#include "core/session/real_time/timing.h"
#include "core/tool/path_curve.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/hole_cutter.h"

namespace spinaltap {
namespace {

/// What was done, kept in memory that is there from the start: the collision thread must not wait for more.
template <class Row>
class RowLog {
 public:
  explicit RowLog(std::size_t expected) : rows_(expected) {}

  void add(const Row& row) {
    if (used_ < rows_.size()) {
      rows_[used_] = row;
    } else {
      rows_.push_back(row);
    }
    ++used_;
  }
  std::span<const Row> rows() const { return {rows_.data(), used_}; }

 private:
  std::vector<Row> rows_;
  std::size_t used_ = 0;
};

/// Of every cycle: what went in, and the heat that the bone got.
struct CycleLog {
  CycleLog(std::size_t expected, bool has_heat) : inputs(expected), bone_w(has_heat ? expected : 0) {}

  RowLog<ToolInput> inputs;
  RowLog<double> bone_w;
};

std::vector<HeatStep> steps_of(const CycleLog& log) {
  std::vector<HeatStep> steps;
  steps.reserve(log.bone_w.rows().size());
  for (std::size_t n = 0; n < log.bone_w.rows().size(); ++n) {
    const ToolInput& input = log.inputs.rows()[n];
    steps.push_back({input.pose, input.dt_s, log.bone_w.rows()[n]});
  }
  return steps;
}

std::size_t expected_inputs(const Operator& tool_operator, const std::optional<RealTimeOptions>& real_time) {
  constexpr std::size_t kMax = 4'000'000;  // 256 MB; what comes then is allocated when it comes
  std::size_t expected = tool_operator.count() > 0 ? tool_operator.count() + 1 : kMax;
  if (real_time) {
    const double cycles = real_time->longest_s * real_time->rate_hz + 2.0;
    expected = static_cast<std::size_t>(std::min(static_cast<double>(expected), cycles));
  } else if (tool_operator.count() == 0) {
    expected = 0;
  }
  return std::min(expected, kMax);
}

void count_points(const BuiltSession& built, Drilling& drilling) {
  const DrilledBone& bone = built.bone;
  drilling.points_in_bone = bone.occupied_count();
  if (bone.voxels) drilling.points = drilling.points_in_bone;
  for (const PointVolume& volume : bone.volumes) {
    drilling.points += volume.point_count();
    drilling.discs += volume.disc_count();
  }
  if (!bone.volumes.empty()) drilling.points_per_disc = bone.volumes.front().pattern().point_count();
  const std::size_t bytes = built.session->engine().memory_bytes() + bone.memory_bytes();
  drilling.bytes_per_point = static_cast<double>(bytes) / static_cast<double>(drilling.points);
}

/// The pose that got furthest along the path.
Pose deepest_pose(std::span<const ToolInput> inputs, const DrillPath& path) {
  const PathCurve curve(path);
  if (inputs.empty()) return {path.target_mm, curve.direction_at(curve.length_mm())};
  const ToolInput* deepest = nullptr;
  double deepest_mm = 0.0;
  for (const ToolInput& input : inputs) {
    const double depth_mm = curve.nearest_mm(input.pose.tip_mm);
    if (deepest != nullptr && !(deepest_mm < depth_mm)) continue;
    deepest = &input;
    deepest_mm = depth_mm;
  }
  return deepest->pose;
}

/// Watches a session's cycles, on the thread that runs them.
class Watch {
 public:
  Watch(const DrillSession& session, const DrillingOptions& options, DepthLog& log, CycleLog& cycles,
        Drilling& drilling)
      : session_(session), options_(options), log_(log), cycles_(cycles), drilling_(drilling) {}

  void observe(const Cycle& cycle) {
    const bool is_paced = options_.real_time.has_value();
    const double seconds =
        is_paced ? std::numeric_limits<double>::quiet_NaN() : 1e-9 * static_cast<double>(wall_ns() - before_ns_);
    log_.add(cycle, seconds);
    cycles_.inputs.add(cutting_input(cycle, session_.options()));
    if (session_.options().heat) cycles_.bone_w.add(cycle.heat.bone_w);
    drilling_.heat = cycle.heat;
    drilling_.removed += cycle.step.removed;
    if (is_first_) {
      is_first_ = false;
    } else {
      ++drilling_.cycles;
      drilling_.seconds += seconds;
    }
    drilling_.session_s = cycle.time_s;
    drilling_.deepest_mm = std::fmax(drilling_.deepest_mm, cycle.depth_mm);
    drilling_.min_clearance_outer_mm = std::fmin(drilling_.min_clearance_outer_mm, cycle.clearance.outer_mm);
    drilling_.min_clearance_canal_mm = std::fmin(drilling_.min_clearance_canal_mm, cycle.clearance.canal_mm);
    drilling_.max_thrust_n = std::max(drilling_.max_thrust_n, cycle.force.thrust_n);
    drilling_.max_torque_n_mm = std::max(drilling_.max_torque_n_mm, cycle.force.torque_n_mm);
    const double off_mm = (cycle.pose.tip_mm - cycle.input.pose.tip_mm).norm();
    if (session_.options().compliance.is_on && off_mm > drilling_.max_off_mm) drilling_.max_off_mm = off_mm;
    drilling_.max_contact_n = std::max(drilling_.max_contact_n, cycle.force.contact_n.norm());
    if (cycle.step.removed > 0 && std::isnan(drilling_.entry_depth_mm)) drilling_.entry_depth_mm = cycle.depth_mm;
    if (options_.record != nullptr) record(cycle, is_paced);
    before_ns_ = is_paced ? 0 : wall_ns();
  }

 private:
  void record(const Cycle& cycle, bool is_paced) {
    if (is_paced) {
      options_.record->add(cycle);  // where it is lost, the record counts it
    } else {
      options_.record->add_waiting(cycle);
    }
    options_.record->add_events(session_.events());
  }

  const DrillSession& session_;
  const DrillingOptions& options_;
  DepthLog& log_;
  CycleLog& cycles_;
  Drilling& drilling_;
  bool is_first_ = true;
  std::int64_t before_ns_ = wall_ns();
};

}  // namespace

Drilling drill_bone(const Bone& bone, const SessionSetup& setup, Operator& tool_operator,
                    const DrillingOptions& options, const Progress& progress) {
  return drill_bone(std::span(&bone, 1), setup, tool_operator, options, progress);
}

Drilling drill_bone(std::span<const Bone> bones, const SessionSetup& setup, Operator& tool_operator,
                    const DrillingOptions& options, const Progress& progress) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kBeyondMm = 20.0;  // operators may go further than the target
  DepthLog log(options.log_step_mm, setup.material, setup.volume.lead_in_mm + setup.path.length_mm() + kBeyondMm);
  BuiltSession built = build_session(bones, setup, progress, options.exact);
  DrillSession& session = *built.session;
  Drilling drilling(bones.front().model());
  count_points(built, drilling);
  drilling.entry_depth_mm = std::numeric_limits<double>::quiet_NaN();
  drilling.deepest_mm = -kInfinity;
  drilling.min_clearance_outer_mm = kInfinity;
  drilling.min_clearance_canal_mm = kInfinity;

  std::vector<PointSplats> splats;
  if (options.makes_splats) {
    for (const PointVolume& volume : built.bone.volumes) splats.emplace_back(volume, BoneField(bones.front().model()));
  }
  CycleLog cycles(expected_inputs(tool_operator, options.real_time), setup.options.heat.has_value());
  Watch watch(session, options, log, cycles, drilling);
  const CycleObserver observe = [&](const Cycle& cycle) { watch.observe(cycle); };
  if (options.real_time) {
    drilling.real_time =
        run_real_time(session, tool_operator, *options.real_time, observe, options.display, {}, progress);
  } else {
    run_session(session, tool_operator, observe, progress);
  }

  drilling.is_stopped = session.is_stopped();
  drilling.operator_end = tool_operator.end();
  drilling.events.assign(session.events().begin(), session.events().end());
  drilling.events_lost = session.events_lost();
  drilling.rows = log.finish();
  drilling.heat_steps = steps_of(cycles);
  const std::span<const ToolInput> inputs = cycles.inputs.rows();
  progress.report("cutting the hole", 0.0);
  for (const Bone& bone : bones) {
    HoleCutter cutter(bone.model());
    for (const DrilledHole& hole : setup.holes) cutter.add(hole);
    const bool is_first = &bone == &bones.front();
    if (is_first) drilling.before = cutter.bone();
    cutter.take_bit(setup.path.bit, setup.options.max_jump_mm);
    cutter.add(inputs);
    if (is_first) {
      drilling.drilled = cutter.bone();
    } else {
      drilling.further_drilled.push_back(cutter.bone());
    }
  }
  for (std::size_t n = 0; n < splats.size(); ++n) {
    splats[n].update(built.bone.volumes[n], setup.path.bit, deepest_pose(inputs, setup.path));
    drilling.splats.insert(drilling.splats.end(), splats[n].splats().begin(), splats[n].splats().end());
  }
  drilling.left = std::move(built.bone);  // the points stay where the session knows them
  return drilling;
}

}  // namespace spinaltap
