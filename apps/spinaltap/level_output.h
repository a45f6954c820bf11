#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

#include "core/ct/level.h"
#include "core/files/json_file.h"
#include "core/segment/warning_metadata.h"

namespace spinaltap {

/// Adds --level, which says which bone of a spine.vdb is meant. `level` must outlive the app.
CLI::Option* add_level(CLI::App& app, Level& level);

/// How vertebrae came by their names, in words.
std::string words_of(NameSource source, std::span<const LevelPoint> given);

/// One line a vertebra: where its body is, its size, volume and severity. Below, their warnings.
void print_levels(std::span<const LevelReport> levels);

/// Prints warnings and severity.
void print_warnings(const LevelWarnings& warnings);

/// All that is known of a vertebra.
Json to_json(const LevelReport& level);

/// Says which vertebrae are suspect, and what it means; nothing where none is. Gives the exit code.
int say_suspect(std::span<const std::string> names, bool accepts_warnings);

/// As above, for one bone: `name` may be empty.
int say_suspect(const std::string& name, const LevelWarnings& warnings, bool accepts_warnings);

/// Says where vertebrae may have been missed, a line each and as "gaps" of `figures`. Gives the exit code.
int say_gaps(std::span<const std::string> gaps, bool accepts_warnings, Json& figures);

}  // namespace spinaltap
