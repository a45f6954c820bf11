#pragma once

#include <optional>

#include "core/base/geometry.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Where a ray (patient LPS, mm; unit direction) from outside first meets the bone's surface; nothing where it misses.
std::optional<Vec3> first_surface_mm(const BoneModel& bone, const Vec3& start_mm, const Vec3& direction);

}  // namespace spinaltap
