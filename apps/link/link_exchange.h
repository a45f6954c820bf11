#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/link/link_server.h"
#include "vdb/sim/session.h"

namespace spinaltap {

// What a session and a server have to say to each other, whoever runs the session's cycles: run_link(), or a window.

/// What came, taken together: where the tool is, and what commands ask for.
struct LinkReceiver {
  Tracking tracking;
  bool spindle_on = true;
  bool is_ended = false;

  /// Whether it was a transform of the tool.
  bool take(const LinkInput& input);
};

/// What a cycle says: a pose with forces, states and clearances, in TrackingState::ok.
LinkOutput output_of(const Session& session, const Cycle& cycle);

/// Tells a server what has happened in a session, each thing once. Allocates nothing.
class LinkSender {
 public:
  /// Where a rule has asked to stop, with the rule's event; before all else that the cycle says.
  void tell_stop(const Session& session, const LinkOutput& output, LinkServer& server) noexcept;
  void tell_events(const Session& session, const LinkOutput& output, LinkServer& server) noexcept;

 private:
  bool was_stopped_ = false;
  std::size_t events_told_ = 0;
};

/// The plan as it is sent: its entry and its target, without names of their own.
std::vector<LinkPoint> plan_points(const DrillPath& path);

/// "host:port", "host" or "[::1]:port", of a server to connect to. Throws Error on other words.
void set_server_to_connect(const std::string& text, LinkServerOptions& options);

}  // namespace spinaltap
