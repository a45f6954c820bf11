#pragma once

#include <filesystem>
#include <vector>

#include "core/files/json_file.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Paths as 3D Slicer's markups (its markups schema 1.0.3): one line each, from "entry" to "target", or an open curve
/// through its control points where the path is curved, in LPS mm. Bit and screw stand beside them under a key of ours,
/// which Slicer ignores and loses when it saves.
Json markups_of(const std::vector<DrillPath>& paths);

/// Paths from the lines and open curves of a 3D Slicer markups file, whose points may be LPS or RAS, in mm or µm. The
/// first point is the entry, the last the target, unless their labels say "entry" and "target". Lines without a bit of
/// ours get `bit`, curves steerable_head(). Other kinds of markups are left out. Throws Error, which names the file,
/// where there is no line, and on lines that are not finished.
std::vector<DrillPath> paths_of_markups(const Json& json, const std::filesystem::path& file, const DrillBit& bit = {});

/// Whether a JSON file's content is 3D Slicer's markups.
bool is_markups(const Json& json);

namespace detail {

/// How the numbers of one markup become patient LPS, mm: it may say RAS, and µm. Throws Error where it says otherwise.
Vec3 scale_to_lps_mm(const JsonObject& markup, const std::filesystem::path& file);

}  // namespace detail

}  // namespace spinaltap
