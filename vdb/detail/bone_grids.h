#pragma once

#include <openvdb/math/Half.h>
#include <openvdb/openvdb.h>

#include <map>
#include <string>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// The grids of a BoneModel.
struct BoneGrids {
  openvdb::FloatGrid::ConstPtr sdf;  ///< a level set: mm, negative inside
  openvdb::FloatGrid::ConstPtr hu;
  /// Of a drilled bone, both or none: `sdf` as it was before, and a level set of what bits swept, kept near the bone.
  /// The larger of the first and minus the second is `sdf`, which no longer knows where the rim between them was.
  openvdb::FloatGrid::ConstPtr before;
  openvdb::FloatGrid::ConstPtr hole;
  std::map<std::string, std::string> metadata;
};

/// The nearest number that a half float has.
inline float rounded_to_half(float value) { return static_cast<float>(openvdb::math::half(value)); }

inline openvdb::Vec3d to_vdb(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
inline Vec3 from_vdb(const openvdb::Vec3d& p) { return {p.x(), p.y(), p.z()}; }

/// Box around the active voxels' centres, patient LPS, mm.
Box3 active_box_mm(const openvdb::FloatGrid& grid);

}  // namespace spinaltap::detail
