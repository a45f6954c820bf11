#pragma once

namespace spinaltap {

/// Keeps GDCM from printing: a library of ours never does. Call it before any other use of GDCM, from any thread.
void silence_gdcm();

/// While any of these lives, what the process writes to its standard error is lost.
///
/// The JPEG and JPEG 2000 decoders within GDCM write there about every damaged picture and cannot be told not to; a
/// library of ours prints nothing.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;
};

}  // namespace spinaltap
