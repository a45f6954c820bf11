#include "vdb/connected_parts.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <algorithm>
#include <array>

#include "core/base/error.h"
#include "core/segment/distance_transform.h"
#include "vdb/initialize.h"

namespace spinaltap {
namespace {

struct Parts {
  std::vector<openvdb::BoolTree::Ptr> trees;
  /// Offsets of voxels without a neighbour. Noise makes thousands, and each would be a tree of a quarter megabyte.
  std::vector<std::size_t> single;
};

bool has_neighbour(std::span<const std::uint8_t> inside, const GridGeometry& geometry, int i, int j, int k) {
  const std::array<int, 3> index{i, j, k};
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  const std::size_t here = geometry.offset(i, j, k);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (index[axis] > 0 && inside[here - stride[axis]] != 0) return true;
    if (index[axis] + 1 < geometry.size[axis] && inside[here + stride[axis]] != 0) return true;
  }
  return false;
}

Parts parts_of(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  if (inside.size() != geometry.voxel_count()) {
    fail("connected parts: expected ", geometry.voxel_count(), " voxels, found ", inside.size());
  }
  initialize_openvdb();
  Parts parts;
  openvdb::MaskTree tree;
  openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor(tree);
  std::size_t voxel = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i, ++voxel) {
        if (inside[voxel] == 0) continue;
        if (has_neighbour(inside, geometry, i, j, k)) {
          accessor.setValueOn(openvdb::Coord(i, j, k));
        } else {
          parts.single.push_back(voxel);
        }
      }
    }
  }
  openvdb::tools::extractActiveVoxelSegmentMasks(tree, parts.trees);
  return parts;
}

/// Calls `visit(offset)` for the voxels of a part while it returns true.
template <class Visit>
void for_voxels(const openvdb::BoolTree& part, const GridGeometry& geometry, const Visit& visit) {
  for (auto value = part.cbeginValueOn(); value; ++value) {
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    for (int k = box.min().z(); k <= box.max().z(); ++k) {
      for (int j = box.min().y(); j <= box.max().y(); ++j) {
        for (int i = box.min().x(); i <= box.max().x(); ++i) {
          if (!visit(geometry.offset(i, j, k))) return;
        }
      }
    }
  }
}

std::vector<std::uint8_t> border_of(const GridGeometry& geometry) {
  std::vector<std::uint8_t> border(geometry.voxel_count(), 0);
  const auto& size = geometry.size;
  const auto at_end = [](int index, int length) { return index == 0 || index == length - 1; };
  std::size_t voxel = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++voxel) {
        if (at_end(i, size[0]) || at_end(j, size[1]) || at_end(k, size[2])) border[voxel] = 1;
      }
    }
  }
  return border;
}

}  // namespace

std::vector<std::uint8_t> parts_that_touch(std::span<const std::uint8_t> inside, std::span<const std::uint8_t> touched,
                                           const GridGeometry& geometry) {
  if (touched.size() != inside.size()) {
    fail("connected parts: expected two masks of one size, found ", inside.size(), " and ", touched.size(), " voxels");
  }
  std::vector<std::uint8_t> result(inside.size(), 0);
  const Parts parts = parts_of(inside, geometry);
  for (const std::size_t voxel : parts.single) result[voxel] = touched[voxel] != 0 ? 1 : 0;
  for (const openvdb::BoolTree::Ptr& part : parts.trees) {
    bool touches = false;
    for_voxels(*part, geometry, [&](std::size_t voxel) { return !(touches = touched[voxel] != 0); });
    if (!touches) continue;
    for_voxels(*part, geometry, [&](std::size_t voxel) {
      result[voxel] = 1;
      return true;
    });
  }
  return result;
}

std::vector<std::size_t> part_sizes(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  const Parts parts = parts_of(inside, geometry);
  std::vector<std::size_t> sizes(parts.single.size(), 1);
  for (const openvdb::BoolTree::Ptr& part : parts.trees) sizes.push_back(part->activeVoxelCount());
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

std::vector<std::uint8_t> fill_hollows(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                       double seal_mm) {
  if (!(seal_mm >= 0.0 && seal_mm <= 50.0)) fail("fill: expected gaps of 0 to 50 mm to seal, found ", seal_mm, " mm");
  const auto limit = static_cast<float>(seal_mm * seal_mm);
  std::vector<std::uint8_t> filled(inside.begin(), inside.end());
  std::vector<std::uint8_t> roomy(inside.size());
  const auto is_far = [&](float squared_mm2) { return static_cast<std::uint8_t>(squared_mm2 > limit ? 1 : 0); };
  {
    const std::vector<float> to_bone = squared_distance_to(inside, geometry);
    std::transform(to_bone.begin(), to_bone.end(), roomy.begin(), is_far);
  }
  const std::vector<std::uint8_t> reached = parts_that_touch(roomy, border_of(geometry), geometry);
  const std::vector<float> to_reached = squared_distance_to(reached, geometry);
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (is_far(to_reached[i]) != 0) filled[i] = 1;
  }
  return filled;
}

}  // namespace spinaltap
