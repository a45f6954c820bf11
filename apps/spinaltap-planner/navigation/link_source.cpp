#include "apps/spinaltap-planner/navigation/link_source.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "apps/link/link_loop.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

constexpr double kLinkRateHz = 1000.0;

/// The poses that come, as an operator's.
class LinkedTool final : public Operator {
 public:
  LinkedTool(std::shared_ptr<LinkServer> server, const TrackingOptions& tracking, bool has_side)
      : server_(std::move(server)), tracking_(tracking), has_side_(has_side) {}

  /// Whether the tool's pose is known.
  bool hear() {
    LinkInput input;
    while (server_->take(input)) {
      if (input.kind == LinkInput::Kind::command) {
        if (input.command == LinkCommand::end) is_ended_ = true;
        if (input.command == LinkCommand::spindle_on) spindle_on_ = true;
        if (input.command == LinkCommand::spindle_off) spindle_on_ = false;
      } else if (input.kind == LinkInput::Kind::invalid) {
        tracking_.invalidate(input.device, input.arrival_ns);
      } else {
        tracking_.update(input.device, input.transform, input.is_valid, input.arrival_ns);
        is_new_ = is_new_ || input.device == LinkDevice::tool;
      }
    }
    const std::optional<Pose> pose = tracking_.pose(wall_ns());
    if (!pose) return false;
    pose_ = *pose;
    if (!has_side_) pose_.side = Vec3::Zero();
    return true;
  }
  bool is_ended() const { return is_ended_; }

  std::optional<ToolInput> next(const ToolFeedback& /*feedback*/) override {
    const bool is_seen = hear();
    if (is_ended_) return std::nullopt;
    ToolInput input{pose_, is_seen && was_seen_ && spindle_on_, 1.0 / kLinkRateHz};
    input.device.status = !is_seen ? DeviceStatus::lost : is_new_ ? DeviceStatus::live : DeviceStatus::silent;
    input.device.buttons = spindle_on_ ? 1U : 0U;
    input.device.pose = pose_;
    was_seen_ = is_seen;
    is_new_ = false;
    return input;
  }

 private:
  std::shared_ptr<LinkServer> server_;
  Tracking tracking_;
  bool has_side_;
  bool spindle_on_ = true;
  bool is_ended_ = false;
  bool is_new_ = false;
  bool was_seen_ = false;
  Pose pose_;
};

std::uint16_t port_of_link(const std::string& text) {
  constexpr double kLastPort = 65535.0;
  const std::optional<double> port = parse_number(text);
  if (!port || !(*port >= 1.0 && *port <= kLastPort)) {
    fail("link: expected a port from 1 to 65535, found ", in_quotes(text));
  }
  return static_cast<std::uint16_t>(*port);
}

}  // namespace

LinkSource::LinkSource(LinkServerOptions server, TrackingOptions tracking)
    : options_(std::move(server)), tracking_(std::move(tracking)) {
  name_ = options_.connect_host.empty()
              ? "OpenIGTLink, port " + std::to_string(options_.port)
              : "OpenIGTLink of " + options_.connect_host + ":" + std::to_string(options_.connect_port);
}

void LinkSource::prepare(SessionSetup& setup) const {
  constexpr double kVoxelMm = 0.2, kSlipMm = 20.0;  // as `spinaltap link` has them
  setup.options.has_device = true;
  setup.options.max_jump_mm = kSlipMm;
  setup.volume.spacing_mm = kVoxelMm;
}

OperatorPlan LinkSource::begin(const SessionSetup& setup, const Progress& progress) {
  end();
  LinkServerOptions options = options_;
  options.stale_s = tracking_.stale_s;
  options.points = {{"Entry", "Plan", ras_from_lps(setup.path.entry_mm), 0.5 * setup.path.bit.diameter_mm},
                    {"Target", "Plan", ras_from_lps(setup.path.target_mm), 0.5 * setup.path.bit.diameter_mm}};
  server_ = std::make_shared<LinkServer>(options);
  events_told_ = 0;
  was_stopped_ = false;
  auto tool = std::make_unique<LinkedTool>(server_, tracking_, setup.path.bit.shape == BitShape::plate);
  try {
    while (!tool->hear()) {
      if (tool->is_ended()) fail("link: it was ended before a tool came");
      progress.report("waiting for the tracked tool", 0.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  } catch (...) {
    end();
    throw;
  }
  OperatorPlan plan;
  plan.rate_hz = kLinkRateHz;
  plan.way.is_free = true;
  plan.words = {{"kind", "link"}};
  plan.tool_operator = std::move(tool);
  return plan;
}

void LinkSource::tell(const DrillSession& session) {
  if (!server_) return;
  const Cycle& cycle = session.last();
  LinkOutput output;
  output.cycle = cycle.index;
  output.time_s = cycle.time_s;
  output.pose = cycle.pose;
  output.depth_mm = cycle.depth_mm;
  output.force_n = cycle.force.force_n;
  output.thrust_n = cycle.force.thrust_n;
  output.torque_n_mm = cycle.force.torque_n_mm;
  output.clearance = cycle.clearance;
  output.drill_state = cycle.state;
  output.spindle_on = cycle.input.spindle_on;
  output.is_stopped = session.is_stopped();
  const bool is_lost = cycle.input.device.status == DeviceStatus::lost;
  output.tracking = is_lost ? TrackingState::stale : TrackingState::ok;
  output.kind = is_lost ? LinkOutput::Kind::state : LinkOutput::Kind::cycle;
  if (output.is_stopped && !was_stopped_) {
    was_stopped_ = true;
    LinkOutput stop = output;
    stop.kind = LinkOutput::Kind::stop;
    if (!session.events().empty()) stop.event = session.events().back();
    server_->give(stop);
  }
  // A pose that is answered once; between poses nothing is news.
  if (cycle.input.device.status != DeviceStatus::silent) server_->give(output);
  for (; events_told_ < session.events().size(); ++events_told_) {
    LinkOutput told = output;
    told.kind = LinkOutput::Kind::event;
    told.event = session.events()[events_told_];
    server_->give(told);
  }
}

void LinkSource::end() {
  if (server_) server_->end();
  server_.reset();
}

std::shared_ptr<LinkSource> listening_link(const std::string& address) {
  LinkServerOptions server;
  const std::size_t colon = address.rfind(':');
  if (colon != std::string::npos) server.bind_address = address.substr(0, colon);
  server.port = port_of_link(colon == std::string::npos ? address : address.substr(colon + 1));
  return std::make_shared<LinkSource>(server, TrackingOptions{});
}

std::shared_ptr<LinkSource> connecting_link(const std::string& address) {
  LinkServerOptions server;
  server.bind_address.clear();
  const std::size_t colon = address.rfind(':');
  if (colon != std::string::npos) server.connect_port = port_of_link(address.substr(colon + 1));
  server.connect_host = address.substr(0, colon);
  if (server.connect_host.empty()) fail("link: expected a server as HOST:PORT, found ", in_quotes(address));
  return std::make_shared<LinkSource>(server, TrackingOptions{});
}

}  // namespace spinaltap
