#pragma once

#include <vector>

#include "apps/report/slice_frame.h"

namespace spinaltap {

/// A convex polygon in the pixels of a picture (column, row), its corners in one turning sense, the first not repeated.
using PixelPolygon = std::vector<Eigen::Vector2d>;

/// The outline of the bit at `pose` (patient LPS, mm) projected at right angles onto the picture's plane: of each
/// convex part of it, which for a drill is all.
std::vector<PixelPolygon> bit_projection(const SliceFrame& frame, const DrillBit& bit, const Pose& pose);

/// Where the picture's plane cuts the bit at `pose`, part by part: an ellipse across the shaft, a conic across the tip,
/// the bit's full outline where the plane holds its axis. Parts that the plane misses are left out. Corners lie on the
/// bit's surface to rounding; between them the polygon stays within 0.06% of the radius inside it.
std::vector<PixelPolygon> bit_section(const SliceFrame& frame, const DrillBit& bit, const Pose& pose);

}  // namespace spinaltap
