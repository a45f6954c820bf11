#pragma once

#include <stdexcept>
#include <string>

#include "core/base/text_writer.h"

namespace spinaltap {

/// Thrown by setup code. The message is one line that says what was expected, what was found and where,
/// so that a person can act on it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown out of long work when its Progress was cancelled. Nothing has been written then.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

/// Throws Error with its arguments written one after the other: fail("expected ", n, " slices, found ", m).
template <class... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  throw Error(joined(parts...));
}

}  // namespace spinaltap
