// What STRINGs say: JSON in one line of ASCII. Places and forces are RAS, as all on the link is.
#include <nlohmann/json.hpp>

#include "apps/link/link_server.h"
#include "core/files/json_file.h"

namespace spinaltap {

std::string state_text(const LinkOutput& output, const LinkReport& report) {
  const Vec3 force_n = ras_from_lps(output.force_n);
  const Json json{{"time_s", output.time_s},
                  {"cycle", output.cycle},
                  {"tracking", name_of(output.tracking)},
                  {"spindle_on", output.spindle_on},
                  {"stop", output.is_stopped},
                  {"state", name_of(output.drill_state)},
                  {"depth_mm", number_or_null(output.depth_mm)},
                  {"thrust_n", number_or_null(output.thrust_n)},
                  {"torque_n_mm", number_or_null(output.torque_n_mm)},
                  {"force_ras_n", to_json(force_n)},
                  {"clearance_outer_mm", number_or_null(output.clearance.outer_mm)},
                  {"clearance_canal_mm", number_or_null(output.clearance.canal_mm)},
                  {"late", report.late},
                  {"refused", report.refused_in_all()}};
  return json.dump();
}

std::string event_text(const LinkOutput& output) {
  const SessionEvent& event = output.event;
  const Vec3 place_mm = ras_from_lps(event.place_mm);
  const Json json{
      {"event", name_of(event.kind)},
      {"cycle", event.cycle},
      {"time_s", event.time_s},
      {"depth_mm", number_or_null(event.depth_mm)},
      {"place_ras_mm", {number_or_null(place_mm.x()), number_or_null(place_mm.y()), number_or_null(place_mm.z())}},
      {"value", number_or_null(event.value)}};
  return json.dump();
}

}  // namespace spinaltap
