#include "core/session/cycle.h"

namespace spinaltap {

std::string_view name_of(EventKind kind) {
  switch (kind) {
    case EventKind::contact:
      return "contact";
    case EventKind::state:
      return "state";
    case EventKind::outer_breach:
      return "outer breach";
    case EventKind::canal_breach:
      return "canal breach";
    case EventKind::breakthrough:
      return "breakthrough";
    case EventKind::stop_thrust:
      return "stop: thrust";
    case EventKind::stop_clearance:
      return "stop: clearance";
    case EventKind::stop_breach:
      return "stop: breach";
    case EventKind::plunge:
      return "plunge";
    case EventKind::invalid_pose:
      return "invalid pose";
    case EventKind::jump:
      return "jump";
    case EventKind::outside_volume:
      return "outside volume";
    case EventKind::record_lost:
      return "record lost";
    case EventKind::touch:
      return "touch";
    case EventKind::heat_limit:
      return "heat limit";
    case EventKind::device_lost:
      return "device lost";
    case EventKind::gave_up:
      return "gave up";
    case EventKind::stall:
      return "stall";
    case EventKind::tool_change:
      return "tool change";
  }
  return "";
}

}  // namespace spinaltap
