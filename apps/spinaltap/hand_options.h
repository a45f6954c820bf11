#pragma once

#include <CLI/CLI.hpp>

#include "apps/report/hand_choice.h"

namespace spinaltap {

/// --step, --offset, --tilt.
void add_straight_hand(CLI::App& app, HandChoice& hand);
/// The other options of hands.
void add_hand(CLI::App& app, HandChoice& hand);

}  // namespace spinaltap
