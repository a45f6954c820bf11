#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <span>
#include <string>

#include "apps/report/grade_report.h"
#include "apps/spinaltap/ct_options.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// The options of commands that write a report on paths.
struct PageOptions {
  CtOptions ct;       ///< only what it reads
  std::string title;  ///< empty: the bone's level, or what the command says
  std::string command;

  /// Adds --ct, --series, --resample, --crop and --title; `command` becomes what is shown of the command line.
  void add_to(CLI::App& app);
  /// The CT, where one was given. Throws Error where it does not hold each of the bones.
  std::optional<CtVolume> read(std::span<const Bone> bones, const Progress& progress) const;
  /// The title: as given, else the bone's level, else `otherwise`.
  std::string title_of(const Bone& bone, const std::string& otherwise) const;
};

/// A command line as a report may show it: files, folders, series and names by what they are, not by their names.
std::string shown_command(CLI::App& app);

/// "2026-11-24", by the machine's clock and zone.
std::string today();

/// A report's head and pictures: title, date and command; the bone with its landmarks; the CT, or without one the
/// numbers that the bone keeps, which `kept` then holds.
GradeReportData report_head(const std::string& title, const std::string& command, const Bone& bone,
                            const std::optional<CtVolume>& ct, CtVolume& kept);

}  // namespace spinaltap
