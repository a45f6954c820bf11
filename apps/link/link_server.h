#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/link/link_frames.h"
#include "apps/link/link_message.h"
#include "core/session/drill_session.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {

/// What devices are called. At most 19 letters each.
struct LinkNames {
  std::string tool = "Tool";
  std::string reference = "Reference";
  std::string patient = "Patient";
  std::string command = "Command";  ///< STRING, in
  std::string bit = "Bit";          ///< TRANSFORM, out
  std::string bone = "Bone";        ///< POLYDATA, out
};

struct LinkServerOptions {
  /// Numeric; the loopback alone unless somebody says otherwise. Empty: nobody may connect.
  std::string bind_address = "127.0.0.1";
  std::uint16_t port = 18944;  ///< 0: any that is free
  /// A server to connect to as a client, which is tried again while it is not there; empty: none.
  std::string connect_host = {};
  std::uint16_t connect_port = 18944;
  LinkNames names = {};
  double state_rate_hz = 20.0;  ///< of STRINGs with the state; 0: none
  double stale_s = 0.5;         ///< a sender that is silent for so long no longer has charge of its device
  std::size_t max_peers = 8;
  double patience_s = 5.0;             ///< with a half message, or a peer that does not read
  double max_bytes_per_s = 32e6;       ///< that are read of a peer; the rest waits at the peer
  bool wants_priority = true;          ///< SCHED_FIFO, where the user's rights allow
  std::vector<LinkPoint> points = {};  ///< of the plan, RAS
};

enum class LinkCommand : std::uint8_t { none, spindle_on, spindle_off, end };

/// What goes to the loop.
struct LinkInput {
  enum class Kind : std::uint8_t { transform, invalid, command };
  Kind kind = Kind::transform;
  LinkDevice device = LinkDevice::tool;
  LinkCommand command = LinkCommand::none;
  bool is_valid = true;
  LinkTransform transform = LinkTransform::Identity();
  std::uint64_t time_stamp = 0;  ///< the sender's
  std::int64_t arrival_ns = 0;   ///< on the host's monotonic clock
};

/// What comes from the loop.
struct LinkOutput {
  enum class Kind : std::uint8_t { cycle, state, event, stop };
  Kind kind = Kind::cycle;
  std::uint64_t cycle = 0;
  double time_s = 0.0;
  Pose pose;  ///< LPS
  double depth_mm = 0.0;
  Vec3 force_n = Vec3::Zero();  ///< on the tool, LPS; fades where no pose comes
  double thrust_n = 0.0;
  double torque_n_mm = 0.0;
  Clearance clearance;
  DrillState drill_state = DrillState::initial;
  TrackingState tracking = TrackingState::waiting;
  bool spindle_on = true;
  bool is_stopped = false;
  SessionEvent event;            ///< of events and stops
  std::uint64_t time_stamp = 0;  ///< of the transform that brought it
  std::int64_t arrival_ns = 0;   ///< of that; 0: none did
};

/// What went through a server.
struct LinkReport {
  std::uint64_t peers = 0;       ///< that connected, or were connected to
  std::uint64_t messages = 0;    ///< that came and were whole
  std::uint64_t transforms = 0;  ///< of the tool, the reference and the patient that were taken
  std::uint64_t merged = 0;      ///< transforms that a later one of the same batch took the place of
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t dropped = 0;    ///< transforms and states that a slow peer was not sent
  std::uint64_t throttled = 0;  ///< times that a peer sent more than is read
  LinkRejections refused{};
  std::uint64_t through = 0;  ///< poses that came and whose bit was sent
  std::uint64_t late = 0;     ///< of them, those that took longer than a millisecond
  TimeSpread through_time;    ///< from a tool's transform read to the bit's transform handed to the socket
  std::uint64_t stops = 0;
  TimeSpread stop_time;            ///< from the transform read that brought it to the stop handed to the socket
  std::uint64_t lost_inputs = 0;   ///< that the loop did not fetch in time
  std::uint64_t lost_outputs = 0;  ///< that the network did not
  bool has_priority = false;

  std::uint64_t refused_in_all() const;
};

/// The network, in a thread of its own: takes connections, or makes one, reads messages, refuses what is none, and
/// sends what the session gives. The loop of the session neither waits for it nor allocates: both sides pass values
/// through rings of fixed size. All queues to peers are bounded: poses and states that a slow peer does not read are
/// dropped, blocks of the bone wait in their latest version alone, and a peer that reads nothing loses its connection.
class LinkServer {
 public:
  /// Throws Error where it cannot listen there.
  explicit LinkServer(const LinkServerOptions& options);
  ~LinkServer();
  LinkServer(const LinkServer&) = delete;
  LinkServer& operator=(const LinkServer&) = delete;

  /// That it listens at; 0 where nobody may connect.
  std::uint16_t port() const;

  // The loop's side. From one thread.
  bool take(LinkInput& input) noexcept;
  /// Until something comes, or until the monotonic clock comes to `until_ns`.
  void wait(std::int64_t until_ns) noexcept;
  void give(const LinkOutput& output) noexcept;

  /// From any thread: surfaces, each under its name, in place of what had that name; an empty content takes it away.
  /// Peers get them as they find time.
  void give_surfaces(const std::map<std::string, std::string>& contents);

  /// So far; its times are known at the end.
  LinkReport report() const;
  /// Says goodbye to its peers, waits for a moment until they have it, and ends the thread.
  LinkReport end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a STRING with the state says: JSON in one line.
std::string state_text(const LinkOutput& output, const LinkReport& report);
/// Of an event, or of a stop.
std::string event_text(const LinkOutput& output);

}  // namespace spinaltap
