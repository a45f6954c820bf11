#pragma once

namespace spinaltap {

/// Keeps GDCM from printing: a library of ours never does. Call it before any other use of GDCM, from any thread.
void silence_gdcm();

/// While any of these lives, what the process writes to its standard error is lost: ProcessChanges::silences_decoders.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;
};

}  // namespace spinaltap
