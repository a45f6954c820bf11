#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/report/grade_report.h"
#include "core/files/json_file.h"
#include "core/tool/drill_path.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// The options of commands that take a path from the command line.
struct PathOptions {
  std::vector<double> entry_mm;   ///< empty or three numbers, patient LPS
  std::vector<double> target_mm;  ///< empty or three numbers, patient LPS
  std::vector<std::string> via;   ///< places between of a curved path, each "x,y,z"
  std::string profile;            ///< of the bit, see read_bit_profile(); empty: by its sizes
  DrillBit sizes;
  std::optional<double> width_mm, thickness_mm, stroke_mm;  ///< of a plate
  std::vector<double> width_along;                          ///< empty or three numbers, patient LPS

  /// Adds --entry, --target, --via, and those of the bit: --bit, or --shape, --bit-length and --diameter, --tip-length,
  /// --tip-diameter, --shank-diameter, or of a plate --width, --thickness, --stroke, --width-along.
  void add_to(CLI::App& app);
  /// The bit that was asked for; where none was, for a curved path steerable_head(). Throws Error as
  /// read_bit_profile() does, and where sizes are missing or are of other shapes.
  DrillBit bit() const;
  /// The path that was given, if one was. Throws Error when only half of it was, and on places that are none.
  std::optional<DrillPath> given_path(const std::string& name) const;

 private:
  DrillBit plate() const;
};

/// Prints paths and gives them as JSON.
Json report_paths(const std::vector<DrillPath>& paths);

/// The paths of those sides that have one, with their grades and safe zones.
std::vector<GradedPath> graded_paths(const std::vector<Suggestion>& suggestions);

/// Prints what was found of a vertebra and suggested for it, and gives it as JSON. `graded`: graded_paths(), with what
/// is known of their uncertainty.
Json report_suggestions(const Bone& bone, const std::vector<Suggestion>& suggestions,
                        const std::vector<GradedPath>& graded);

/// The report on suggested paths, and on pedicles without one, as HTML. `head`: of report_head(); `screws`: the table
/// that they were chosen from, empty: the shipped one.
std::string planning_report(GradeReportData head, const std::vector<Suggestion>& suggestions,
                            const std::vector<GradedPath>& graded, const std::filesystem::path& screws,
                            const Progress& progress);

/// Writes it.
void write_planning_report(const GradeReportData& head, const std::vector<Suggestion>& suggestions,
                           const std::vector<GradedPath>& graded, const std::filesystem::path& screws,
                           const std::filesystem::path& file, const Progress& progress);

}  // namespace spinaltap
