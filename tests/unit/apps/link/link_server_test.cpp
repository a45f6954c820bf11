// A drilling over sockets of the loopback, with peers that behave and peers that do not. What is asserted is what
// happened, not how fast: docs/link.md has that.

#include "apps/link/link_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/link/link_loop.h"
#include "core/base/error.h"
#include "core/files/json_file.h"
#include "tests/support/analytic_bodies.h"
#include "tests/unit/apps/link/link_peer.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

using test::LinkTestPeer;
using testing::HasSubstr;

LinkServerOptions quiet_options() {
  return {.port = 0, .state_rate_hz = 50.0, .patience_s = 0.4, .wants_priority = false};
}

/// A ball of bone far from the origin, and a path through its middle, oblique to all axes.
struct BallToDrill {
  DrillPath path{"block", kEntryMm, kEntryMm + 20.0 * kInto, twist_drill(3.0, 60.0, 118.0, 0.48)};
  Bone bone{test::bake_ball({kEntryMm + 12.0 * kInto, 12.0}, 0.5, 400)};

  Session session(const StopRules& stop = {}) const {
    SessionSetup setup;
    setup.engine = EngineKind::ring;
    setup.volume = {.radius_mm = 2.5, .spacing_mm = 0.1, .lead_in_mm = 2.0};
    setup.options.stop = stop;
    setup.has_clearances = false;
    return Session(bone, path, setup);
  }
  Pose at(double depth_mm) const { return {kEntryMm + depth_mm * kInto, kInto}; }

 private:
  static inline const Vec3 kEntryMm{31.0, 212.0, -618.0};
  static inline const Vec3 kInto = Vec3(-0.36, -0.8, 0.48).normalized();
};

/// The ball, a session that drills it, and the loop of the link.
class LinkedBlock {
 public:
  explicit LinkedBlock(const LinkServerOptions& server = quiet_options(), const StopRules& stop = {},
                       double stale_s = 0.5)
      : session_(ball_.session(stop)), server_(server) {
    loop_.longest_s = 120.0;
    loop_.wants_priority = false;
    loop_.tracking.stale_s = stale_s;
    thread_ = std::thread([this] {
      report_ = run_link(
          session_, server_, loop_,
          [this](const Cycle& cycle) {
            const std::lock_guard lock(mutex_);
            cycles_.push_back(cycle);
            is_stopped_ = session_.is_stopped();
          },
          progress_);
    });
  }
  ~LinkedBlock() { end(); }

  /// Ends the session, whatever its peers do.
  const LinkLoopReport& end() {
    if (thread_.joinable()) {
      progress_.cancel();
      thread_.join();
      network_ = server_.end();
    }
    return report_;
  }
  /// After end().
  const LinkReport& network() const { return network_; }
  std::uint64_t refused(LinkRejection why) const { return network_.refused[static_cast<std::size_t>(why)]; }

  std::uint16_t port() const { return server_.port(); }
  LinkServer& server() { return server_; }
  LinkTransform at(double depth_mm) const { return bit_in_ras(ball_.at(depth_mm)); }
  std::vector<Cycle> cycles() {
    const std::lock_guard lock(mutex_);
    return cycles_;
  }
  /// By a rule; as of the last cycle: the session is the loop's.
  bool is_stopped() {
    const std::lock_guard lock(mutex_);
    return is_stopped_;
  }
  const BallToDrill& ball() const { return ball_; }

 private:
  BallToDrill ball_;
  Session session_;
  LinkServer server_;
  LinkLoopOptions loop_;
  Progress progress_{[](std::string_view, double) {}};
  std::mutex mutex_;
  std::vector<Cycle> cycles_;
  bool is_stopped_ = false;
  LinkLoopReport report_;
  LinkReport network_;
  std::thread thread_;
};

void wait_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// Drills from one depth to another, a pose at a time, each after the bit of the last has come back. False where none
/// does.
bool drill(LinkTestPeer& peer, LinkedBlock& linked, double from_mm, double to_mm, int poses,
           const std::string& device = "Tool") {
  for (int n = 0; n < poses; ++n) {
    const double depth_mm = from_mm + (to_mm - from_mm) * (n + 1) / poses;
    if (!peer.send_transform(device, linked.at(depth_mm)) || !peer.receive("TRANSFORM", "Bit")) return false;
  }
  // The bit is sent before whoever observes has its cycle.
  for (int n = 0; n < 2000; ++n) {
    const std::vector<Cycle> cycles = linked.cycles();
    if (!cycles.empty() && std::abs(cycles.back().depth_mm - to_mm) < 1e-3) return true;
    wait_s(0.001);
  }
  return false;
}

TEST(LinkServer, DrillsWithOpenIGTLinksOwnClient) {
  LinkedBlock linked;
  const igtl::ClientSocket::Pointer socket = igtl::ClientSocket::New();
  ASSERT_EQ(socket->ConnectToServer("127.0.0.1", linked.port()), 0);
  // As the library's own examples send and receive.
  const Vec3 tip_mm = linked.at(2.0).translation();
  int bits = 0;
  double max_off_mm = 0.0;
  for (int n = 0; n < 50; ++n) {
    const igtl::TransformMessage::Pointer tool = igtl::TransformMessage::New();
    tool->SetDeviceName("Tool");
    const LinkTransform at = linked.at(-1.0 + 0.05 * n);
    igtl::Matrix4x4 matrix;
    igtl::IdentityMatrix(matrix);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) matrix[row][column] = static_cast<float>(at.matrix()(row, column));
    }
    tool->SetMatrix(matrix);
    tool->Pack();
    ASSERT_TRUE(socket->Send(tool->GetPackPointer(), tool->GetPackSize()));
    for (bool is_bit = false; !is_bit;) {
      const igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
      header->InitPack();
      ASSERT_EQ(socket->Receive(header->GetPackPointer(), header->GetPackSize()), header->GetPackSize());
      header->Unpack();
      if (std::string(header->GetDeviceType()) != "TRANSFORM") {
        socket->Skip(header->GetBodySizeToRead(), 0);
        continue;
      }
      const igtl::TransformMessage::Pointer bit = igtl::TransformMessage::New();
      bit->SetMessageHeader(header);
      bit->AllocatePack();
      socket->Receive(bit->GetPackBodyPointer(), bit->GetPackBodySize());
      ASSERT_TRUE(bit->Unpack(1) & igtl::MessageHeader::UNPACK_BODY);
      bit->GetMatrix(matrix);
      is_bit = true;
      ++bits;
      for (int row = 0; row < 3; ++row) {
        max_off_mm = std::max(max_off_mm, std::abs(static_cast<double>(matrix[row][3]) - at.translation()[row]));
      }
    }
  }
  socket->CloseSocket();
  linked.end();
  EXPECT_EQ(bits, 50);
  EXPECT_LT(max_off_mm, 1e-4);  // of floats some 600 mm away
  const std::vector<Cycle> cycles = linked.cycles();
  ASSERT_EQ(cycles.size(), 50U);
  EXPECT_LT((cycles.back().pose.tip_mm - linked.ball().at(-1.0 + 0.05 * 49).tip_mm).norm(), 1e-4);
  EXPECT_LT((ras_from_lps(linked.ball().at(2.0).tip_mm) - tip_mm).norm(), 1e-9);
  EXPECT_GT(cycles.back().force.thrust_n, 1.0);
  EXPECT_EQ(linked.network().refused_in_all(), 0U);
}

TEST(LinkServer, CutsWhatTheSameWayCutsWithoutALink) {
  LinkedBlock linked;
  LinkTestPeer peer(linked.port());
  ASSERT_TRUE(drill(peer, linked, -1.0, 4.0, 200));
  linked.end();
  std::size_t removed = 0;
  for (const Cycle& cycle : linked.cycles()) removed += cycle.step.removed;
  const BallToDrill alone;
  Session session = alone.session();
  std::size_t expected = 0;
  for (int n = 0; n < 200; ++n)
    expected += session.step_input({alone.at(-1.0 + 5.0 * (n + 1) / 200.0), n > 0}).step.removed;
  // Floats shift the tip by 3e-5 mm; the points of a disc, 0.1 mm apart, lie on the tip's side or not.
  EXPECT_NEAR(static_cast<double>(removed), static_cast<double>(expected), 0.01 * static_cast<double>(expected));
  EXPECT_GT(expected, 10'000U);
}

TEST(LinkServer, TellsStateEventsPlanAndStatusAndEndsAtACommand) {
  LinkServerOptions options = quiet_options();
  options.points = {{"Entry", "Plan", Vec3(1.0, 2.0, 3.0), 1.5}};
  LinkedBlock linked(options);
  LinkTestPeer peer(linked.port());
  EXPECT_TRUE(peer.receive("STATUS", "SpinalTap"));
  const std::optional<LinkMessage> plan = peer.receive("POINT", "Plan");
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->content.size(), 136U);
  ASSERT_TRUE(drill(peer, linked, -1.0, 1.0, 20));
  const std::optional<LinkMessage> event = peer.receive("STRING", "Event");
  ASSERT_TRUE(event);
  EXPECT_EQ(parse_json(*string_of(event->content), "event")["event"], "contact");
  const auto is_drilling = [](const LinkMessage& message) {
    return message.type == "STRING" && message.device == "State" &&
           parse_json(*string_of(message.content), "state")["depth_mm"].get<double>() >
               1.075;  // the second of two poses
  };
  ASSERT_TRUE(drill(peer, linked, 1.0, 1.1, 2));
  const std::optional<LinkMessage> state = peer.receive(is_drilling);
  ASSERT_TRUE(state);
  const Json json = parse_json(*string_of(state->content), "state");
  EXPECT_NEAR(json["depth_mm"].get<double>(), 1.1, 1e-3);
  EXPECT_EQ(json["tracking"], "ok");
  EXPECT_EQ(json["spindle_on"], true);
  peer.send_string("Command", "spindle off");
  ASSERT_TRUE(peer.receive("STRING", "Answer"));
  ASSERT_TRUE(drill(peer, linked, 1.1, 1.2, 1));
  EXPECT_FALSE(linked.cycles().back().input.spindle_on);
  peer.send_string("Command", "make tea");
  EXPECT_THAT(*string_of(peer.receive("STRING", "Answer")->content), HasSubstr("\"done\":false"));
  peer.send(pack_message("GET_CAPABIL", "", ""));
  EXPECT_TRUE(peer.receive("CAPABILITY", "SpinalTap"));
  peer.send_string("Command", "END");
  wait_s(0.2);
  EXPECT_TRUE(linked.end().is_ended);
  EXPECT_EQ(linked.refused(LinkRejection::command), 1U);
}

TEST(LinkServer, SendsAStopWhereARuleAsksForOne) {
  LinkedBlock linked(quiet_options(), {.thrust_n = 2.0});
  LinkTestPeer peer(linked.port());
  for (int n = 0; n < 100 && !linked.is_stopped(); ++n) {
    ASSERT_TRUE(peer.send_transform("Tool", linked.at(-1.0 + 0.05 * n)));
    wait_s(0.002);
  }
  const std::optional<LinkMessage> stop = peer.receive("STRING", "Stop");
  ASSERT_TRUE(stop);
  const Json json = parse_json(*string_of(stop->content), "stop");
  EXPECT_EQ(json["event"], "stop: thrust");
  EXPECT_GE(json["value"].get<double>(), 2.0);
  linked.end();
  EXPECT_EQ(linked.network().stops, 1U);
}

TEST(LinkServer, ListensAtTheLoopbackAloneUnlessToldOtherwise) {
  const auto address_of = [](const LinkServer& server) {
    TextStream port;
    port << ":" << std::hex << std::uppercase << server.port() << " ";
    std::ifstream sockets("/proc/net/tcp");
    std::string found;
    for (std::string line; std::getline(sockets, line);) {
      const std::size_t at = line.find(port.str());
      if (at != std::string::npos && line.find("00000000:0000 0A") != std::string::npos) found = line.substr(at - 8, 8);
    }
    return found;
  };
  const LinkServer loopback(quiet_options());
  EXPECT_EQ(address_of(loopback), "0100007F");
  LinkServerOptions all = quiet_options();
  all.bind_address = "0.0.0.0";
  EXPECT_EQ(address_of(LinkServer(all)), "00000000");
  LinkServerOptions taken = quiet_options();
  taken.port = loopback.port();
  EXPECT_THROW(LinkServer{taken}, Error);
  LinkServerOptions nowhere = quiet_options();
  nowhere.bind_address = "no address";
  EXPECT_THROW(LinkServer{nowhere}, Error);
  LinkServerOptions unnamed = quiet_options();
  unnamed.names.tool = "a name that is longer than a field";
  EXPECT_THROW(LinkServer{unnamed}, Error);
}

TEST(LinkServer, ClosesOnGarbageAndGoesOnWithTheOthers) {
  LinkedBlock linked;
  LinkTestPeer good(linked.port()), bad(linked.port());
  ASSERT_TRUE(drill(good, linked, -1.0, 0.0, 10));
  bad.send(std::string(1000, 'x'));
  EXPECT_TRUE(bad.is_closed());
  std::string damaged = pack_message("TRANSFORM", "Tool", transform_content(linked.at(0.0)));
  damaged.back() = '\x55';
  good.send(damaged);
  LinkTransform scaled = linked.at(0.0);
  scaled.linear() *= 2.0;
  good.send_transform("Tool", scaled);
  ASSERT_TRUE(drill(good, linked, 0.0, 1.0, 10));
  linked.end();
  EXPECT_EQ(linked.refused(LinkRejection::header), 1U);
  EXPECT_EQ(linked.refused(LinkRejection::checksum), 1U);
  EXPECT_EQ(linked.refused(LinkRejection::content), 1U);
  EXPECT_EQ(linked.cycles().size(), 20U);
}

TEST(LinkServer, LetsNobodyInForAMomentAfterNonsense) {
  LinkedBlock linked;
  LinkTestPeer bad(linked.port());
  bad.send(std::string(1000, 'x'));
  ASSERT_TRUE(bad.is_closed());
  const auto begin = std::chrono::steady_clock::now();
  LinkTestPeer next(linked.port());
  ASSERT_TRUE(next.receive([](const LinkMessage& message) { return message.type == "STATUS"; }));
  // 50 ms, of which some have gone by until the end of the other was seen.
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(20));
  ASSERT_TRUE(drill(next, linked, -1.0, 0.0, 10));
  linked.end();
}

TEST(LinkServer, LeavesTheToolToWhoeverSentItFirst) {
  LinkedBlock linked(quiet_options(), {}, 0.3);
  LinkTestPeer first(linked.port()), second(linked.port());
  ASSERT_TRUE(drill(first, linked, -1.0, -0.9, 2));
  ASSERT_TRUE(second.send_transform("Tool", linked.at(5.0)));
  ASSERT_TRUE(drill(first, linked, -0.9, -0.8, 2));
  EXPECT_LT(linked.cycles().back().depth_mm, 0.0);
  first.close();
  wait_s(0.1);
  ASSERT_TRUE(drill(second, linked, -0.8, -0.7, 2));
  linked.end();
  EXPECT_EQ(linked.refused(LinkRejection::not_in_charge), 1U);
}

TEST(LinkServer, ClosesOnHalfMessagesAndOnPeersThatDoNotRead) {
  LinkedBlock linked;
  LinkTestPeer good(linked.port()), half(linked.port()), hanging(linked.port());
  half.send(pack_message("TRANSFORM", "Tool", transform_content(linked.at(0.0))).substr(0, 70));
  // More than sockets keep: what is never read must not grow in the server.
  const std::vector<Eigen::Vector3f> vertices_mm(200'000, Eigen::Vector3f::Zero());
  const std::vector<std::array<std::uint32_t, 3>> triangles(400'000, {0, 1, 2});
  const std::string large = polydata_content(vertices_mm, triangles);
  std::thread reader([&] {
    // A peer that reads gets all of them.
    EXPECT_TRUE(good.receive("POLYDATA", "Large3", 20.0));
  });
  for (int n = 0; n < 4; ++n) linked.server().give_surfaces({{"Large" + std::to_string(n), large}});
  reader.join();
  EXPECT_TRUE(half.is_closed());
  std::uint64_t closed = 0;
  for (int n = 0; n < 100 && closed == 0; ++n) {
    wait_s(0.05);
    closed = linked.server().report().refused[static_cast<std::size_t>(LinkRejection::hanging)];
  }
  EXPECT_EQ(closed, 1U);
  ASSERT_TRUE(drill(good, linked, -1.0, 0.0, 10));
  linked.end();
  EXPECT_EQ(linked.refused(LinkRejection::half), 1U);
}

TEST(LinkServer, TakesNoMorePeersThanItMayHave) {
  LinkServerOptions options = quiet_options();
  options.max_peers = 2;
  LinkedBlock linked(options);
  LinkTestPeer first(linked.port()), second(linked.port());
  ASSERT_TRUE(first.receive("STATUS", "SpinalTap"));
  ASSERT_TRUE(second.receive("STATUS", "SpinalTap"));
  LinkTestPeer third(linked.port());
  EXPECT_TRUE(third.is_closed());
  first.close();
  wait_s(0.1);
  LinkTestPeer fourth(linked.port());
  EXPECT_TRUE(fourth.receive("STATUS", "SpinalTap"));
}

TEST(LinkServer, DrillsOnUnderAFloodOfNonsense) {
  LinkedBlock linked;
  std::atomic<bool> ends{false};
  std::vector<std::thread> floods;
  // As fast as sockets take it: an image of which nobody wants a byte, transforms of a device that nobody knows, and
  // bytes that are nothing at all, from a peer that comes again and again.
  const std::string image = pack_message("IMAGE", "US", std::string(1'000'000, 'x'));
  std::string strangers;
  for (int n = 0; n < 5000; ++n) strangers += pack_message("TRANSFORM", "Stranger", transform_content(linked.at(0.0)));
  const std::string nothing(100'000, '\x5A');
  for (const std::string* bytes : std::array<const std::string*, 3>{&image, &strangers, &nothing}) {
    floods.emplace_back([&, bytes] {
      while (!ends) {
        LinkTestPeer peer(linked.port());
        while (!ends && peer.send(*bytes)) {
        }
      }
    });
  }
  LinkTestPeer good(linked.port());
  const bool is_whole = drill(good, linked, -1.0, 4.0, 300);
  // A flood sleeps in send() while the server does not read it: ending the session lets it go.
  ends = true;
  linked.end();
  for (std::thread& flood : floods) flood.join();
  EXPECT_TRUE(is_whole);
  EXPECT_EQ(linked.cycles().size(), 300U);
  EXPECT_GT(linked.refused(LinkRejection::header), 0U);
  EXPECT_GT(linked.refused(LinkRejection::type), 0U);
  EXPECT_GT(linked.refused(LinkRejection::device), 1000U);
  EXPECT_GT(linked.network().bytes_in, 1'000'000U);
}

TEST(LinkServer, LetsForcesGoAndCutsNothingWhereTheCableIsPulled) {
  LinkedBlock linked(quiet_options(), {}, 0.2);
  LinkTestPeer watcher(linked.port());
  {
    LinkTestPeer peer(linked.port());
    ASSERT_TRUE(drill(peer, linked, -1.0, 3.0, 60));
    ASSERT_GT(linked.cycles().back().force.thrust_n, 1.0);
  }  // gone without a word
  const auto is_silent = [](const LinkMessage& message) {
    return message.device == "State" && string_of(message.content)->find("\"tracking\":\"stale\"") != std::string::npos;
  };
  const std::optional<LinkMessage> silent = watcher.receive(is_silent);
  ASSERT_TRUE(silent);
  const Json state = parse_json(*string_of(silent->content), "state");
  EXPECT_EQ(state["thrust_n"], 0.0);
  const std::size_t before = linked.cycles().size();
  wait_s(0.3);
  EXPECT_EQ(linked.cycles().size(), before);
  // It comes back 10 mm deeper: the way there is not cut, but what it stands in when it drills again.
  LinkTestPeer again(linked.port());
  ASSERT_TRUE(drill(again, linked, 13.0, 13.0, 1));
  EXPECT_EQ(linked.cycles().back().step.removed, 0U);
  ASSERT_TRUE(drill(again, linked, 13.0, 13.05, 1));
  const LinkLoopReport& report = linked.end();
  EXPECT_EQ(report.gaps, 1U);
  EXPECT_GE(report.silences, 1U);
}

TEST(LinkServer, GoesByTheClockOfArrivalWhateverSendersClocksDo) {
  LinkedBlock linked;
  LinkTestPeer peer(linked.port());
  constexpr std::uint64_t kDay = std::uint64_t{86'400} << 32U;
  for (int n = 0; n < 40; ++n) {
    const std::uint64_t time_stamp = n % 3 == 0 ? 1 : n % 3 == 1 ? 20'000 * kDay : ~std::uint64_t{0};
    ASSERT_TRUE(peer.send_transform("Tool", linked.at(-1.0 + 0.05 * n), time_stamp));
    const std::optional<LinkMessage> bit = peer.receive("TRANSFORM", "Bit");
    ASSERT_TRUE(bit);
    EXPECT_EQ(bit->time_stamp, time_stamp);  // so that senders know which pose it answers
  }
  linked.end();
  for (const Cycle& cycle : linked.cycles()) {
    EXPECT_GT(cycle.input.dt_s, 0.0);
    EXPECT_LT(cycle.input.dt_s, 5.0);
  }
  EXPECT_EQ(linked.cycles().size(), 40U);
}

TEST(LinkServer, ConnectsToATrackerAndAgainWhenItComesBack) {
  const igtl::ServerSocket::Pointer tracker = igtl::ServerSocket::New();
  int port = 20'000 + static_cast<int>(::getpid() % 20'000);
  while (tracker->CreateServer(port) != 0) ++port;
  LinkServerOptions options = quiet_options();
  options.bind_address.clear();
  options.connect_host = "127.0.0.1";
  options.connect_port = static_cast<std::uint16_t>(port);
  LinkedBlock linked(options);
  EXPECT_EQ(linked.port(), 0);
  for (int round = 0; round < 2; ++round) {
    const igtl::ClientSocket::Pointer peer = tracker->WaitForConnection(5000);
    ASSERT_TRUE(peer.IsNotNull()) << round;
    for (int n = 0; n < 20; ++n) {
      const std::string bytes = pack_message("TRANSFORM", "Tool", transform_content(linked.at(-1.0 + 0.05 * n)));
      ASSERT_TRUE(peer->Send(bytes.data(), static_cast<int>(bytes.size())));
      wait_s(0.005);
    }
    peer->CloseSocket();
  }
  tracker->CloseSocket();
  linked.end();
  EXPECT_EQ(linked.network().peers, 2U);
  EXPECT_GT(linked.cycles().size(), 10U);
}

TEST(ForceShare, FallsToNothingWithinFiftyMilliseconds) {
  EXPECT_EQ(force_share(0.0), 1.0);
  EXPECT_EQ(force_share(0.02), 1.0);
  EXPECT_NEAR(force_share(0.035), 0.5, 1e-12);
  EXPECT_EQ(force_share(0.05), 0.0);
  EXPECT_EQ(force_share(10.0), 0.0);
}

TEST(RunLink, RejectsRatesAndTimesThatMakeNoSense) {
  Session session = BallToDrill().session();
  LinkServer server(quiet_options());
  EXPECT_THROW(run_link(session, server, {.rate_hz = 0.0}), Error);
  EXPECT_THROW(run_link(session, server, {.rate_hz = std::nan("")}), Error);
  EXPECT_THROW(run_link(session, server, {.longest_s = 0.0}), Error);
  EXPECT_THROW(run_link(session, server, {.tracking = {.stale_s = -1.0}}), Error);
}

}  // namespace
}  // namespace spinaltap
