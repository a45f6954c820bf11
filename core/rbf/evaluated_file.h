#pragma once

#include <filesystem>
#include <span>

#include "core/base/geometry.h"

namespace spinaltap {

/// A field's values at points.
struct EvaluatedPoints {
  std::span<const Vec3> points_mm;    ///< patient LPS
  std::span<const double> values_mm;  ///< one a point
  std::span<const Vec3> gradients;    ///< empty, or one a point
};

/// Throws Error unless the name ends in .csv or .ply.
void check_evaluated_name(const std::filesystem::path& path);

/// Writes points with their values, by the name's ending, piece by piece:
/// - .csv: x, y, z, value and, with gradients, gx, gy, gz; each number with as many digits as give it back exactly.
/// - .ply: binary little endian; double x, y, z, value and, with gradients, nx, ny, nz: the gradient as it is, under
/// the
///   names that viewers take for normals. All double, so that the file holds the same numbers as the other.
/// `path` is a staged (temporary) name. Throws Error on another ending, when sizes do not fit and when the disk is
/// full.
void write_evaluated(const EvaluatedPoints& points, const std::filesystem::path& path);

}  // namespace spinaltap
