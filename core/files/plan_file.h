#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/tool/drill_path.h"

namespace spinaltap {

/// Writes planned paths as JSON: patient LPS, mm; see docs/plan-file.md. A name that ends in ".mrk.json" makes them
/// 3D Slicer's markups.
void write_plan(const std::vector<DrillPath>& paths, const std::filesystem::path& path);

/// Reads what write_plan wrote, or lines from 3D Slicer's markups. Throws Error that names the file and the key at
/// fault.
std::vector<DrillPath> read_plan(const std::filesystem::path& path);

/// The same as text: all of a plan file but its name, which `file` is in complaints.
std::string plan_text(const std::vector<DrillPath>& paths);
std::vector<DrillPath> paths_of_text(const std::string& text, const std::filesystem::path& file);

/// The path called `name`, or the first when `name` is empty. Throws Error that lists the names.
const DrillPath& choose_path(const std::vector<DrillPath>& paths, const std::string& name);

}  // namespace spinaltap
