#include "vdb/engine/voxel_map.h"

#include "core/base/error.h"
#include "vdb/engine/detail/voxel_leaves.h"

namespace spinaltap {

LabelVolume voxel_map(const VoxelBone& bone) {
  openvdb::CoordBBox box;
  if (!bone.leaves().tree.evalActiveVoxelBoundingBox(box)) fail("voxels: expected occupied ones to map, found none");
  constexpr double kMaxVoxels = 0x1.0p31;
  const openvdb::Coord size = box.dim();
  if (!(1.0 * size.x() * size.y() * size.z() <= kMaxVoxels)) {
    fail("voxels: expected a box of at most 2^31 to map, found ", size.x(), " x ", size.y(), " x ", size.z(),
         ": take a region or larger voxels");
  }
  LabelVolume map;
  map.geometry.size = {size.x(), size.y(), size.z()};
  map.geometry.origin_mm = bone.centre_mm({box.min().x(), box.min().y(), box.min().z()});
  map.geometry.spacing_mm = Vec3::Constant(bone.voxel_mm());
  map.labels.resize(map.geometry.voxel_count());
  map.names[1] = {"occupied bone", Level::kNone};
  for (auto leaf = bone.leaves().tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord() - box.min();
      map.labels[map.geometry.offset(at.x(), at.y(), at.z())] = 1;
    }
  }
  return map;
}

}  // namespace spinaltap
