#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <unordered_map>
#include <vector>

#include "apps/link/link_loop.h"
#include "apps/link/link_mesh.h"
#include "apps/link/link_thread.h"
#include "apps/spinaltap/bench/bench_link.h"
#include "apps/spinaltap/bench/milling_workload.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/link_figures.h"
#include "core/base/check_range.h"
#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/text_writer.h"
#include "core/session/cutting_motion.h"
#include "core/session/real_time/thread_rights.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

constexpr int kClientPriority = 49;
constexpr double kLateMs = 1.0;

FileDescriptor connected_to(std::uint16_t port) {
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail("bench: expected to reach port ", port, " of this machine");
  }
  return socket;
}

/// A peer that sends so much nonsense a second, where it is taken, and comes back when it is turned away.
class Nonsense {
 public:
  Nonsense(std::uint16_t port, double mb_s) : port_(port), bytes_a_s_(1e6 * mb_s), thread_([this] { run(); }) {}
  ~Nonsense() { end(); }
  Nonsense(const Nonsense&) = delete;
  Nonsense& operator=(const Nonsense&) = delete;

  void end() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t connections() const { return connections_; }

 private:
  void run() {
    std::vector<std::uint64_t> words(std::size_t{1} << 13U);
    for (std::size_t n = 0; n < words.size(); ++n) words[n] = mix_bits(n);
    const std::size_t size = words.size() * sizeof words[0];
    const std::int64_t start_ns = wall_ns();
    while (!ends_) {
      try {
        const FileDescriptor socket = connected_to(port_);
        ++connections_;
        pollfd poll{socket.number(), POLLOUT, 0};
        while (!ends_) {
          if (static_cast<double>(bytes_) > bytes_a_s_ * 1e-9 * static_cast<double>(wall_ns() - start_ns)) {
            std::this_thread::sleep_for(std::chrono::microseconds(200));
            continue;
          }
          if (::poll(&poll, 1, 50) <= 0) continue;
          const ssize_t sent = ::send(socket.number(), words.data(), size, MSG_NOSIGNAL | MSG_DONTWAIT);
          if (sent < 0) break;
          bytes_ += static_cast<std::uint64_t>(sent);
        }
      } catch (const Error&) {
        break;  // the server is gone
      }
    }
  }

  std::uint16_t port_;
  double bytes_a_s_;
  std::atomic<bool> ends_{false};
  std::atomic<std::uint64_t> bytes_{0}, connections_{0};
  std::thread thread_;
};

/// A client as a robot would be: sends poses at a steady rate, and takes what comes back.
class BenchClient {
 public:
  explicit BenchClient(std::uint16_t port) : socket_(connected_to(port)) {
    const int yes = 1;
    ::setsockopt(socket_.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    room_.resize(std::size_t{256} << 10U);
  }

  void send(const Pose& pose, std::uint64_t number) {
    sent_ns_[number] = wall_ns();
    const std::string message = pack_message("TRANSFORM", "Tool", transform_content(bit_in_ras(pose)), 1, number);
    [[maybe_unused]] const auto sent = ::send(socket_.number(), message.data(), message.size(), MSG_NOSIGNAL);
  }
  /// What comes until the monotonic clock is at `until_ns`.
  void take(std::int64_t until_ns) {
    for (;;) {
      const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - wall_ns());
      const std::timespec left{.tv_sec = left_ns / 1'000'000'000, .tv_nsec = left_ns % 1'000'000'000};
      pollfd poll{socket_.number(), POLLIN, 0};
      if (::ppoll(&poll, 1, &left, nullptr) <= 0) return;
      const ssize_t got = ::recv(socket_.number(), room_.data(), room_.size(), MSG_DONTWAIT);
      if (got <= 0) return;
      reader_.take(
          {room_.data(), static_cast<std::size_t>(got)}, [&](LinkMessage&& message) { count(message); },
          [&](LinkRejection) { ++others_; });
    }
  }
  TimeSpread round_trip() const { return round_trip_.spread(); }
  std::uint64_t returned() const { return returned_; }
  std::uint64_t late() const { return late_; }
  std::uint64_t others() const { return others_; }
  std::uint64_t stops() const { return stops_; }

 private:
  void count(const LinkMessage& message) {
    if (message.type == "STRING" && message.device == "Stop") ++stops_;
    if (message.type != "TRANSFORM") return;
    const auto sent = sent_ns_.find(message.time_stamp);
    if (sent == sent_ns_.end()) return;
    const std::int64_t taken_ns = wall_ns() - sent->second;
    sent_ns_.erase(sent);
    round_trip_.add(taken_ns);
    ++returned_;
    if (1e-6 * static_cast<double>(taken_ns) > kLateMs) ++late_;
  }

  FileDescriptor socket_;
  LinkReader reader_;
  std::vector<char> room_;
  std::unordered_map<std::uint64_t, std::int64_t> sent_ns_;
  TimeHistogram round_trip_;
  std::uint64_t returned_ = 0, late_ = 0, others_ = 0, stops_ = 0;
};

/// A client in a thread of its own, beside the loop of a session.
class ClientThread {
 public:
  template <class Work>
  ClientThread(std::uint16_t port, Work work)
      : thread_([this, port, work = std::move(work)] {
          try {
            ask_for_exact_sleeps();
            ask_for_priority(kClientPriority);  // without it, times are those of a client without it
            BenchClient client(port);
            work(client);
          } catch (...) {
            trouble_ = std::current_exception();
          }
        }) {}
  ~ClientThread() {
    if (thread_.joinable()) thread_.join();
  }
  ClientThread(const ClientThread&) = delete;
  ClientThread& operator=(const ClientThread&) = delete;

  /// Waits for its work; throws what that threw.
  void end() {
    thread_.join();
    if (trouble_) std::rethrow_exception(trouble_);
  }

 private:
  std::exception_ptr trouble_;
  std::thread thread_;
};

/// Into the phantom's L3 from its upper endplate, down 20 mm.
DrillPath bench_path() {
  const Vec3 start_mm = milling_start_mm();
  return {"bench", start_mm, start_mm - 20.0 * Vec3::UnitZ(), twist_drill(3.0, 60.0, 118.0, 0.48)};
}

SessionSetup bench_setup() {
  SessionSetup setup;
  setup.path = bench_path();
  setup.engine = EngineKind::voxel;
  setup.volume.spacing_mm = 0.2;
  setup.region_mm = region_around(setup.path, 3.0, 8.0);
  setup.has_clearances = false;
  return setup;
}

LinkServerOptions bench_server() { return {.port = 0}; }

struct RoundTrips {
  TimeSpread time;
  std::uint64_t sent = 0, returned = 0, late = 0, others = 0, mesh_updates = 0, mesh_lost = 0;
  std::uint64_t nonsense_bytes = 0, nonsense_connections = 0;
  LinkLoopReport loop;
  LinkReport network;
};

RoundTrips measure_round_trips(const Bone& bone, const LinkBenchOptions& options, const Progress& progress) {
  const SessionSetup setup = bench_setup();
  Session session(bone, setup.path, setup, progress);
  LinkServer server(bench_server());
  LinkMesh mesh(bone.model(), setup.path.bit, setup.options.max_jump_mm, server, {.kind = LinkMeshKind::blocks});
  RoundTrips trips;
  std::optional<Nonsense> nonsense;
  if (options.nonsense_mb_s > 0.0) nonsense.emplace(server.port(), options.nonsense_mb_s);
  std::atomic<bool> ends{false};
  ClientThread client_thread(server.port(), [&](BenchClient& client) {
    client.take(wall_ns() + 500'000'000);  // the whole bone
    const auto count = static_cast<std::uint64_t>(options.seconds * options.rate_hz);
    const std::int64_t start_ns = wall_ns();
    for (std::uint64_t n = 0; n < count && !ends; ++n) {
      const auto due_ns = start_ns + std::llround(1e9 * static_cast<double>(n) / options.rate_hz);
      client.take(due_ns);
      // Up and down, a bit deeper each time, and round: bone is cut all the while.
      const double time_s = static_cast<double>(n) / options.rate_hz;
      const double depth_mm = 15.0 * time_s / options.seconds + std::sin(time_s);
      const Vec3 aside_mm(2.0 * std::sin(0.7 * time_s), 2.0 * std::cos(0.9 * time_s), 0.0);
      const Vec3 down = setup.path.direction();
      client.send({setup.path.entry_mm + depth_mm * down + aside_mm, down, Vec3::Zero()}, n + 1);
      ++trips.sent;
    }
    client.take(wall_ns() + 200'000'000);
    trips.time = client.round_trip();
    trips.returned = client.returned();
    trips.late = client.late();
    trips.others = client.others();
  });
  LinkLoopOptions loop;
  loop.rate_hz = options.rate_hz;
  loop.longest_s = options.seconds + 1.0;
  trips.loop = run_link(
      session, server, loop, [&](const Cycle& cycle) { mesh.take(cutting_input(cycle, setup.options)); }, progress);
  ends = true;
  client_thread.end();
  if (nonsense) {
    nonsense->end();
    trips.nonsense_bytes = nonsense->bytes();
    trips.nonsense_connections = nonsense->connections();
  }
  mesh.end();
  trips.mesh_updates = mesh.updates();
  trips.mesh_lost = mesh.lost();
  trips.network = server.end();
  return trips;
}

/// One session that is drilled until it stops: from the pose read that crossed the threshold to the stop handed to the
/// socket, µs; nothing where it did not stop.
std::optional<double> measure_stop(const Bone& bone, const Progress& progress) {
  SessionSetup setup = bench_setup();
  setup.options.stop.thrust_n = 2.0;
  Session session(bone, setup.path, setup, progress);
  LinkServer server(bench_server());
  ClientThread client_thread(server.port(), [&](BenchClient& client) {
    const std::int64_t start_ns = wall_ns();
    const Vec3 down = setup.path.direction();
    for (std::uint64_t n = 0; n < 900 && client.stops() == 0; ++n) {
      client.send({setup.path.entry_mm + (0.005 * static_cast<double>(n) - 1.0) * down, down, Vec3::Zero()}, n + 1);
      client.take(start_ns + static_cast<std::int64_t>(n + 1) * 1'000'000);
    }
  });
  LinkLoopOptions loop;
  loop.longest_s = 1.0;
  run_link(session, server, loop, {}, progress);
  client_thread.end();
  const LinkReport report = server.end();
  return report.stops > 0 ? std::optional(report.stop_time.max_us) : std::nullopt;
}

}  // namespace

Json bench_link(const LinkBenchOptions& options, const Progress& progress) {
  check_range(options.seconds, 0.1, 3600.0, "bench", "a time (s)");
  check_range(options.nonsense_mb_s, 0.0, 1e5, "bench", "nonsense a second (MB)");
  check_range(options.rate_hz, 1.0, 10'000.0, "bench", "a rate (Hz)");
  progress.report("baking the phantom", 0.0);
  const Bone bone{milling_bone()};
  const RoundTrips trips = measure_round_trips(bone, options, progress);
  std::vector<std::int64_t> stops_ns;
  for (int n = 0; n < options.stops; ++n) {
    progress.report("stops", static_cast<double>(n) / options.stops);
    if (const std::optional<double> stop_us = measure_stop(bone, progress)) {
      stops_ns.push_back(std::llround(1e3 * *stop_us));
    }
  }
  const std::size_t stopped = stops_ns.size();
  const TimeSpread stops = spread_of(std::move(stops_ns));
  print_figure("poses sent", static_cast<double>(trips.sent), "", 0);
  print_figure("bits returned", static_cast<double>(trips.returned), "", 0);
  print_figure("round trip", spread_text(trips.time));
  print_figure("of them over 1 ms", static_cast<double>(trips.late), "", 0);
  print_figure("in the server", spread_text(trips.network.through_time));
  print_figure("updates of the bone", static_cast<double>(trips.mesh_updates), "", 0);
  print_figure("messages of other kinds", static_cast<double>(trips.others), "", 0);
  if (options.nonsense_mb_s > 0.0) {
    const double mb = 1e-6 * static_cast<double>(trips.nonsense_bytes);
    print_figure("nonsense sent", mb / trips.loop.seconds, "MB/s", 1);
    print_figure("connections of it", static_cast<double>(trips.nonsense_connections), "", 0);
  }
  print_figure("stop, pose in to socket", spread_text(stops));
  print_figure("stops", static_cast<double>(stopped), "", 0);
  if (!trips.loop.has_priority) print_figure("warning", "real-time priority not allowed for this user");
  return {{"sent", trips.sent},
          {"returned", trips.returned},
          {"late", trips.late},
          {"round_trip", spread_json(trips.time)},
          {"through", spread_json(trips.network.through_time)},
          {"cycles", trips.loop.cycles},
          {"merged", trips.loop.merged + trips.network.merged},
          {"mesh_updates", trips.mesh_updates},
          {"mesh_lost", trips.mesh_lost},
          {"others", trips.others},
          {"nonsense_bytes", trips.nonsense_bytes},
          {"nonsense_connections", trips.nonsense_connections},
          {"seconds", trips.loop.seconds},
          {"stops", stopped},
          {"stop", spread_json(stops)},
          {"has_priority", trips.loop.has_priority}};
}

void add_bench_link(CLI::App& program, Command& command) {
  const auto options = std::make_shared<LinkBenchOptions>();
  CLI::App* app =
      add_command(*program.get_subcommand("bench"), command, "link",
                  "Measure `link` over the loopback: round trips beside the live mesh, and stops",
                  "Example: spinaltap bench link --seconds 60 --json link.json\n"
                  "A virtual L3 is drilled by a client that sends poses at --rate; then sessions are drilled\n"
                  "until a rule stops them.");
  app->add_option("--seconds", options->seconds, "How long round trips are measured, s")
      ->capture_default_str()
      ->type_name("S");
  app->add_option("--rate", options->rate_hz, "Poses a second, Hz")->capture_default_str()->type_name("HZ");
  app->add_option("--stops", options->stops, "Sessions that are stopped")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str()
      ->type_name("N");
  app->add_option("--garbage-rate", options->nonsense_mb_s,
                  "So much nonsense a second comes from another peer meanwhile, MB; it connects again when refused")
      ->capture_default_str()
      ->type_name("MB");
  command.run = [options](const Progress& progress) { return bench_link(*options, progress); };
}

}  // namespace spinaltap
