#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>

#include "apps/common/drilling.h"
#include "apps/common/json_file.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// The options of commands that drill.
struct DrillOptions {
  std::filesystem::path material;  ///< empty: the shipped law
  DrillingOptions drilling;

  /// Adds --material, --radius, --spacing, --lead-in, --step, --offset, --tilt and --log-step.
  void add_to(CLI::App& app);
};

/// Drills, and writes report.html, drilled.vdb, drilled.stl and log.csv into a folder: all of them or none. `ct` is for
/// the report's slices and may be null. Prints the figures and gives them as JSON.
Json run_drill(const std::string& title, const CtVolume* ct, const BoneModel& bone, const DrillPath& path,
               const DrillOptions& options, const std::filesystem::path& folder, const Progress& progress);

}  // namespace spinaltap
