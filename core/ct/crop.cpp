#include "core/ct/crop.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

GridGeometry block_geometry(const GridGeometry& geometry, const VoxelBlock& block) {
  GridGeometry cropped = geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (block.first[axis] < 0 || block.last[axis] < block.first[axis] || block.last[axis] >= geometry.size[axis]) {
      fail("expected a block within the ", geometry.size[axis], " voxels of axis ", axis, ", found ", block.first[axis],
           " to ", block.last[axis]);
    }
    cropped.size[axis] = block.last[axis] - block.first[axis] + 1;
  }
  cropped.origin_mm = geometry.to_patient(Vec3(block.first[0], block.first[1], block.first[2]));
  return cropped;
}

template <class Value>
std::vector<Value> copy_block(const GridGeometry& geometry, const std::vector<Value>& values, const VoxelBlock& block) {
  std::vector<Value> copied;
  for (int k = block.first[2]; k <= block.last[2]; ++k) {
    for (int j = block.first[1]; j <= block.last[1]; ++j) {
      const auto row = values.begin() + static_cast<std::ptrdiff_t>(geometry.offset(block.first[0], j, k));
      copied.insert(copied.end(), row, row + (block.last[0] - block.first[0] + 1));
    }
  }
  return copied;
}

}  // namespace

VoxelBlock block_in_box(const GridGeometry& geometry, const Box3& box_mm) {
  check_geometry(geometry, "CT");
  if (!box_mm.min().allFinite() || !box_mm.max().allFinite() || !(box_mm.sizes().minCoeff() > 0.0)) {
    fail("crop: expected a box with its lower corner first, found (", box_mm.min().transpose(), ") to (",
         box_mm.max().transpose(), ") mm");
  }
  Box3 index;  // of the box's corners
  for (int n = 0; n < 8; ++n) index.extend(geometry.to_index(box_mm.corner(static_cast<Box3::CornerType>(n))));
  constexpr double kOnBorder = 1e-6;
  VoxelBlock block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<Eigen::Index>(axis);
    const double last = geometry.size[axis] - 1;
    const double low = std::max(0.0, std::ceil(index.min()[n] - kOnBorder));
    const double high = std::min(last, std::floor(index.max()[n] + kOnBorder));
    if (!(low <= high)) {
      fail("crop: expected a box that overlaps the CT, which reaches from (", geometry.origin_mm.transpose(), ") to (",
           geometry.to_patient(Vec3(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1)).transpose(),
           ") mm, found (", box_mm.min().transpose(), ") to (", box_mm.max().transpose(), ") mm");
    }
    block.first[axis] = static_cast<int>(low);
    block.last[axis] = static_cast<int>(high);
  }
  return block;
}

VoxelBlock block_around(const BoneMask& mask, double margin_mm) {
  const GridGeometry& geometry = mask.geometry;
  if (!(margin_mm >= 0.0) || !std::isfinite(margin_mm)) {
    fail("crop: expected a margin of 0 mm or more, found ", margin_mm);
  }
  VoxelBlock block{geometry.size, {-1, -1, -1}};
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        if (!mask.at(i, j, k)) continue;
        const std::array<int, 3> voxel{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          block.first[axis] = std::min(block.first[axis], voxel[axis]);
          block.last[axis] = std::max(block.last[axis], voxel[axis]);
        }
      }
    }
  }
  if (block.last[0] < 0) fail("crop: expected a mask with voxels, found an empty one");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double voxels = std::ceil(margin_mm / geometry.spacing_mm[static_cast<Eigen::Index>(axis)] - 1e-6);
    block.first[axis] = static_cast<int>(std::max(0.0, block.first[axis] - voxels));
    block.last[axis] = static_cast<int>(std::min(geometry.size[axis] - 1.0, block.last[axis] + voxels));
  }
  return block;
}

CtVolume crop(const CtVolume& ct, const VoxelBlock& block) {
  const GridGeometry geometry = block_geometry(ct.geometry, block);  // checks the block, so it comes first
  CtVolume cropped = make_ct_volume(geometry, copy_block(ct.geometry, ct.hu, block));
  cropped.warnings = ct.warnings;
  cropped.whole_hash = ct.whole_hash;  // a part of the same CT
  cropped.notes = ct.notes;
  cropped.hu_change = ct.hu_change;
  cropped.choices = ct.choices;
  cropped.frame_hash = ct.frame_hash;
  cropped.slice_thickness_mm = ct.slice_thickness_mm;
  return cropped;
}

BoneMask crop(const BoneMask& mask, const VoxelBlock& block) {
  const GridGeometry geometry = block_geometry(mask.geometry, block);
  return {geometry, copy_block(mask.geometry, mask.inside, block)};
}

}  // namespace spinaltap
