#pragma once

#include <filesystem>
#include <vector>

#include "core/session/operator/tool_source.h"

namespace spinaltap {

struct PoseCsvOptions {
  bool lets_bad_poses_pass = false;  ///< poses that are not numbers, or have no direction: for sessions to refuse
};

/// Poses of a tool from a CSV file with the columns time_s, x_mm, y_mm, z_mm (the tip, patient LPS), axis_x, axis_y,
/// axis_z (from the base to the tip; brought to length 1) and, where it has one, spindle_on (0 or 1), in any order;
/// others are passed over. Times rise. Throws Error that names the file and the line.
std::vector<ToolInput> read_pose_csv(const std::filesystem::path& path, const PoseCsvOptions& options = {});

}  // namespace spinaltap
