#include "apps/spinaltap/link_figures.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/report/session_report.h"
#include "apps/spinaltap/command.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

void print_count(const std::string& name, std::uint64_t count) {
  print_figure(name, static_cast<double>(count), "", 0);
}

}  // namespace

std::string spread_text(const TimeSpread& spread) {
  return "p50 " + fixed_text(1e-3 * spread.p50_us, 3) + ", p99 " + fixed_text(1e-3 * spread.p99_us, 3) + ", p99.9 " +
         fixed_text(1e-3 * spread.p999_us, 3) + ", max " + fixed_text(1e-3 * spread.max_us, 3) + " ms";
}

Json spread_json(const TimeSpread& spread) {
  return {{"p50_us", spread.p50_us}, {"p99_us", spread.p99_us}, {"p999_us", spread.p999_us}, {"max_us", spread.max_us}};
}

void print_linked(const LinkedSession& linked) {
  const LinkLoopReport& loop = linked.loop;
  const LinkReport& network = linked.network;
  print_figure("linked for", loop.seconds, "s", 2);
  print_count("poses of the tool", loop.poses);
  print_count("cycles", loop.cycles);
  print_count("poses merged", loop.merged + network.merged);
  print_count("poses that were not valid", loop.unseen);
  print_count("gaps that were not cut", loop.gaps);
  print_figure("longest gap", loop.longest_gap_s, "s", 3);
  print_figure("pose in to bit out", spread_text(network.through_time));
  print_count("of them over 1 ms", network.late);
  print_figure("cycle", spread_text(loop.step_time));
  if (network.stops > 0) print_figure("stop, pose in to stop out", spread_text(network.stop_time));
  print_count("peers", network.peers);
  print_count("messages", network.messages);
  print_figure("bytes in", 1e-6 * static_cast<double>(network.bytes_in), "MB", 3);
  print_figure("bytes out", 1e-6 * static_cast<double>(network.bytes_out), "MB", 3);
  print_count("not sent to slow peers", network.dropped);
  for (std::size_t n = 0; n < kLinkRejections; ++n) {
    if (network.refused[n] == 0) continue;
    print_count("refused, " + std::string(name_of(static_cast<LinkRejection>(n))), network.refused[n]);
  }
  if (!loop.has_priority) print_figure("warning", "real-time priority not allowed for this user");
  print_figure("max depth", linked.max_depth_mm, "mm", 2);
  print_figure("max thrust", linked.max_thrust_n, "N", 2);
  if (linked.mesh_lost > 0) {
    print_figure("warning", std::to_string(linked.mesh_lost) +
                                " cycles came too fast for the bone that was sent: it shows bone that is gone");
  }
  if (linked.not_recorded > 0) print_count("cycles not recorded", linked.not_recorded);
  constexpr std::size_t kMax = 24;
  for (std::size_t n = 0; n < linked.events.size() && n < kMax; ++n) {
    const SessionEvent& event = linked.events[n];
    std::printf("  %9s s  at %7s mm  %-14s %s\n", fixed_text(event.time_s, 3).c_str(),
                fixed_text(event.depth_mm, 2).c_str(), std::string(name_of(event.kind)).c_str(),
                value_text(event).c_str());
  }
  if (linked.events.size() > kMax) std::printf("  and %zu further events\n", linked.events.size() - kMax);
}

Json linked_json(const LinkedSession& linked) {
  const LinkLoopReport& loop = linked.loop;
  const LinkReport& network = linked.network;
  Json refused = Json::object();
  for (std::size_t n = 0; n < kLinkRejections; ++n) {
    refused[std::string(name_of(static_cast<LinkRejection>(n)))] = network.refused[n];
  }
  Json events = Json::array();
  for (const SessionEvent& event : linked.events) {
    events.push_back({{"event", name_of(event.kind)},
                      {"cycle", event.cycle},
                      {"time_s", event.time_s},
                      {"depth_mm", number_or_null(event.depth_mm)},
                      {"value", number_or_null(event.value)}});
  }
  return {{"seconds", loop.seconds},
          {"poses", loop.poses},
          {"cycles", loop.cycles},
          {"merged", loop.merged + network.merged},
          {"not_valid", loop.unseen},
          {"gaps", loop.gaps},
          {"silences", loop.silences},
          {"longest_gap_s", loop.longest_gap_s},
          {"through", network.through},
          {"through_time", spread_json(network.through_time)},
          {"late", network.late},
          {"cycle_time", spread_json(loop.step_time)},
          {"stops", network.stops},
          {"stop_time", spread_json(network.stop_time)},
          {"peers", network.peers},
          {"messages", network.messages},
          {"bytes_in", network.bytes_in},
          {"bytes_out", network.bytes_out},
          {"dropped", network.dropped},
          {"throttled", network.throttled},
          {"lost_inputs", network.lost_inputs},
          {"lost_outputs", network.lost_outputs},
          {"refused", std::move(refused)},
          {"has_priority", loop.has_priority},
          {"ended_by_command", loop.is_ended},
          {"mesh_updates", linked.mesh_updates},
          {"mesh_lost", linked.mesh_lost},
          {"stopped", linked.is_stopped},
          {"max_depth_mm", linked.max_depth_mm},
          {"max_thrust_n", linked.max_thrust_n},
          {"cycles_not_recorded", linked.not_recorded},
          {"events", std::move(events)}};
}

}  // namespace spinaltap
