#pragma once

#include <optional>

#include "core/plan/bone_shape.h"
#include "core/plan/ct_surface_error.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Metadata of a bone that was baked from a CT: the CT's noise, HU (estimate_noise_hu()), and its voxels' steps.
constexpr const char* kCtNoise = "ct_noise_hu";
constexpr const char* kCtSpacing = "ct_spacing_mm";

/// From these and the slopes of the baked CT numbers at the bone's surface; nothing where they are missing, or the CT
/// numbers do not fall at the surface.
std::optional<CtSurfaceError> bone_surface_error(const BoneModel& bone, const BoneShape& shape);

}  // namespace spinaltap
