#pragma once

#include <filesystem>
#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/fit_rbf.h"

namespace spinaltap {

/// Reads points with values, and error bars where there are any (all mm, patient LPS), by the name's ending:
/// - .csv, .csv.gz: columns x, y, z, value and perhaps error_bar. With a header line they may stand in any order, and
///   others are left out; without one there are 4 or 5 columns in that order.
/// - .ply: ascii or binary of either byte order, with those vertex properties; others, and other elements, are left
/// out. Takes no more memory than the arrays, whatever a head says. Throws Error, with file and line or vertex (counted
/// from 1), on anything else, on numbers that are not finite, error bars below 0, and when there is no point.
RbfValues read_values(const std::filesystem::path& path);

/// Reads the points of such a file, or of one with x, y and z only. Without a header line they are the first three
/// columns.
std::vector<Vec3> read_positions(const std::filesystem::path& path);

}  // namespace spinaltap
