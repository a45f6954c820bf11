#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/registration/rigid_pose.h"

namespace spinaltap {

/// Which way the axes of a file's numbers go, where the file does not say.
enum class MeasuredFrame : std::uint8_t { lps, ras };

/// A point that was marked or measured.
struct MeasuredPoint {
  std::string label;  ///< empty: none
  Vec3 p_mm = Vec3::Zero();
};

/// Points of 3D Slicer's markups (.mrk.json: all points of its lists; .fcsv), which say their frame, or of a CSV file
/// (x, y, z in mm; with a header x_mm,y_mm,z_mm and maybe label, or without), which is taken to be of `frame`. Always
/// given as LPS, mm. Points that are not placed are left out. Throws Error that names the file and the line or key at
/// fault, and where there is no point, or over a million.
std::vector<MeasuredPoint> read_measured_points(const std::filesystem::path& file,
                                                MeasuredFrame frame = MeasuredFrame::lps);

/// Poses of a tracked tool, a line each: x_mm,y_mm,z_mm,qw,qx,qy,qz; or the 12 numbers of a 3 by 4 matrix row by row,
/// or the 16 of a 4 by 4 one. A first line that holds no numbers is a header. Throws Error as above, and on what is no
/// rotation.
std::vector<RigidPose> read_tool_poses(const std::filesystem::path& file);

/// Pairs of two lists: by label where every point of both has one of its own, else in their order. Throws Error where a
/// label has no partner, and on lists of different lengths.
struct PairedPoints {
  std::vector<Vec3> first_mm, second_mm;
};
PairedPoints pair_points(const std::vector<MeasuredPoint>& first, const std::vector<MeasuredPoint>& second);

}  // namespace spinaltap
