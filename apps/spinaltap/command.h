#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/progress.h"
#include "core/files/json_file.h"

namespace spinaltap {

// Exit codes, of all commands: docs/exit-codes.md.
constexpr int kDone = 0;
constexpr int kAnswerIsNo = 1;       ///< all was done and written: what was asked is not so
constexpr int kUsageOrInput = 2;     ///< nothing was done: of what is thrown
constexpr int kCancelled = 128 + 2;  ///< as shells have it for SIGINT

/// What every subcommand has: --json and --threads, and what main() runs after parsing.
struct Command {
  CLI::App* app = nullptr;
  std::filesystem::path json_file;
  int threads = 0;
  /// Does the work and returns the figures for --json.
  std::function<Json(const Progress&)> run;
  int exit_code = kDone;  ///< of the program after run(), which may set it
};

/// Adds a subcommand with the options that all have. `footer` shows an example.
CLI::App* add_command(CLI::App& program, Command& command, const std::string& name, const std::string& description,
                      const std::string& footer);

// One file each.
void add_phantom(CLI::App& program, Command& command);
void add_info(CLI::App& program, Command& command);
void add_segment(CLI::App& program, Command& command);
void add_points(CLI::App& program, Command& command);
void add_fit(CLI::App& program, Command& command);
void add_eval(CLI::App& program, Command& command);
void add_bake(CLI::App& program, Command& command);
void add_plan(CLI::App& program, Command& command);
void add_grade(CLI::App& program, Command& command);
void add_drill(CLI::App& program, Command& command);
void add_replay(CLI::App& program, Command& command);
void add_export(CLI::App& program, Command& command);
void add_study(CLI::App& program, Command& command);
void add_merge(CLI::App& program, Command& command);
void add_mesh(CLI::App& program, Command& command);
void add_render(CLI::App& program, Command& command);
void add_diff(CLI::App& program, Command& command);
void add_compare(CLI::App& program, Command& command);
void add_demo(CLI::App& program, Command& command);
void add_bench(CLI::App& program, Command& command);

/// Prints "name value unit" in columns on standard output.
void print_figure(const std::string& name, double value, const std::string& unit, int digits = 2);
void print_figure(const std::string& name, const std::string& value);

}  // namespace spinaltap
