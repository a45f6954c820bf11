#include "apps/spinaltap-planner/navigation/link_source.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "apps/link/link_exchange.h"
#include "apps/link/linked_session.h"
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
      : server_(std::move(server)), receiver_{Tracking(tracking)}, has_side_(has_side) {}

  /// Whether the tool's pose is known.
  bool hear() {
    LinkInput input;
    while (server_->take(input)) is_new_ = receiver_.take(input) || is_new_;
    const std::optional<Pose> pose = receiver_.tracking.pose(wall_ns());
    if (!pose) return false;
    pose_ = *pose;
    if (!has_side_) pose_.side = Vec3::Zero();
    return true;
  }
  bool is_ended() const { return receiver_.is_ended; }

  std::optional<ToolInput> next(const ToolFeedback& /*feedback*/) override {
    const bool is_seen = hear();
    if (receiver_.is_ended) return std::nullopt;
    ToolInput input{pose_, is_seen && was_seen_ && receiver_.spindle_on, 1.0 / kLinkRateHz};
    input.device.status = !is_seen ? DeviceStatus::lost : is_new_ ? DeviceStatus::live : DeviceStatus::silent;
    input.device.buttons = receiver_.spindle_on ? 1U : 0U;
    input.device.pose = pose_;
    was_seen_ = is_seen;
    is_new_ = false;
    return input;
  }

 private:
  std::shared_ptr<LinkServer> server_;
  LinkReceiver receiver_;
  bool has_side_;
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
  set_linked_defaults(setup);
  setup.options.has_device = true;  // cycles go on where no pose comes
}

OperatorPlan LinkSource::begin(const SessionSetup& setup, const Progress& progress) {
  end();
  LinkServerOptions options = options_;
  options.stale_s = tracking_.stale_s;
  options.points = plan_points(setup.path);
  server_ = std::make_shared<LinkServer>(options);
  sender_ = {};
  auto tool = std::make_unique<LinkedTool>(server_, tracking_, setup.path.bit.is_plate());
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

void LinkSource::tell(const Session& session) {
  if (!server_) return;
  const Cycle& cycle = session.last();
  LinkOutput output = output_of(session, cycle);
  const bool is_lost = cycle.input.device.status == DeviceStatus::lost;
  if (is_lost) {
    output.tracking = TrackingState::stale;
    output.kind = LinkOutput::Kind::state;
  }
  sender_.tell_stop(session, output, *server_);
  // A pose that is answered once; between poses nothing is news.
  if (cycle.input.device.status != DeviceStatus::silent) server_->give(output);
  sender_.tell_events(session, output, *server_);
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
  set_server_to_connect(address, server);
  return std::make_shared<LinkSource>(server, TrackingOptions{});
}

}  // namespace spinaltap
