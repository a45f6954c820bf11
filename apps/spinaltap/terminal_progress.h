#pragma once

#include "core/base/progress.h"

namespace spinaltap {

/// Progress for a program: where the error stream is a terminal and a stage takes over a second, a bar with the stage's
/// name on one line, removed when the stage ends; otherwise nothing. What follows a colon in the name may change as the
/// stage goes on: a rate, the time left. Ctrl-C and SIGTERM cancel the work, a second
/// Ctrl-C kills it. To be called once.
Progress terminal_progress();

/// From now on SIGTERM and SIGUSR1 do not cancel: leave_signal() tells of them, for work that comes to an end where it
/// can go on later. After terminal_progress().
void leave_on_signals();
/// Name of the first of them that came; nullptr: none.
const char* leave_signal();

}  // namespace spinaltap
