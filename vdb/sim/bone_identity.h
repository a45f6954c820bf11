#pragma once

#include "core/ct/bone_identity.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A bone's metadata: CtVolume::source_hash and whole_hash of the CT that it was baked from.
inline constexpr const char* kSourceHash = "source_hash";
inline constexpr const char* kWholeCtHash = "whole_ct_hash";

/// Which vertebra of which CT a bone is: the same at any voxel size, cropped or not, drilled or not. A bone that was
/// made without a CT has for its CT's hash "bone-" and the fingerprint of its own grids before they were drilled.
BoneIdentity identity_of(const BoneModel& bone);

/// Throws Error where a path names another bone; see check_same_bone().
void check_path_is_of(const DrillPath& path, const BoneIdentity& bone, const std::string& remedy = "");

}  // namespace spinaltap
