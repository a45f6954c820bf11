#pragma once

namespace spinaltap {

/// Keeps GDCM from printing: a library of ours never does. Call it before any other use of GDCM, from any thread.
void silence_gdcm();

}  // namespace spinaltap
