#include "vdb/subtract_bit.h"

#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetRebuild.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/drill/bit_profile.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;

/// max(bone, cut) in every leaf that meets `box` (index space). `cut.at(p)` is the distance of the kept half space or
/// of the outside of a tool, mm: negative where bone may stay. `cut.near(p, reach_mm)` is the same cut for places
/// within `reach_mm` of p alone, which may be cheaper.
template <class Cut>
BoneModel intersect(const BoneModel& bone, const CoordBBox& box, const Cut& cut) {
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
        if (cut.at(centre_mm) < -reach_mm) continue;
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
    const Vec3 centre_mm = detail::from_vdb(transform.indexToWorld(leaf.origin().asVec3d() + openvdb::Vec3d(3.5)));
    const Cut near = cut.near(centre_mm, 3.5 * std::sqrt(3.0) * grid->voxelSize()[0]);
    for (openvdb::Index offset = 0; offset < FloatGrid::TreeType::LeafNodeType::SIZE; ++offset) {
      const Vec3 p_mm = detail::from_vdb(transform.indexToWorld(leaf.offsetToGlobalCoord(offset)));
      const float value = std::clamp(std::max(leaf.getValue(offset), static_cast<float>(near.at(p_mm))), -band, band);
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

/// A bit at a pose, lengthened backwards by its way.
struct SweptAlong {
  BitProfile profile;
  Pose pose;

  SweptAlong(const DrillBit& bit, const Pose& start, const Pose& end) : profile(bit), pose(end) {
    if (!(std::abs(end.axis.norm() - 1.0) < 1e-6)) fail("subtracting the bit: expected an axis of length 1");
    const double way_mm = (end.tip_mm - start.tip_mm).dot(end.axis);
    if (!((start.axis - end.axis).norm() < 1e-9) || !((start.tip_mm + way_mm * end.axis - end.tip_mm).norm() < 1e-6)) {
      fail("subtracting the bit: expected a move along the bit's own axis");
    }
    profile = profile.lengthened(std::abs(way_mm));
    if (way_mm < 0.0) pose = start;
  }
  double distance_mm(const Vec3& p_mm) const { return bit_distance_mm(profile, pose, p_mm); }
};

/// What lies outside all of some bits.
class OutsideBits {
 public:
  explicit OutsideBits(std::vector<const SweptAlong*> bits) : bits_(std::move(bits)) {}

  double at(const Vec3& p_mm) const {
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (const SweptAlong* bit : bits_) nearest_mm = std::min(nearest_mm, bit->distance_mm(p_mm));
    return -nearest_mm;
  }
  /// A distance changes by no more than the way: bits further than the nearest by twice the reach are never nearest.
  OutsideBits near(const Vec3& p_mm, double reach_mm) const {
    const double nearest_mm = -at(p_mm);
    std::vector<const SweptAlong*> kept;
    for (const SweptAlong* bit : bits_) {
      if (bit->distance_mm(p_mm) <= nearest_mm + 2.0 * reach_mm) kept.push_back(bit);
    }
    return OutsideBits(std::move(kept));
  }

 private:
  std::vector<const SweptAlong*> bits_;
};

/// What lies on the side of a plane that its normal points away from.
struct BehindPlane {
  Vec3 point_mm;
  Vec3 normal;

  double at(const Vec3& p_mm) const { return (p_mm - point_mm).dot(normal); }
  BehindPlane near(const Vec3& /*p_mm*/, double /*reach_mm*/) const { return *this; }
};

}  // namespace

BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, std::span<const BitWay> ways) {
  check_bit(bit);
  std::vector<SweptAlong> swept;
  std::vector<const SweptAlong*> reaching;
  swept.reserve(ways.size());
  Box3 box_mm;
  const Box3 bone_mm = bone.bounds_mm();
  const double margin_mm = bit.radius_mm() + 2.0 * bone.band_mm();
  for (const BitWay& way : ways) {
    const SweptAlong& bit_way = swept.emplace_back(bit, way.start, way.end);
    Box3 around_mm(bit_way.pose.tip_mm);
    around_mm.extend(bit_way.pose.tip_mm - bit_way.profile.length_mm() * bit_way.pose.axis);
    around_mm = grown(around_mm, margin_mm).intersection(bone_mm);
    if (around_mm.isEmpty()) continue;
    box_mm.extend(around_mm);
    reaching.push_back(&bit_way);
  }
  if (reaching.empty()) return bone;
  return intersect(bone, index_box(bone, box_mm), OutsideBits(std::move(reaching)));
}

BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, const Pose& start, const Pose& end) {
  const BitWay way{start, end};
  return subtract_bit(bone, bit, {&way, 1});
}

BoneModel cut_by_plane(const BoneModel& bone, const Vec3& point_mm, const Vec3& normal) {
  if (!(normal.norm() > 0.0) || !point_mm.allFinite()) fail("cutting: expected a point, and a normal that is not zero");
  return intersect(bone, index_box(bone, bone.bounds_mm()), BehindPlane{point_mm, normal.normalized()});
}

}  // namespace spinaltap
