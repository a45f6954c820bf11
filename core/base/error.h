#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/base/text_writer.h"

namespace spinaltap {

/// What an error is about, so that a program can act on it; its words are for a person. docs/exit-codes.md has the
/// table for C++, C, Python and the command line. Numbers are part of the C interface: only add at the end.
enum class ErrorKind : std::uint8_t {
  input = 1,        ///< a value, an option or a file's content is not as expected: most errors
  geometry = 2,     ///< a place, a path or a tool does not fit the bone, or no body is like that
  file = 3,         ///< a file or folder is missing, or cannot be opened
  disk = 4,         ///< something cannot be written: the disk is full, the folder is not writable
  unsupported = 5,  ///< understood, but not handled: a format, a codec, a combination
  cancelled = 6,    ///< whoever asked for it did not want to wait
  internal = 7      ///< a mistake in this library
};
/// "input", "geometry", ...
std::string_view name_of(ErrorKind kind);

/// Thrown by setup code. The message is one line that says what was expected, what was found and where,
/// so that a person can act on it.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ErrorKind kind = ErrorKind::input)
      : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

/// Thrown out of long work when its Progress was cancelled. Nothing has been written then.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled", ErrorKind::cancelled) {}
};

/// Throws Error with its arguments written one after the other: fail("expected ", n, " slices, found ", m).
template <class... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  throw Error(joined(parts...));
}
/// The same, of another kind than input.
template <class... Parts>
[[noreturn]] void fail_as(ErrorKind kind, const Parts&... parts) {
  throw Error(joined(parts...), kind);
}

}  // namespace spinaltap
