#include "apps/report/operator_choice.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>
#include <vector>

#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/files/milling_file.h"
#include "core/session/device/coupled_operator.h"
#include "core/session/device/open_device.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/milling.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kOffPathMm = 1.2;  // as the workloads of docs/drilling-benchmarks.md have them
constexpr double kTiltDeg = 3.0;
constexpr double kTremorMm = 0.1;
constexpr double kFeedMmS = 1.0;
constexpr double kRateHz = 1000.0;
constexpr double kForceScale = 0.1;  // devices give some 8 N, bone 40 to 80 N

bool is_pose_file(std::string_view name) { return name.ends_with(".csv"); }

/// "1.0", or "1,5:0.5": 1 mm/s, and 0.5 mm/s from 5 mm of depth on.
std::vector<FeedStep> feed_steps(const std::string& text) {
  const auto number = [&](std::string_view part) {
    const std::optional<double> value = parse_number(part);
    if (!value) {
      fail("expected --feed in mm/s, or as MM_S,FROM_MM:MM_S,... such as 1,5:0.5; found \"", text, "\"");
    }
    return *value;
  };
  std::vector<FeedStep> steps;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t colon = part.find(':');
    FeedStep step;
    if (colon != std::string::npos) {
      step.from_mm = number(std::string_view(part).substr(0, colon));
      part.erase(0, colon + 1);
    }
    step.mm_s = number(part);
    steps.push_back(step);
  }
  if (steps.empty()) number("");
  return steps;
}

double mean_rate_hz(const std::vector<ToolInput>& inputs) {
  double seconds = 0.0;
  for (std::size_t n = 1; n < inputs.size(); ++n) seconds += inputs[n].dt_s;
  return inputs.size() > 1 ? static_cast<double>(inputs.size() - 1) / seconds : kRateHz;
}

}  // namespace

void OperatorChoice::check_device(bool is_real_time) const {
  for (const auto& [given, option] :
       {std::pair{!name.empty(), "--operator"}, std::pair{!feed.empty(), "--feed"},
        std::pair{step_mm.has_value(), "--step"}, std::pair{rate_hz.has_value(), "--rate"},
        std::pair{offset_mm.has_value(), "--offset"}, std::pair{tilt_deg.has_value(), "--tilt"},
        std::pair{tremor_mm.has_value(), "--tremor"}, std::pair{seed.has_value(), "--seed"},
        std::pair{peck_mm.has_value(), "--peck"}, std::pair{peck_pause_s.has_value(), "--peck-pause"},
        std::pair{withdraw_mm_s.has_value(), "--withdraw"}, std::pair{push_n.has_value(), "--push"},
        std::pair{max_push_n.has_value(), "--max-push"}}) {
    if (given) fail("expected no ", option, " with --device: the hand at the device moves the bit");
  }
  if (is_real_time && is_loopback_name(device)) {
    fail("expected no --real-time with --device loopback: it is simulated, and has no clock of its own");
  }
}

void OperatorChoice::check(bool is_real_time) const {
  if (has_device()) return check_device(is_real_time);
  if (force_scale) fail("expected --device with --force-scale");
  const auto reject = [&](bool given, const char* option, const char* why) {
    if (given) fail("expected no ", option, " with --operator ", name.empty() ? "on-path" : name, ": ", why);
  };
  const bool is_known = name.empty() || name == "on-path" || name == "off-path" || name == "tilted" ||
                        name == "tremor" || name == "push" || is_pose_file(name) || is_milling();
  if (!is_known) {
    fail(
        "expected --operator on-path, off-path, tilted, tremor, push or a file whose name ends in .csv (poses) or "
        ".json (a milling), found \"",
        name, "\"");
  }
  reject(name == "on-path" && offset_mm, "--offset", "take off-path");
  reject(name == "on-path" && tilt_deg, "--tilt", "take tilted");
  reject(name != "push" && push_n, "--push", "only the operator push has a force of its own");
  reject(name != "push" && max_push_n, "--max-push", "only the operator push has a force of its own");
  if (name == "push") {
    for (const auto& [given, option] :
         {std::pair{!feed.empty(), "--feed"}, std::pair{step_mm.has_value(), "--step"},
          std::pair{peck_mm.has_value(), "--peck"}, std::pair{peck_pause_s.has_value(), "--peck-pause"},
          std::pair{withdraw_mm_s.has_value(), "--withdraw"}}) {
      reject(given, option, "its feed follows from the bone");
    }
  }
  if (is_pose_file(name) || is_milling()) {
    for (const auto& [given, option] :
         {std::pair{!feed.empty(), "--feed"}, std::pair{step_mm.has_value(), "--step"},
          std::pair{offset_mm.has_value(), "--offset"}, std::pair{tilt_deg.has_value(), "--tilt"},
          std::pair{peck_mm.has_value(), "--peck"}, std::pair{peck_pause_s.has_value(), "--peck-pause"},
          std::pair{withdraw_mm_s.has_value(), "--withdraw"}}) {
      reject(given, option, "the file says where the bit goes");
    }
  }
  if (is_pose_file(name)) {
    for (const auto& [given, option] :
         {std::pair{tremor_mm.has_value(), "--tremor"}, std::pair{seed.has_value(), "--seed"}}) {
      reject(given, option, "the file says where the bit goes");
    }
    reject(rate_hz && !is_real_time, "--rate", "the file says when");
  }
  if (peck_pause_s && !peck_mm) fail("expected --peck with --peck-pause: without pecks nothing waits");
  if (step_mm && rate_hz && !feed.empty()) {
    fail("expected two of --step, --feed and --rate: a step is a feed over a rate");
  }
  if (step_mm && is_real_time) fail("expected no --step with --real-time: --feed and --rate say how far a cycle goes");
}

MotionClass OperatorChoice::motion_class() const {
  return {.max_tilt_deg = tilt_deg.value_or(name == "tilted" ? kTiltDeg : 0.0),
          .keeps_to_path = !is_milling(),
          .trembles = is_pose_file(name) || has_device() || tremor_or_default_mm() > 0.0,
          .is_free = has_device()};
}

std::vector<double> OperatorChoice::asked_feeds_mm_s() const {
  if (is_milling()) return {(milling ? *milling : read_milling(name)).feed_mm_s};
  std::vector<double> feeds_mm_s;
  if (feed.empty()) return feeds_mm_s;
  for (const FeedStep& step : feed_steps(feed)) feeds_mm_s.push_back(step.mm_s);
  return feeds_mm_s;
}

double OperatorChoice::tremor_or_default_mm() const { return tremor_mm.value_or(name == "tremor" ? kTremorMm : 0.0); }

void OperatorChoice::add_planned_motion(const DrillPath& path, const GuideLine& line, OperatorPlan& plan) const {
  PathMotionOptions motion;
  motion.line = line;
  motion.tremor_mm = tremor_or_default_mm();
  motion.seed = seed.value_or(1);
  motion.feed.steps = {{0.0, kFeedMmS}};
  if (!feed.empty()) motion.feed.steps = feed_steps(feed);
  if (step_mm) {
    // Of step, feed and rate two say the third. Without either, 1 mm/s: the same bone resists the same at any step.
    if (!(*step_mm > 0.0)) fail("expected a --step above 0 mm, found ", *step_mm);
    if (motion.feed.steps.size() > 1) fail("expected --rate in place of --step where --feed changes with depth");
    if (rate_hz) motion.feed.steps.front().mm_s = *step_mm * *rate_hz;
    motion.rate_hz = motion.feed.steps.front().mm_s / *step_mm;
  } else {
    motion.rate_hz = rate_hz.value_or(kRateHz);
  }
  motion.feed.pecking.every_mm = peck_mm.value_or(0.0);
  motion.feed.pecking.pause_s = peck_pause_s.value_or(0.0);
  motion.feed.withdraw_mm_s = withdraw_mm_s.value_or(0.0);
  plan.rate_hz = motion.rate_hz;
  plan.words["feed"] =
      motion.feed.steps.size() > 1 ? feed + " mm/s" : short_text(motion.feed.steps.front().mm_s) + " mm/s";
  if (peck_mm) plan.words["peck"] = short_text(*peck_mm) + " mm";
  if (peck_pause_s) plan.words["peck pause"] = short_text(*peck_pause_s) + " s";
  plan.tool_operator = std::make_unique<PlannedMotion>(path, motion);
}

void OperatorChoice::add_force_controlled(const DrillPath& path, const GuideLine& line, const Spindle& spindle,
                                          OperatorPlan& plan) const {
  ForceControlOptions push{.line = line,
                           .rate_hz = rate_hz.value_or(kRateHz),
                           .spindle = spindle,
                           .tremor_mm = tremor_or_default_mm(),
                           .seed = seed.value_or(1)};
  push.push_n = push_n.value_or(push.push_n);
  push.max_push_n = max_push_n.value_or(push.max_push_n);
  plan.rate_hz = push.rate_hz;
  plan.words["push"] = short_text(push.push_n) + " N";
  plan.tool_operator = std::make_unique<ForceControlled>(path, push);
}

void OperatorChoice::add_device(const DrillPath& path, double lead_in_mm, const Spindle& spindle,
                                OperatorPlan& plan) const {
  plan.device = open_device(device);
  CoupledOptions coupled{.spindle = spindle, .lead_in_mm = lead_in_mm, .end_button = kEndButton};
  coupled.coupling.force_scale = force_scale.value_or(kForceScale);
  coupled.coupling.spindle_button = kSpindleButton;
  coupled.longest_s = longest_s.value_or(coupled.longest_s);
  plan.rate_hz = plan.device->limits().rate_hz;
  plan.words["device"] = plan.device->name();
  plan.words["force scale"] = short_text(coupled.coupling.force_scale);
  plan.tool_operator = std::make_unique<CoupledOperator>(*plan.device, path, coupled);
}

void OperatorChoice::add_recorded_motion(const DrillPath& path, OperatorPlan& plan) const {
  std::vector<ToolInput> inputs = read_pose_csv(name);
  const PathCurve curve(path);
  for (const ToolInput& input : inputs) {
    const Vec3 direction = curve.direction_at(curve.nearest_mm(input.pose.tip_mm));
    const double cosine = std::clamp(input.pose.axis.dot(direction), -1.0, 1.0);
    plan.way.max_tilt_deg = std::max(plan.way.max_tilt_deg, std::acos(cosine) / kDegree);
  }
  plan.rate_hz = mean_rate_hz(inputs);
  plan.words["poses"] = std::to_string(inputs.size());
  plan.tool_operator = std::make_unique<RecordedMotion>(std::move(inputs));
}

void OperatorChoice::add_milling(const DrillPath& path, const ScalarField* bone, OperatorPlan& plan) const {
  if (bone == nullptr) fail("expected no milling here: there is no bone whose surface it could follow");
  const Milling of_file = milling ? *milling : read_milling(name);
  plan.rate_hz = rate_hz.value_or(kRateHz);
  try {
    auto motion = std::make_unique<MillingMotion>(
        of_file, path.bit, *bone,
        MillingMotionOptions{.rate_hz = plan.rate_hz, .tremor_mm = tremor_mm.value_or(0.0), .seed = seed.value_or(1)});
    plan.words["milling"] = of_file.name;
    plan.words["milled way"] = short_text(motion->length_mm()) + " mm";
    plan.words["feed"] = short_text(of_file.feed_mm_s) + " mm/s";
    plan.tool_operator = std::move(motion);
  } catch (const Error& error) {
    fail(name, ": ", error.what());
  }
}

OperatorPlan OperatorChoice::plan(const DrillPath& path, double lead_in_mm, const Spindle& spindle, bool is_real_time,
                                  const ScalarField* bone) const {
  check(is_real_time);
  OperatorPlan plan;
  plan.way = motion_class();
  plan.words["kind"] = has_device() ? "device" : name.empty() ? "on-path" : is_milling() ? "milling" : name;
  if (has_device()) {
    add_device(path, lead_in_mm, spindle, plan);
  } else if (is_pose_file(name)) {
    add_recorded_motion(path, plan);
  } else if (is_milling()) {
    add_milling(path, bone, plan);
  } else {
    const GuideLine line{.lead_in_mm = lead_in_mm,
                         .offset_mm = offset_mm.value_or(name == "off-path" ? kOffPathMm : 0.0),
                         .tilt_deg = tilt_deg.value_or(name == "tilted" ? kTiltDeg : 0.0)};
    if (line.offset_mm != 0.0) plan.words["offset"] = short_text(line.offset_mm) + " mm";
    if (line.tilt_deg != 0.0) plan.words["tilt"] = short_text(line.tilt_deg) + " degrees";
    if (tremor_or_default_mm() != 0.0) {
      plan.words["tremor"] = short_text(tremor_or_default_mm()) + " mm, seed " + std::to_string(seed.value_or(1));
    }
    if (name == "push") {
      add_force_controlled(path, line, spindle, plan);
    } else {
      add_planned_motion(path, line, plan);
    }
  }
  plan.cycle_rate_hz = is_pose_file(name) ? rate_hz.value_or(plan.rate_hz) : plan.rate_hz;
  plan.words["rate"] = short_text(plan.rate_hz) + " Hz";
  return plan;
}

}  // namespace spinaltap
