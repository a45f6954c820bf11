#pragma once

#include "core/segment/float_grid.h"

namespace spinaltap {

/// The voxels of a CT that a box (patient LPS, mm) touches, within the CT; empty when there are none.
VoxelBox voxels_of(const Box3& box_mm, const GridGeometry& geometry);

/// How many voxels along each axis make one of about `step_mm`; at least 1.
std::array<int, 3> bins_for(const GridGeometry& geometry, double step_mm);

/// Where a box of voxels lies when each block of `bins` of them, from the box's first on, becomes one.
GridGeometry binned_geometry(const GridGeometry& fine, const VoxelBox& box, const std::array<int, 3>& bins);

/// The CT's numbers within a box of voxels, the mean of each block of `bins` voxels; blocks at the box's far end may
/// hold fewer. Throws Error on an empty box, or one beyond the CT.
FloatGrid bin_hu(const CtVolume& ct, const VoxelBox& box, const std::array<int, 3>& bins);

}  // namespace spinaltap
