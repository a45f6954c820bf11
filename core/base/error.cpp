#include "core/base/error.h"

namespace spinaltap {

std::string_view name_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::input:
      return "input";
    case ErrorKind::geometry:
      return "geometry";
    case ErrorKind::file:
      return "file";
    case ErrorKind::disk:
      return "disk";
    case ErrorKind::unsupported:
      return "unsupported";
    case ErrorKind::cancelled:
      return "cancelled";
    case ErrorKind::internal:
      return "internal";
  }
  return "";
}

}  // namespace spinaltap
