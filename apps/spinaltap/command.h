#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/spinaltap/did_you_mean.h"
#include "core/base/progress.h"
#include "core/files/json_file.h"

namespace spinaltap {

// Exit codes, of all commands: docs/exit-codes.md.
constexpr int kDone = 0;
constexpr int kAnswerIsNo = 1;       ///< all was done and written: what was asked is not so
constexpr int kUsageOrInput = 2;     ///< nothing was done: of what is thrown
constexpr int kInternal = 70;        ///< a mistake of ours, ErrorKind::internal; as EX_SOFTWARE of sysexits.h
constexpr int kCancelled = 128 + 2;  ///< as shells have it for SIGINT

/// What every subcommand has: --json, --force and --threads, and what main() runs after parsing.
struct Command {
  CLI::App* app = nullptr;
  std::filesystem::path json_file;
  bool is_forced = false;  ///< outputs that are there may be replaced
  int threads = 0;
  /// What it will write, where its -o alone does not tell.
  std::function<std::vector<std::filesystem::path>()> outputs;
  /// Does the work and returns the figures for --json.
  std::function<Json(const Progress&)> run;
  int exit_code = kDone;  ///< of the program after run(), which may set it
  std::string after_stop = "nothing was written; the same command begins again";  ///< said after Ctrl-C
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
void add_link(CLI::App& program, Command& command);
void add_replay(CLI::App& program, Command& command);
void add_sound(CLI::App& program, Command& command);
void add_export(CLI::App& program, Command& command);
void add_heat(CLI::App& program, Command& command);
void add_study(CLI::App& program, Command& command);
void add_merge(CLI::App& program, Command& command);
void add_mesh(CLI::App& program, Command& command);
void add_render(CLI::App& program, Command& command);
void add_diff(CLI::App& program, Command& command);
void add_compare(CLI::App& program, Command& command);
void add_demo(CLI::App& program, Command& command);
void add_validate(CLI::App& program, Command& command);
void add_bench(CLI::App& program, Command& command);
void add_bench_link(CLI::App& program, Command& command);  // after add_bench()
void add_register(CLI::App& program, Command& command);
void add_pivot(CLI::App& program, Command& command);

/// The files that a command is about to write, and of folders made anew their names.
std::vector<std::filesystem::path> outputs_of(const Command& command);
/// Before the work: throws Error on an output that is there already, unless --force was given, and where --json cannot
/// be written.
void check_outputs(const Command& command);
/// Before the work: throws Error where a bone, a plan, a record, a CT or a study is by its content another of these.
void check_inputs(const CLI::App& app);

/// Takes a name and makes it the value that a map has for it; help shows the names only, errors those and the nearest.
template <class Map>
CLI::Validator one_of(const Map& values) {
  std::vector<std::string> names, numbers;
  std::string listed, by_value;
  for (const auto& [name, value] : values) {
    names.emplace_back(name);
    numbers.push_back(CLI::detail::value_string(value));
    listed += (listed.empty() ? "" : ",") + names.back();
    by_value += ";" + numbers.back() + "=" + names.back();
  }
  const auto take = [names, numbers, listed](std::string& text) -> std::string {
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) return "expected one of " + listed + ", found " + text + did_you_mean(text, names);
    text = numbers[static_cast<std::size_t>(found - names.begin())];
    return {};
  };
  // CLI11 keeps the value only: by the validator's own name shown_command() finds the value's again.
  return {take, "{" + listed + "}", by_value + ";"};
}

/// Prints "name value unit" in columns on standard output.
void print_figure(const std::string& name, double value, const std::string& unit, int digits = 2);
void print_figure(const std::string& name, const std::string& value);

}  // namespace spinaltap
