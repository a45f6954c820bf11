#pragma once

#include <CLI/CLI.hpp>

#include "core/ct/level.h"

namespace spinaltap {

/// Adds --level, which says which bone of a spine.vdb is meant. `level` must outlive the app.
CLI::Option* add_level(CLI::App& app, Level& level);

}  // namespace spinaltap
