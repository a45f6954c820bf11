#pragma once

namespace spinaltap {

/// While any of these lives, what the process writes to its standard error is lost: ProcessChanges::silences_decoders.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;
};

}  // namespace spinaltap
