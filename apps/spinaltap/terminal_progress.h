#pragma once

#include "core/base/progress.h"

namespace spinaltap {

/// Progress for a program: where the error stream is a terminal and a stage takes over a second, a bar with the stage's
/// name on one line, removed when the stage ends; otherwise nothing. What follows a colon in the name may change as the
/// stage goes on: a rate, the time left. Ctrl-C and SIGTERM cancel the work, a second
/// Ctrl-C kills it. To be called once.
Progress terminal_progress();

}  // namespace spinaltap
