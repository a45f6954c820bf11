#include "apps/link/link_server.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include "apps/link/detail/peer.h"
#include "apps/link/link_ring.h"
#include "apps/link/link_thread.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/session/real_time/thread_rights.h"

namespace spinaltap {
namespace {

constexpr std::size_t kInputRoom = 4096;
constexpr std::size_t kOutputRoom = 4096;  // 4 s at 1 kHz
constexpr int kNetworkPriority = 50;       // below the loop's: a flood costs the session nothing
constexpr std::int64_t kMs = 1'000'000;

/// An address as sockets take it.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;
};

/// Throws Error where there is none.
SocketAddress resolve(const std::string& host, std::uint16_t port, bool is_numeric) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = is_numeric ? AI_NUMERICHOST | AI_PASSIVE : 0;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0 || found == nullptr) {
    fail("link: expected the address of a host, found ", in_quotes(host), ": ", ::gai_strerror(error));
  }
  SocketAddress address;
  std::memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  address.size = found->ai_addrlen;
  ::freeaddrinfo(found);
  return address;
}

FileDescriptor open_socket(const SocketAddress& address) {
  return FileDescriptor(::socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP));
}

FileDescriptor listen_at(const std::string& host, std::uint16_t port) {
  const SocketAddress address = resolve(host, port, true);
  FileDescriptor socket = open_socket(address);
  const int yes = 1;
  ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const auto* const place = reinterpret_cast<const sockaddr*>(&address.storage);
  if (!socket.is_open() || ::bind(socket.number(), place, address.size) != 0 || ::listen(socket.number(), 16) != 0) {
    fail("link: expected a free port ", port, " at ", host, ", found: ", std::strerror(errno));
  }
  return socket;
}

std::uint16_t port_of(int socket) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return 0;
  std::uint16_t port = 0;  // at the same place in both families' addresses
  std::memcpy(&port, reinterpret_cast<const char*>(&storage) + 2, sizeof port);
  return ntohs(port);
}

void check_link_options(const LinkServerOptions& options) {
  const LinkNames& names = options.names;
  for (const std::string* name :
       {&names.tool, &names.reference, &names.patient, &names.command, &names.bit, &names.bone}) {
    if (name->empty() || name->size() > 19) {
      fail("link: expected a device's name of 1 to 19 letters, found ", in_quotes(*name));
    }
  }
  if (!(options.state_rate_hz >= 0.0 && options.state_rate_hz <= 1000.0)) {
    fail("link: expected a rate of 0 to 1000 Hz for the state, found ", options.state_rate_hz, " Hz");
  }
  if (!(options.stale_s > 0.0)) fail("link: expected a time above 0 s until a pose is stale, found ", options.stale_s);
}

SharedBytes shared(std::string bytes) { return std::make_shared<const std::string>(std::move(bytes)); }

}  // namespace

std::uint64_t LinkReport::refused_in_all() const {
  std::uint64_t all = 0;
  for (const std::uint64_t one : refused) all += one;
  return all;
}

struct LinkServer::State {
  explicit State(const LinkServerOptions& wanted) : options(wanted) {
    check_link_options(options);
    if (!options.bind_address.empty()) {
      listener = listen_at(options.bind_address, options.port);
      port = port_of(listener.number());
    }
    if (!options.connect_host.empty()) server = resolve(options.connect_host, options.connect_port, false);
    room.resize(std::size_t{64} << 10U);
    thread = std::thread([this] { run(); });
  }

  // On the network's thread.
  void run();
  void poll_sockets();
  void fetch_outputs();
  void accept_peers();
  void connect_to_server();
  void greet(LinkPeer& peer);
  void read_from(LinkPeer& peer);
  void take_message(LinkPeer& peer, LinkMessage&& message);
  void take_transform(LinkPeer& peer, const LinkMessage& message);
  void take_command(LinkPeer& peer, const LinkMessage& message);
  bool is_in_charge(const LinkPeer& peer, LinkDevice device);
  std::optional<LinkDevice> device_called(const std::string& name) const;
  void give_inputs();
  void refuse(LinkRejection refusal) { ++report.refused[static_cast<std::size_t>(refusal)]; }
  void send_output(const LinkOutput& output);
  void send_all(std::string_view type, const std::string& device, const std::string& content, LinkPeer::Urgency urgency,
                std::uint64_t time_stamp, const std::map<std::string, std::string>& metadata = {});
  void send_to(LinkPeer& peer, std::string_view type, const std::string& device, const std::string& content);
  void send_state();
  void send_status(LinkPeer& peer);
  void send_surfaces(LinkPeer& peer);
  void flush_peers();
  void drop(LinkPeer& peer) { gone.push_back(peer.number()); }
  void bury();
  void look_after_peers();
  void publish_report();
  void say_goodbye();

  LinkServerOptions options;
  FileDescriptor listener;
  std::uint16_t port = 0;
  std::optional<SocketAddress> server;
  WakeEvent network_wake, loop_wake;
  LinkRing<LinkInput> inputs{kInputRoom};
  LinkRing<LinkOutput> outputs{kOutputRoom};
  LinkRing<LinkOutput> stops{64};
  std::atomic<bool> ends{false};

  std::list<LinkPeer> peers;
  std::vector<std::uint64_t> gone;
  std::uint64_t next_number = 1;
  std::vector<char> room;
  struct Charge {
    std::uint64_t peer = 0;
    std::int64_t at_ns = 0;
  };
  std::array<Charge, 3> charges;
  std::array<std::optional<LinkInput>, 3> latest;  ///< of the batch being read
  std::vector<LinkInput> commands;                 ///< likewise
  LinkOutput last;
  std::int64_t next_state_ns = 0;
  std::int64_t next_status_ns = 0;
  std::int64_t next_connect_ns = 0;
  std::int64_t next_accept_ns = 0;
  TrackingState told = TrackingState::waiting;
  LinkReport report;
  TimeHistogram through_times, stop_times;

  std::mutex surfaces_mutex;
  struct Given {
    SharedBytes message;
    bool is_gone = false;
  };
  std::map<std::string, Given> given_surfaces;  ///< not yet seen by the network
  std::map<std::string, SharedBytes> surfaces;  ///< the network's

  mutable std::mutex report_mutex;
  LinkReport published;
  std::thread thread;
};

void LinkServer::State::run() {
  if (options.wants_priority) {
    ask_for_exact_sleeps();
    report.has_priority = ask_for_priority(kNetworkPriority).empty();
  }
  while (!ends) {
    poll_sockets();
    fetch_outputs();
    flush_peers();
    look_after_peers();
    bury();
    publish_report();
  }
  listener.close();  // those that wait to be let in hear of it
  say_goodbye();
  report.through_time = through_times.spread();
  report.stop_time = stop_times.spread();
  publish_report();
}

void LinkServer::State::poll_sockets() {
  std::vector<pollfd> polled{{network_wake.descriptor(), POLLIN, 0}, {listener.number(), 0, 0}};
  const std::int64_t before_ns = wall_ns();
  if (before_ns >= next_accept_ns) polled[1].events = POLLIN;
  for (LinkPeer& peer : peers) {
    short events = 0;
    if (peer.is_connecting() || peer.has_more_to_send()) events |= POLLOUT;
    if (peer.may_receive(options.max_bytes_per_s, before_ns)) {
      events |= POLLIN;
    } else {
      ++report.throttled;
    }
    polled.push_back({peer.descriptor(), events, 0});
  }
  std::int64_t wait_ns = 10 * kMs;
  if (options.state_rate_hz > 0.0) wait_ns = std::min(wait_ns, std::max<std::int64_t>(0, next_state_ns - before_ns));
  const std::timespec wait{.tv_sec = 0, .tv_nsec = wait_ns};
  if (::ppoll(polled.data(), polled.size(), &wait, nullptr) <= 0) return;
  if (polled[0].revents != 0) network_wake.silence();
  std::size_t n = 2;
  for (LinkPeer& peer : peers) {  // those that were polled: new ones come behind them
    const short events = polled[n++].revents;
    if (peer.is_connecting() && events != 0) {
      if (peer.finish_connecting()) {
        ++report.peers;
        greet(peer);
      } else {
        drop(peer);
      }
    } else if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) {
      read_from(peer);
    }
  }
  give_inputs();
  if (polled[1].revents != 0) accept_peers();
}

void LinkServer::State::accept_peers() {
  for (;;) {
    FileDescriptor socket(::accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open()) return;
    if (peers.size() >= options.max_peers) {
      refuse(LinkRejection::too_many);
      continue;
    }
    ++report.peers;
    peers.emplace_back(std::move(socket), next_number++, false, wall_ns());
    greet(peers.back());
  }
}

void LinkServer::State::connect_to_server() {
  const std::int64_t now_ns = wall_ns();
  constexpr std::int64_t kAgainNs = 500 * kMs;
  const bool is_there = std::any_of(peers.begin(), peers.end(), [](const LinkPeer& peer) { return peer.is_server; });
  if (!server || is_there || now_ns < next_connect_ns) return;
  next_connect_ns = now_ns + kAgainNs;
  FileDescriptor socket = open_socket(*server);
  if (!socket.is_open()) return;
  const int error = ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&server->storage), server->size);
  if (error != 0 && errno != EINPROGRESS) return;
  peers.emplace_back(std::move(socket), next_number++, true, now_ns);
  peers.back().is_server = true;
}

/// What a peer has to know from the start.
void LinkServer::State::greet(LinkPeer& peer) {
  send_status(peer);
  if (peer.is_server) return;  // a tracker has no use for a bone
  if (!options.points.empty()) send_to(peer, "POINT", "Plan", point_content(options.points));
  send_surfaces(peer);
}

void LinkServer::State::read_from(LinkPeer& peer) {
  bool is_over = false;
  const std::string_view bytes = peer.receive(room, is_over);
  report.bytes_in += bytes.size();
  const auto refused = [&](LinkRejection refusal) {
    refuse(refusal);
    if (refusal != LinkRejection::type) ++peer.bad_in_a_row;
  };
  const bool is_sound = peer.reader().take(
      bytes, [&](LinkMessage&& message) { take_message(peer, std::move(message)); }, refused);
  constexpr int kMaxBad = 100;
  if (is_over || !is_sound || peer.bad_in_a_row > kMaxBad) {
    if (is_over && peer.reader().is_within()) refuse(LinkRejection::half);
    // Whoever sends nonsense connects again at once: each time costs a greeting, with a whole bone.
    constexpr std::int64_t kCalmNs = 50 * kMs;
    if (!is_sound) next_accept_ns = wall_ns() + kCalmNs;
    drop(peer);
    return;
  }
  peer.note_half(wall_ns());
}

void LinkServer::State::take_message(LinkPeer& peer, LinkMessage&& message) {
  ++report.messages;
  peer.header_version = std::clamp(message.header_version, 1, 2);
  if (message.type == "TRANSFORM") {
    take_transform(peer, message);
  } else if (message.type == "STRING") {
    take_command(peer, message);
  } else if (message.type == "STATUS") {
    const std::optional<int> code = status_of(message.content);
    const std::optional<LinkDevice> device = device_called(message.device);
    if (!code) {
      ++peer.bad_in_a_row;
      refuse(LinkRejection::content);
    } else if (device && *code != static_cast<int>(LinkStatusCode::ok) && is_in_charge(peer, *device)) {
      LinkInput input{.kind = LinkInput::Kind::invalid, .device = *device};
      input.arrival_ns = wall_ns();
      latest[static_cast<std::size_t>(*device)] = input;
    }
  } else if (message.type == "GET_STATUS") {
    send_status(peer);
  } else if (message.type == "GET_POINT") {
    send_to(peer, "POINT", "Plan", point_content(options.points));
  } else if (message.type == "GET_POLYDATA") {
    send_surfaces(peer);
  } else if (message.type == "GET_CAPABIL") {
    constexpr std::array<std::string_view, 9> kTypes{
        "TRANSFORM", "STRING", "STATUS", "POINT", "POLYDATA", "GET_STATUS", "GET_POINT", "GET_POLYDATA", "GET_CAPABIL"};
    send_to(peer, "CAPABILITY", "SpinalTap", capability_content(kTypes));
  }
}

std::optional<LinkDevice> LinkServer::State::device_called(const std::string& name) const {
  if (name == options.names.tool) return LinkDevice::tool;
  if (name == options.names.reference) return LinkDevice::reference;
  if (name == options.names.patient) return LinkDevice::patient;
  return std::nullopt;
}

/// Whoever sends first has charge of a device, until it is gone or silent for long.
bool LinkServer::State::is_in_charge(const LinkPeer& peer, LinkDevice device) {
  Charge& charge = charges[static_cast<std::size_t>(device)];
  const std::int64_t now_ns = wall_ns();
  const bool is_free = charge.peer == 0 || 1e-9 * static_cast<double>(now_ns - charge.at_ns) > options.stale_s;
  if (!is_free && charge.peer != peer.number()) return false;
  charge = {peer.number(), now_ns};
  return true;
}

void LinkServer::State::take_transform(LinkPeer& peer, const LinkMessage& message) {
  const std::optional<LinkDevice> device = device_called(message.device);
  if (!device) {
    refuse(LinkRejection::device);
    return;
  }
  if (!is_in_charge(peer, *device)) {
    refuse(LinkRejection::not_in_charge);
    return;
  }
  LinkInput input{.device = *device, .is_valid = is_said_valid(message)};
  input.time_stamp = message.time_stamp;
  input.arrival_ns = wall_ns();
  if (const std::optional<LinkTransform> transform = transform_of(message.content)) {
    input.transform = *transform;
    peer.bad_in_a_row = 0;
  } else if (!input.is_valid) {
    // Trackers send what they like with a tool that they do not see.
  } else {
    ++peer.bad_in_a_row;
    refuse(LinkRejection::content);
    return;
  }
  ++report.transforms;
  std::optional<LinkInput>& place = latest[static_cast<std::size_t>(*device)];
  if (place) ++report.merged;
  place = input;
}

void LinkServer::State::take_command(LinkPeer& peer, const LinkMessage& message) {
  if (message.device != options.names.command) {
    refuse(LinkRejection::device);
    return;
  }
  const std::optional<std::string> text = string_of(message.content);
  if (!text) {
    ++peer.bad_in_a_row;
    refuse(LinkRejection::content);
    return;
  }
  const std::string command = upper_case(trimmed(*text));
  bool is_known = true;
  LinkInput input{.kind = LinkInput::Kind::command};
  input.arrival_ns = wall_ns();
  if (command == "SPINDLE ON") {
    input.command = LinkCommand::spindle_on;
  } else if (command == "SPINDLE OFF") {
    input.command = LinkCommand::spindle_off;
  } else if (command == "END") {
    input.command = LinkCommand::end;
  } else if (command == "BONE") {
    send_surfaces(peer);
  } else {
    is_known = false;
    ++peer.bad_in_a_row;
    refuse(LinkRejection::command);
  }
  if (input.command != LinkCommand::none) commands.push_back(input);
  send_to(peer, "STRING", "Answer",
          string_content(is_known ? R"({"command":")" + command + R"(","done":true})"
                                  : std::string(R"({"command":null,"done":false,"expected":)"
                                                R"(["SPINDLE ON","SPINDLE OFF","BONE","END"]})")));
}

void LinkServer::State::give_inputs() {
  bool has_any = !commands.empty();
  for (const LinkInput& command : commands) inputs.give(command);
  commands.clear();
  // The patient and the reference first: they hold for the tool that came with them.
  for (const LinkDevice device : {LinkDevice::patient, LinkDevice::reference, LinkDevice::tool}) {
    std::optional<LinkInput>& input = latest[static_cast<std::size_t>(device)];
    if (!input) continue;
    inputs.give(*input);
    input.reset();
    has_any = true;
  }
  if (has_any) loop_wake.ring();
}

void LinkServer::State::fetch_outputs() {
  LinkOutput output;
  while (stops.take(output)) send_output(output);
  // Of a backlog all events are told; poses and states are news, and the peers' queues let the old ones fall.
  while (outputs.take(output)) send_output(output);
  {
    const std::lock_guard lock(surfaces_mutex);
    for (auto& [name, given] : given_surfaces) {
      for (LinkPeer& peer : peers) {
        if (!peer.is_server) peer.send_surface(name, given.message);
      }
      if (given.is_gone) {
        surfaces.erase(name);
      } else {
        surfaces[name] = given.message;
      }
    }
    given_surfaces.clear();
  }
  const std::int64_t now_ns = wall_ns();
  if (options.state_rate_hz > 0.0 && now_ns >= next_state_ns) {
    next_state_ns = now_ns + static_cast<std::int64_t>(1e9 / options.state_rate_hz);
    send_state();
  }
  constexpr std::int64_t kStatusNs = 1000 * kMs;
  if (now_ns >= next_status_ns || told != last.tracking) {
    next_status_ns = now_ns + kStatusNs;
    told = last.tracking;
    for (LinkPeer& peer : peers) send_status(peer);
  }
}

void LinkServer::State::send_output(const LinkOutput& output) {
  using Urgency = LinkPeer::Urgency;
  switch (output.kind) {
    case LinkOutput::Kind::cycle: {
      last = output;
      const std::uint64_t time_stamp = output.time_stamp != 0 ? output.time_stamp : link_time_stamp();
      send_all("TRANSFORM", options.names.bit, transform_content(bit_in_ras(output.pose)), Urgency::while_new,
               time_stamp, {{"Status", "OK"}});
      flush_peers();
      const std::int64_t taken_ns = wall_ns() - output.arrival_ns;
      through_times.add(taken_ns);
      ++report.through;
      if (taken_ns > kMs) ++report.late;
      break;
    }
    case LinkOutput::Kind::state:
      last = output;
      break;
    case LinkOutput::Kind::event:
      send_all("STRING", "Event", string_content(event_text(output)), Urgency::must, link_time_stamp());
      break;
    case LinkOutput::Kind::stop:
      send_all("STRING", "Stop", string_content(event_text(output)), Urgency::now, link_time_stamp());
      flush_peers();
      stop_times.add(wall_ns() - output.arrival_ns);
      ++report.stops;
      break;
  }
}

void LinkServer::State::send_all(std::string_view type, const std::string& device, const std::string& content,
                                 LinkPeer::Urgency urgency, std::uint64_t time_stamp,
                                 const std::map<std::string, std::string>& metadata) {
  std::array<SharedBytes, 2> messages;  // by header version
  for (LinkPeer& peer : peers) {
    if (peer.is_connecting()) continue;
    SharedBytes& message = messages[peer.header_version >= 2 ? 1 : 0];
    if (!message) message = shared(pack_message(type, device, content, peer.header_version, time_stamp, metadata));
    if (!peer.send(message, urgency)) ++report.dropped;
  }
}

void LinkServer::State::send_to(LinkPeer& peer, std::string_view type, const std::string& device,
                                const std::string& content) {
  // A peer that asks and does not read is not answered for ever.
  const auto message = shared(pack_message(type, device, content, peer.header_version, link_time_stamp()));
  if (!peer.send(message, LinkPeer::Urgency::while_new)) ++report.dropped;
}

void LinkServer::State::send_state() {
  if (peers.empty()) return;
  send_all("STRING", "State", string_content(state_text(last, report)), LinkPeer::Urgency::while_new,
           link_time_stamp());
}

void LinkServer::State::send_status(LinkPeer& peer) {
  if (peer.is_connecting()) return;
  const bool is_ok = last.tracking == TrackingState::ok;
  const LinkStatusCode code = is_ok                                     ? LinkStatusCode::ok
                              : last.tracking == TrackingState::waiting ? LinkStatusCode::not_ready
                                                                        : LinkStatusCode::time_out;
  send_to(peer, "STATUS", "SpinalTap",
          status_content(code, name_of(last.tracking), last.is_stopped ? "stop asked for" : "drilling"));
}

void LinkServer::State::send_surfaces(LinkPeer& peer) {
  for (const auto& [name, message] : surfaces) peer.send_surface(name, message);
}

void LinkServer::State::flush_peers() {
  const std::int64_t now_ns = wall_ns();
  for (LinkPeer& peer : peers) {
    if (!peer.flush(now_ns)) drop(peer);
    report.bytes_out += peer.take_bytes_out();
  }
}

/// Those that do not go on.
void LinkServer::State::look_after_peers() {
  constexpr std::size_t kMaxWaiting = std::size_t{64} << 20U;  // a bone, and then events on end
  const auto patience_ns = static_cast<std::int64_t>(1e9 * options.patience_s);
  const std::int64_t now_ns = wall_ns();
  for (LinkPeer& peer : peers) {
    const std::int64_t half_ns = peer.half_since_ns(), blocked_ns = peer.blocked_since_ns();
    if (half_ns != 0 && now_ns - half_ns > patience_ns) {
      refuse(LinkRejection::half);
      drop(peer);
    } else if ((blocked_ns != 0 && now_ns - blocked_ns > patience_ns) || peer.waiting_bytes() > kMaxWaiting) {
      refuse(LinkRejection::hanging);
      drop(peer);
    }
  }
  connect_to_server();
}

void LinkServer::State::bury() {
  for (const std::uint64_t number : gone) {
    peers.remove_if([&](const LinkPeer& peer) { return peer.number() == number; });
    for (Charge& charge : charges) {
      if (charge.peer == number) charge = {};
    }
  }
  gone.clear();
}

void LinkServer::State::publish_report() {
  const std::lock_guard lock(report_mutex);
  report.lost_inputs = inputs.lost();
  report.lost_outputs = outputs.lost();
  published = report;
}

void LinkServer::State::say_goodbye() {
  fetch_outputs();
  send_all("STATUS", "SpinalTap", status_content(LinkStatusCode::shut_down, "over", "the session has ended"),
           LinkPeer::Urgency::must, link_time_stamp());
  constexpr std::int64_t kMomentNs = 200 * kMs;
  const std::int64_t end_ns = wall_ns() + kMomentNs;
  for (bool has_more = true; has_more && wall_ns() < end_ns;) {
    flush_peers();
    bury();
    has_more = std::any_of(peers.begin(), peers.end(), [](const LinkPeer& peer) { return peer.waiting_bytes() > 0; });
    if (has_more) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  peers.clear();
}

LinkServer::LinkServer(const LinkServerOptions& options) : state_(std::make_unique<State>(options)) {}

LinkServer::~LinkServer() { end(); }

LinkReport LinkServer::end() {
  if (state_->thread.joinable()) {
    state_->ends = true;
    state_->network_wake.ring();
    state_->thread.join();
  }
  return report();
}

std::uint16_t LinkServer::port() const { return state_->port; }

bool LinkServer::take(LinkInput& input) noexcept { return state_->inputs.take(input); }
void LinkServer::wait(std::int64_t until_ns) noexcept { state_->loop_wake.wait(until_ns); }

void LinkServer::give(const LinkOutput& output) noexcept {
  if (output.kind == LinkOutput::Kind::stop) {
    state_->stops.give(output);
  } else {
    state_->outputs.give(output);
  }
  state_->network_wake.ring();
}

void LinkServer::give_surfaces(const std::map<std::string, std::string>& contents) {
  std::map<std::string, State::Given> messages;
  for (const auto& [name, content] : contents) {
    // Header version 1, which every receiver reads: a bone is not packed for each peer.
    const std::string& body = content.empty() ? polydata_content({}, {}) : content;
    messages[name] = {shared(pack_message("POLYDATA", name, body, 1, link_time_stamp())), content.empty()};
  }
  {
    const std::lock_guard lock(state_->surfaces_mutex);
    for (auto& [name, given] : messages) state_->given_surfaces[name] = std::move(given);
  }
  state_->network_wake.ring();
}

LinkReport LinkServer::report() const {
  const std::lock_guard lock(state_->report_mutex);
  return state_->published;
}

}  // namespace spinaltap
