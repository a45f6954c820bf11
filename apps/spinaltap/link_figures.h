#pragma once

#include "apps/link/linked_session.h"
#include "core/files/json_file.h"

namespace spinaltap {

/// For people, on standard output.
void print_linked(const LinkedSession& linked);
std::string spread_text(const TimeSpread& spread);
Json spread_json(const TimeSpread& spread);
Json linked_json(const LinkedSession& linked);

}  // namespace spinaltap
