#pragma once

#include <filesystem>
#include <vector>

#include "core/segment/segment_spine.h"

namespace spinaltap {

/// Corrections as someone paints them: a label map, small or as large as the CT, whose labels are named by levels. What
/// lies under a label with another name ("exclude", or none) belongs to no vertebra. Gives points at voxels' centres,
/// none nearer than 1.5 mm to another of its label. Throws Error as read_label_volume() does.
std::vector<Correction> read_strokes(const std::filesystem::path& file, const GridGeometry& ct_geometry);

}  // namespace spinaltap
