#include "core/session/drill_session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/points/bone_points.h"
#include "core/session/detail/live_heat.h"
#include "core/session/detail/session_watch.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

/// A sum that is rounded once, however many terms it has (Neumaier 1974): a session's clock does not drift.
class ExactSum {
 public:
  void add(double term) noexcept {
    const double sum = sum_ + term;
    rest_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const noexcept { return sum_ + rest_; }

 private:
  double sum_ = 0.0;
  double rest_ = 0.0;
};

/// The input's pose with a unit axis, where it makes sense and engines reach.
std::optional<Pose> reachable_pose(const ToolInput& input, const DrillBit& bit, const Vec3& near_mm) noexcept {
  constexpr double kEnginesReachMm = 1e4;
  const std::optional<Pose> pose = valid_pose(input.pose, bit);
  return pose && (pose->tip_mm - near_mm).cwiseAbs().maxCoeff() < kEnginesReachMm ? pose : std::nullopt;
}

bool is_sound_time(double dt_s) noexcept {
  constexpr double kLongestS = 3600.0;
  return dt_s > 0.0 && dt_s < kLongestS;
}

/// The rules with the cancellous density of the bone that a path is planned through, which whoever drills has seen in
/// its CT: the median 5 mm from both ends. As they are where there is not enough of it.
StateRules rules_for(const DrillPath& path, const OccupiedBone& bone, StateRules rules) {
  constexpr double kStepMm = 0.25, kFromEndsMm = 5.0;
  constexpr auto kEnough = static_cast<std::size_t>(5.0 / kStepMm);
  const auto at_ends = static_cast<std::size_t>(kFromEndsMm / kStepMm);
  const PathCurve curve(path);
  std::vector<double> density_g_cm3;
  for (double along_mm = kFromEndsMm; along_mm < curve.length_mm(); along_mm += kStepMm) {
    const OccupiedBone::Bone* const at = bone.occupied_at(bone.frame().to_path(curve.pose_at(along_mm)).tip_mm);
    if (at != nullptr) density_g_cm3.push_back(at->density_g_cm3);
  }
  if (density_g_cm3.size() < kEnough + at_ends) return rules;
  density_g_cm3.resize(density_g_cm3.size() - at_ends);
  const auto middle = density_g_cm3.begin() + static_cast<std::ptrdiff_t>(density_g_cm3.size() / 2);
  std::nth_element(density_g_cm3.begin(), middle, density_g_cm3.end());
  rules.cancellous_g_cm3 = std::clamp(*middle, rules.contact_g_cm3, rules.cortical_g_cm3);
  return rules;
}

std::unique_ptr<const OccupiedBone> checked(std::unique_ptr<const OccupiedBone> bone) {
  if (!bone) fail("session: expected a bone to drill, found none");
  return bone;
}

}  // namespace

void check_session_options(const SessionOptions& options) {
  constexpr double kFastestRpm = 1e6;
  check_state_rules(options.states);
  check_compliance(options.compliance);
  if (!(options.spindle.rpm >= 0.0 && options.spindle.rpm <= kFastestRpm)) {
    fail("session: expected a spindle of 0 to ", kFastestRpm, " turns a minute, found ", options.spindle.rpm);
  }
  if (!(options.stop.thrust_n > 0.0)) {
    fail("session: expected a thrust above 0 N to stop at, found ", options.stop.thrust_n, " N");
  }
  if (std::isnan(options.stop.clearance_mm)) fail("session: expected a clearance to stop at, found no number");
  if (!(options.max_jump_mm > 0.0)) {
    fail("session: expected a longest jump above 0 mm, found ", options.max_jump_mm, " mm");
  }
  if (options.has_device && !options.has_support) {
    fail("session: expected the support of the hole's wall with a device, which a tool is held by, found none");
  }
  if (!options.has_path && options.follows_path) fail("session: expected a path to follow, found none");
  if (options.heat) {
    check_heat_options(*options.heat);
    if (!options.follows_path) fail("session: expected no heat with a milling: only a hole along the path has it");
  }
}

struct DrillSession::Tracking {
  Tracking(const DrillPath& path, const OccupiedBone& bone, const SessionOptions& options, bool has_clearances)
      : bit(tool_body(path.bit)), curve(path), watch(path, bone, options, has_clearances) {
    if (options.heat) heat.emplace(path, *options.heat);
    if (options.compliance.is_on) compliant.emplace(path.bit, options.compliance);
  }
  /// Another tool, from nowhere.
  void take_tool(const DrillBit& tool, const SessionOptions& options) {
    bit = tool_body(tool);
    watch.take_tool(tool);
    if (options.compliance.is_on) compliant.emplace(tool, options.compliance);
    met = {};
    waiting_s = 0.0;
    is_placed = was_on = false;
    ++tools;
  }

  std::size_t tools = 0;  ///< that came after the first
  ToolBody bit;
  PathCurve curve;
  SessionWatch watch;
  std::optional<LiveHeat> heat;
  EventLog log{kMaxEvents};
  ExactSum time;
  std::optional<CompliantTool> compliant;
  CompliantTool::Met met;  ///< by it
  Pose pose;               ///< the last that made sense
  Pose commanded;          ///< likewise; of a compliant tool it is another
  double waiting_s = 0.0;  ///< since then, in cycles that were rejected
  bool is_placed = false;
  bool was_on = false;  ///< the spindle
  bool has_begun = false;
};

DrillSession::DrillSession(const DrillPath& path, std::unique_ptr<const OccupiedBone> bone,
                           std::unique_ptr<DrillEngine> engine, const Material& material,
                           const ClearanceField* clearances, const SessionOptions& options)
    : path_(path),
      bone_(checked(std::move(bone))),
      engine_(std::move(engine)),
      material_(material),
      options_(options),
      forces_(forces_for(path.bit)),
      clearances_(clearances),
      states_(options.states) {
  check_path(path);
  check_session_options(options);
  if (options.follows_path) states_ = StateRecogniser(rules_for(path, *bone_, options.states));
  if (!bone_->has_occupied()) {
    fail_as(ErrorKind::geometry, "path ", in_quotes(path.name),
            ": expected bone around it, found none: it misses the bone, or all is drilled away");
  }
  if (options.has_path) bone_->check_within(path);
  if (!engine_) fail("session: expected a drilling engine, found none");
  tracking_ = std::make_unique<Tracking>(path, *bone_, options, clearances != nullptr);
  if (tracking_->heat) cycle_.heat = tracking_->heat->begin();
}

DrillSession::DrillSession(const DrillPath& path, std::span<PointVolume> volumes, std::unique_ptr<DrillEngine> engine,
                           const Material& material, const ClearanceField* clearances, const SessionOptions& options)
    : DrillSession(path, std::make_unique<BonePoints>(volumes, material), std::move(engine), material, clearances,
                   options) {}

DrillSession::~DrillSession() = default;

DrillForces DrillSession::forces_for(const DrillBit& bit) const {
  DrillForces forces(*bone_, bit, material_);
  if (options_.has_device) forces.report_contact();
  if (!options_.has_support) forces.leave_out_support();
  return forces;
}

void DrillSession::set_tool(const DrillBit& bit, std::unique_ptr<DrillEngine> engine) {
  check_bit(bit);
  if (options_.has_path) {
    DrillPath path = path_;
    path.bit = bit;
    check_path(path);
  }
  if (!engine) fail("session: expected a drilling engine for the tool, found none");
  if (options_.heat) fail("session: expected one tool where heat is worked out, found a change of tools");
  DrillForces forces = forces_for(bit);
  tracking_->take_tool(bit, options_);
  forces_ = std::move(forces);
  engine_ = std::move(engine);
  path_.bit = bit;
  tracking_->log.add({EventKind::tool_change, tracking_->has_begun ? cycle_.index + 1 : 0, cycle_.time_s,
                      cycle_.depth_mm, tracking_->pose.tip_mm, static_cast<double>(tracking_->tools)});
}

std::span<const SessionEvent> DrillSession::events() const { return tracking_->log.events(); }
std::size_t DrillSession::events_lost() const { return tracking_->log.lost(); }
bool DrillSession::is_stopped() const { return tracking_->watch.is_stopped(); }

ToolFeedback DrillSession::feedback() const noexcept {
  const bool is_in_bone = std::isfinite(cycle_.tip.inside_mm) && cycle_.tip.inside_mm > 0.0;
  return {cycle_.time_s, cycle_.force, is_stopped(), is_in_bone || cycle_.force.tip_density_g_cm3 > 0.0};
}

void DrillSession::end(OperatorEnd end) noexcept {
  if (end == OperatorEnd::as_planned) return;
  tracking_->log.add({EventKind::gave_up, cycle_.index, cycle_.time_s, cycle_.depth_mm, tracking_->pose.tip_mm,
                      std::max(0.0, tracking_->curve.length_mm() - cycle_.depth_mm)});
}

void DrillSession::place(const Pose& pose, const ToolInput& input) noexcept {
  Tracking& tracking = *tracking_;
  if (tracking.is_placed) {
    const double longest_mm = max_displacement_mm(tracking.pose, pose, tool_length_mm(tracking.bit));
    if (longest_mm > options_.max_jump_mm) {
      engine_->reset_motion();
      forces_.reset();
      tracking.watch.jump(cycle_, pose, longest_mm, tracking.log);
    }
  }
  Spindle spindle = options_.spindle;
  if (!input.spindle_on) spindle.rpm = 0.0;
  if (tracking.compliant) {
    const bool was_stalled = tracking.compliant->is_stalled();
    spindle = tracking.compliant->real_spindle(spindle, tracking.met, input.dt_s);
    if (tracking.compliant->is_stalled() && !was_stalled) {
      tracking.watch.stall(cycle_, pose, tracking.met.force.torque_n_mm, tracking.log);
    }
  }
  const bool is_on = spindle.rpm > 0.0;
  if (is_on) {
    // On its way with the spindle off the bit cut nothing. What it holds when the spindle starts it cut on no way.
    if (!tracking.was_on) {
      engine_->reset_motion();
      forces_.reset();
    }
    cycle_.step = engine_->step(pose);
  }
  tracking.was_on = is_on;
  const double dt_s = input.dt_s + tracking.waiting_s;
  tracking.waiting_s = 0.0;
  cycle_.force = forces_.update(cycle_.step, pose, dt_s, spindle);
  if (clearances_ != nullptr) {
    if (const auto* profile = std::get_if<BitProfile>(&tracking.bit))
      cycle_.clearance = clearances_->of(*profile, pose);
    if (const auto* plate = std::get_if<PlateBox>(&tracking.bit)) cycle_.clearance = clearances_->of(*plate, pose);
  }
  if (clearances_ != nullptr && options_.follows_path) cycle_.tip = clearances_->tip_at(pose);
  if (is_on && options_.follows_path) {
    TipMeets meets{.depth_mm = cycle_.depth_mm, .density_g_cm3 = cycle_.force.tip_density_g_cm3};
    if (clearances_ != nullptr) meets.ahead_mm = cycle_.tip.ahead_mm;
    cycle_.state = states_.update(meets);
  }
  tracking.watch.update(cycle_, pose, states_.begin_mm(), is_on, tracking.log);
  if (tracking.heat) cycle_.heat = tracking.heat->update(cycle_, dt_s, spindle.rpm, tracking.log);
  tracking.pose = pose;
  tracking.is_placed = true;
  if (!tracking.compliant) return;
  tracking.met.force = cycle_.force;
  if (clearances_ == nullptr) return;
  tracking.met.tip = options_.follows_path || !options_.has_path ? cycle_.tip : clearances_->tip_at(pose);
  tracking.met.into_bone = clearances_->into_bone_at(pose.tip_mm);
}

/// Without a path: by the bone's surface.
void DrillSession::tell_depth() noexcept {
  if (clearances_ == nullptr) return;
  cycle_.tip = clearances_->tip_at(cycle_.pose);
  cycle_.depth_mm =
      std::isfinite(cycle_.tip.inside_mm) ? cycle_.tip.inside_mm : -std::numeric_limits<double>::infinity();
}

/// Where the bit is while its chuck is held for `commanded`.
Pose DrillSession::bent(const Pose& commanded, double dt_s) noexcept {
  Tracking& tracking = *tracking_;
  if (!tracking.compliant) return commanded;
  if (tracking.is_placed) {
    tracking.met.advance_mm = (commanded.tip_mm - tracking.commanded.tip_mm).dot(commanded.axis);
  }
  tracking.commanded = commanded;
  return tracking.compliant->real_pose(commanded, tracking.met, dt_s);
}

const Cycle& DrillSession::step(const ToolInput& input) noexcept {
  Tracking& tracking = *tracking_;
  const bool has_time = is_sound_time(input.dt_s);
  if (tracking.has_begun) {
    ++cycle_.index;
    if (has_time) tracking.time.add(input.dt_s);
  }
  tracking.has_begun = true;
  cycle_.time_s = tracking.time.value();
  cycle_.input = input;
  cycle_.step = {};
  cycle_.force = {};
  cycle_.heat.bone_w = 0.0;
  tracking.watch.watch_device(cycle_, tracking.log);
  const std::optional<Pose> pose = reachable_pose(input, path_.bit, path_.entry_mm);
  if (pose && has_time) {
    cycle_.pose = bent(*pose, input.dt_s);
    if (options_.has_path) {
      cycle_.depth_mm = tracking.curve.nearest_mm(cycle_.pose.tip_mm);
    } else {
      tell_depth();
    }
    place(cycle_.pose, input);
  } else {
    if (has_time && tracking.is_placed) tracking.waiting_s += input.dt_s;
    tracking.watch.reject(cycle_, tracking.log);
  }
  return cycle_;
}

void run_session(DrillSession& session, Operator& tool_operator, const CycleObserver& observe,
                 const Progress& progress) {
  constexpr std::size_t kCyclesAReport = 256;
  const std::size_t expected = tool_operator.count();
  const double length_mm = session.path().length_mm();
  std::size_t done = 0;
  while (const std::optional<ToolInput> input = tool_operator.next(session.feedback())) {
    if (done++ % kCyclesAReport == 0) {
      const double share = expected > 0 ? static_cast<double>(done) / static_cast<double>(expected)
                                        : session.last().depth_mm / length_mm;
      progress.report("drilling", std::clamp(share, 0.0, 1.0));
    }
    const Cycle& cycle = session.step(*input);
    if (observe) observe(cycle);
  }
  session.end(tool_operator.end());
  progress.report("drilling", 1.0);
}

}  // namespace spinaltap
