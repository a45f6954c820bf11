#pragma once

#include <optional>
#include <vector>

#include "apps/report/slice_frame.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// A convex polygon in the pixels of a picture (column, row), its corners in one turning sense, the first not repeated.
using PixelPolygon = std::vector<Eigen::Vector2d>;

/// A convex part of a tool: a body of revolution around its axis, or a plate.
struct ToolPart {
  std::vector<Eigen::Vector2d> outline = {};  ///< (back from the tip, off the axis), mm, from the tip on
  std::optional<DrillBit> plate = {};         ///< then without an outline
};

/// The convex parts of a bit: of a drill and of a plate all is one.
std::vector<ToolPart> tool_parts(const DrillBit& bit);

/// The outline of a part at `pose` (patient LPS, mm; of a plate a sound one, see valid_pose()) projected at right
/// angles onto the picture's plane.
PixelPolygon part_projection(const SliceFrame& frame, const ToolPart& part, const Pose& pose);

/// Where the picture's plane cuts the part at `pose`: an ellipse across a shaft, a conic across a tip, the full outline
/// where the plane holds the axis; empty where it misses. Corners lie on the part's surface to rounding; between them
/// the polygon stays within 0.06% of the radius inside it.
PixelPolygon part_section(const SliceFrame& frame, const ToolPart& part, const Pose& pose);

/// The projection of each convex part of a bit.
std::vector<PixelPolygon> bit_projection(const SliceFrame& frame, const DrillBit& bit, const Pose& pose);

/// The sections of a bit's parts, without those that the plane misses.
std::vector<PixelPolygon> bit_section(const SliceFrame& frame, const DrillBit& bit, const Pose& pose);

}  // namespace spinaltap
