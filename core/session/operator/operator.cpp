#include "core/session/operator/operator.h"

namespace spinaltap {

std::string_view name_of(OperatorEnd end) {
  switch (end) {
    case OperatorEnd::as_planned:
      return "as planned";
    case OperatorEnd::broke_through:
      return "broke through";
    case OperatorEnd::stood_still:
      return "stood still";
    case OperatorEnd::ran_out_of_time:
      return "ran out of time";
    case OperatorEnd::device_lost:
      return "device lost";
  }
  return "";
}

}  // namespace spinaltap
