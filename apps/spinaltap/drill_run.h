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
  std::filesystem::path density;   ///< empty: the shipped law
  std::filesystem::path material;  ///< the same
  std::filesystem::path field;     ///< a radial basis function that decides which points are bone; empty: the grid
  bool writes_points = false;
  DrillingOptions drilling;

  /// Adds the laws', the point volume's, the engine's and the motion's.
  void add_to(CLI::App& app);
};

/// Drills, and writes report.html, drilled.vdb, drilled.stl, log.csv and, where asked, the living points as points.vdb
/// into a folder: all of them or none. `ct` is for
/// the report's slices and may be null. Prints the figures and gives them as JSON.
Json run_drill(const std::string& title, const CtVolume* ct, const BoneModel& bone, const DrillPath& path,
               const DrillOptions& options, const std::filesystem::path& folder, const Progress& progress);

}  // namespace spinaltap
