#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <span>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "vdb/bake/bake.h"

namespace spinaltap::detail {

/// Half width of every level set here, in voxels: what OpenVDB's tools expect.
inline constexpr double kHalfWidthVoxels = 3.0;

/// The signed distance grid of a field's zero set; see bake_bone().
openvdb::FloatGrid::Ptr bake_sdf(const ScalarField& field, std::span<const Vec3> seeds_mm, double voxel_mm,
                                 BakeReport& report, const Progress& progress);

/// The CT number of voxel (i, j, k) of a grid; called from many threads at once.
using HuOfVoxel = std::function<float(int i, int j, int k)>;

/// CT numbers of the voxels within the level set and `margin_mm` around it, on a grid of the given geometry, rounded to
/// half floats.
openvdb::FloatGrid::Ptr bake_hu(const openvdb::FloatGrid& sdf, const GridGeometry& geometry, double margin_mm,
                                const HuOfVoxel& hu);

}  // namespace spinaltap::detail
