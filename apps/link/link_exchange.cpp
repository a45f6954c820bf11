#include "apps/link/link_exchange.h"

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {

bool LinkReceiver::take(const LinkInput& input) {
  switch (input.kind) {
    case LinkInput::Kind::command:
      if (input.command == LinkCommand::end) is_ended = true;
      if (input.command == LinkCommand::spindle_on) spindle_on = true;
      if (input.command == LinkCommand::spindle_off) spindle_on = false;
      return false;
    case LinkInput::Kind::invalid:
      tracking.invalidate(input.device, input.arrival_ns);
      return false;
    default:
      tracking.update(input.device, input.transform, input.is_valid, input.arrival_ns);
      return input.device == LinkDevice::tool;
  }
}

LinkOutput output_of(const Session& session, const Cycle& cycle) {
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
  output.tracking = TrackingState::ok;
  return output;
}

void LinkSender::tell_stop(const Session& session, const LinkOutput& output, LinkServer& server) noexcept {
  if (!output.is_stopped || was_stopped_) return;
  was_stopped_ = true;
  LinkOutput stop = output;
  stop.kind = LinkOutput::Kind::stop;
  for (const SessionEvent& event : session.events()) {
    if (event.kind == EventKind::stop_thrust || event.kind == EventKind::stop_clearance ||
        event.kind == EventKind::stop_breach) {
      stop.event = event;
    }
  }
  server.give(stop);
}

void LinkSender::tell_events(const Session& session, const LinkOutput& output, LinkServer& server) noexcept {
  const std::span<const SessionEvent> events = session.events();
  for (; events_told_ < events.size(); ++events_told_) {
    LinkOutput told = output;
    told.kind = LinkOutput::Kind::event;
    told.event = events[events_told_];
    server.give(told);
  }
}

std::vector<LinkPoint> plan_points(const DrillPath& path) {
  const double radius_mm = 0.5 * path.bit.diameter_mm;
  return {{"Entry", "Plan", ras_from_lps(path.entry_mm), radius_mm},
          {"Target", "Plan", ras_from_lps(path.target_mm), radius_mm}};
}

void set_server_to_connect(const std::string& text, LinkServerOptions& options) {
  const auto rejects = [&] { fail("link: expected a server as HOST:PORT, found ", in_quotes(text)); };
  const std::size_t colon = text.rfind(':');
  const bool is_bare_v6 = colon != std::string::npos && text.find(':') != colon && !text.starts_with('[');
  options.connect_host = text;
  if (colon != std::string::npos && !is_bare_v6 && !text.ends_with(']')) {
    const std::optional<double> port = parse_number(text.substr(colon + 1));
    constexpr double kLastPort = 65535.0;
    if (!port || !(*port >= 1.0 && *port <= kLastPort)) rejects();
    options.connect_port = static_cast<std::uint16_t>(*port);
    options.connect_host = text.substr(0, colon);
  }
  std::string& host = options.connect_host;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty()) rejects();
}

}  // namespace spinaltap
