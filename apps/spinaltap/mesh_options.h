#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>

#include "core/base/triangle_mesh.h"
#include "core/ct/level.h"

namespace spinaltap {

/// What a user says of surface files, which do not say it themselves.
struct MeshCommandOptions {
  std::string units;  ///< "mm", "cm", "in" or "m"; empty: mm, checked
  std::string axes;   ///< "RAS"; empty: LPS, checked

  void add_to(CLI::App& app);
  /// A vertebra's surface in patient LPS, mm; prints warnings. Throws Error where read_vertebra_mesh() does.
  TriangleMesh read(const std::filesystem::path& path, Level level = Level::kNone) const;
};

}  // namespace spinaltap
