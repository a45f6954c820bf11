#pragma once

#include <optional>

#include "core/anatomy/bone_shape.h"
#include "core/uncertainty/ct_surface_error.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Metadata of a bone that was baked from a CT: the CT's noise, HU (ct_noise_hu()), its voxels' steps, its grid's axes,
/// and its slices' thickness where its header says one.
constexpr const char* kCtNoise = "ct_noise_hu";
constexpr const char* kCtSpacing = "ct_spacing_mm";
constexpr const char* kCtDirections = "ct_directions";
constexpr const char* kCtSliceThickness = "ct_slice_thickness_mm";

/// From these and the slopes of the baked CT numbers at the bone's surface; nothing where they are missing, or the CT
/// numbers do not fall at the surface.
std::optional<CtSurfaceError> bone_surface_error(const BoneModel& bone, const BoneShape& shape);

}  // namespace spinaltap
