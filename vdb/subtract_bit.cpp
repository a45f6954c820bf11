#include "vdb/subtract_bit.h"

#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetRebuild.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/error.h"
#include "core/drill/bit_profile.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;

/// max(bone, cut) in every leaf that meets `box` (index space). `cut_mm(p)` is the distance of the kept half space or
/// of the outside of a tool: negative where bone may stay.
template <class Cut>
BoneModel intersect(const BoneModel& bone, const CoordBBox& box, const Cut& cut_mm) {
  const FloatGrid::Ptr grid = bone.grids().sdf->deepCopy();
  const float band = grid->background();
  const openvdb::math::Transform& transform = grid->transform();
  // The inside is stored as tiles; those near the cut become leaves, so that the new surface has voxels.
  const double reach_mm = static_cast<double>(band) + 16.0 * grid->voxelSize()[0];
  std::vector<Coord> leaf_origins;
  for (int k = box.min().z() & ~7; k <= box.max().z(); k += 8) {
    for (int j = box.min().y() & ~7; j <= box.max().y(); j += 8) {
      for (int i = box.min().x() & ~7; i <= box.max().x(); i += 8) {
        const Coord origin(i, j, k);
        const Vec3 centre_mm = detail::from_vdb(transform.indexToWorld(origin.asVec3d() + openvdb::Vec3d(3.5)));
        if (cut_mm(centre_mm) < -reach_mm) continue;
        const bool inside_or_band =
            grid->tree().probeConstLeaf(origin) != nullptr || grid->tree().getValue(origin) < 0.0F;
        if (inside_or_band) leaf_origins.push_back(origin);
      }
    }
  }
  std::vector<FloatGrid::TreeType::LeafNodeType*> leaves;
  leaves.reserve(leaf_origins.size());
  for (const Coord& origin : leaf_origins) leaves.push_back(grid->tree().touchLeaf(origin));
  tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t index) {
    auto& leaf = *leaves[index];
    for (openvdb::Index offset = 0; offset < FloatGrid::TreeType::LeafNodeType::SIZE; ++offset) {
      const Vec3 p_mm = detail::from_vdb(transform.indexToWorld(leaf.offsetToGlobalCoord(offset)));
      const float cut = static_cast<float>(cut_mm(p_mm));
      const float value = std::clamp(std::max(leaf.getValue(offset), cut), -band, band);
      if (std::abs(value) < band) {
        leaf.setValueOn(offset, value);
      } else {
        leaf.setValueOff(offset, value);
      }
    }
  });
  openvdb::tools::pruneLevelSet(grid->tree());
  auto grids = std::make_shared<detail::BoneGrids>(bone.grids());
  grids->sdf = grid;
  return BoneModel(grids);
}

CoordBBox index_box(const BoneModel& bone, const Box3& box_mm) {
  const auto& transform = bone.grids().sdf->transform();
  return {Coord::floor(transform.worldToIndex(detail::to_vdb(box_mm.min()))),
          Coord::ceil(transform.worldToIndex(detail::to_vdb(box_mm.max())))};
}

Box3 grown(const Box3& box, double margin_mm) {
  return {box.min() - Vec3::Constant(margin_mm), box.max() + Vec3::Constant(margin_mm)};
}

}  // namespace

BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, const Pose& start, const Pose& end) {
  check_bit(bit);
  if (!(std::abs(end.axis.norm() - 1.0) < 1e-6)) fail("subtracting the bit: expected an axis of length 1");
  const double way_mm = (end.tip_mm - start.tip_mm).dot(end.axis);
  if (!((start.axis - end.axis).norm() < 1e-9) || !((start.tip_mm + way_mm * end.axis - end.tip_mm).norm() < 1e-6)) {
    fail("subtracting the bit: expected a move along the bit's own axis");
  }
  const BitProfile swept = BitProfile(bit).lengthened(std::abs(way_mm));
  const Pose foremost = way_mm >= 0.0 ? end : start;
  Box3 box_mm(foremost.tip_mm);
  box_mm.extend(foremost.tip_mm - swept.length_mm() * foremost.axis);
  const double margin_mm = bit.radius_mm() + 2.0 * bone.band_mm();
  const Box3 reach_mm = grown(box_mm, margin_mm).intersection(grown(bone.bounds_mm(), 0.0));
  if (reach_mm.isEmpty()) return bone;
  return intersect(bone, index_box(bone, reach_mm),
                   [&](const Vec3& p_mm) { return -bit_distance_mm(swept, foremost, p_mm); });
}

BoneModel cut_by_plane(const BoneModel& bone, const Vec3& point_mm, const Vec3& normal) {
  if (!(normal.norm() > 0.0) || !point_mm.allFinite()) fail("cutting: expected a point, and a normal that is not zero");
  const Vec3 unit = normal.normalized();
  return intersect(bone, index_box(bone, bone.bounds_mm()),
                   [&](const Vec3& p_mm) { return (p_mm - point_mm).dot(unit); });
}

}  // namespace spinaltap
