#pragma once

#include "core/base/triangle_mesh.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A bone's surface without what lies in the cylinder of a path's point volume, to draw around the points: cut exactly
/// along it, with its edge on the cylinder and no walls within. The cylinder has `radius_mm` and goes from
/// `lead_in_mm` before the entry to the target. Outward, open at the cut, in triangles of about the voxels' size.
/// Throws Error on a bad path, a radius that is not above 0 or a lead-in below 0.
TriangleMesh cut_out_cylinder(const BoneModel& bone, const DrillPath& path, double radius_mm, double lead_in_mm);

}  // namespace spinaltap
