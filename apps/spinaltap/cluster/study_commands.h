#pragma once

#include "apps/spinaltap/command.h"

namespace spinaltap {

/// Exit code of a study that was told to leave: the same command goes on. As EX_TEMPFAIL of sysexits.h.
constexpr int kLeftUnfinished = 75;

// After add_study().
void add_study_submit(CLI::App& program, Command& command);
void add_study_status(CLI::App& program, Command& command);
void add_study_resume(CLI::App& program, Command& command);

}  // namespace spinaltap
