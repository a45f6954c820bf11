#include "vdb/remaining/subtract_bit.h"

#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/remaining/detail/bit_sweep.h"
#include "vdb/remaining/swept_along.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

using Leaf = openvdb::FloatGrid::TreeType::LeafNodeType;

/// From a leaf's middle to its corners' voxels.
double leaf_reach_mm(const openvdb::FloatGrid& grid) { return 3.5 * std::sqrt(3.0) * grid.voxelSize()[0]; }

Vec3 middle_mm(const openvdb::FloatGrid& grid, const Coord& leaf_origin) {
  return detail::from_vdb(grid.indexToWorld(leaf_origin.asVec3d() + openvdb::Vec3d(3.5)));
}

/// Origins of those leaves within `box` (index space) that hold bone or its band and that `wanted` takes, in order.
template <class Wanted>
std::vector<Coord> leaves_with_bone(const openvdb::FloatGrid& bone, const CoordBBox& box, const Wanted& wanted) {
  std::vector<Coord> origins;
  for (int k = box.min().z() & ~7; k <= box.max().z(); k += 8) {
    for (int j = box.min().y() & ~7; j <= box.max().y(); j += 8) {
      for (int i = box.min().x() & ~7; i <= box.max().x(); i += 8) {
        const Coord origin(i, j, k);
        const bool is_bone = bone.tree().probeConstLeaf(origin) != nullptr || bone.tree().getValue(origin) < 0.0F;
        if (is_bone && wanted(origin)) origins.push_back(origin);
      }
    }
  }
  return origins;
}

/// Changes all values of some leaves, which are made where there are none. `prepare(origin)` gives what makes of a
/// value and its voxel a new value. Those within the band are active.
template <class Prepare>
void change_leaves(openvdb::FloatGrid& grid, const std::vector<Coord>& origins, const Prepare& prepare) {
  const float band = grid.background();
  std::vector<Leaf*> leaves;
  leaves.reserve(origins.size());
  for (const Coord& origin : origins) leaves.push_back(grid.tree().touchLeaf(origin));
  tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t index) {
    Leaf& leaf = *leaves[index];
    const auto change = prepare(leaf.origin());
    for (openvdb::Index offset = 0; offset < Leaf::SIZE; ++offset) {
      const float value = std::clamp(change(leaf.getValue(offset), leaf.offsetToGlobalCoord(offset)), -band, band);
      if (std::abs(value) < band) {
        leaf.setValueOn(offset, value);
      } else {
        leaf.setValueOff(offset, value);
      }
    }
  });
  openvdb::tools::pruneLevelSet(grid.tree());
}

CoordBBox index_box(const BoneModel& bone, const Box3& box_mm) {
  const auto& transform = bone.grids().sdf->transform();
  return {Coord::floor(transform.worldToIndex(detail::to_vdb(box_mm.min()))),
          Coord::ceil(transform.worldToIndex(detail::to_vdb(box_mm.max())))};
}

Box3 grown(const Box3& box, double margin_mm) {
  return {box.min() - Vec3::Constant(margin_mm), box.max() + Vec3::Constant(margin_mm)};
}

/// No place's distances to two swept bits of one shape differ by more, mm.
double max_difference_mm(const BitBody& a, const BitBody& b) {
  const double length_mm = std::max(a.profile().length_mm(), b.profile().length_mm());
  const double longer_mm = std::abs(a.profile().length_mm() - b.profile().length_mm());
  return (a.pose().tip_mm - b.pose().tip_mm).norm() + length_mm * (a.pose().axis - b.pose().axis).norm() +
         2.0 * longer_mm;
}

/// What a bit took on some ways, one after the other. Ways that follow each other lie near each other: of a stretch of
/// them one way tells how near the others can be.
class SweptBits {
 public:
  explicit SweptBits(std::vector<const BitBody*> bits) : bits_(std::move(bits)) { add_stretch(0, bits_.size()); }

  /// To the nearest of them, mm, negative within; `beyond_mm` where none is nearer than that.
  double distance_mm(const Vec3& p_mm, double beyond_mm) const { return nearest_mm(0, p_mm, beyond_mm); }

 private:
  struct Stretch {
    std::size_t middle = 0;               ///< the way that stands for the others
    double spread_mm = 0.0;               ///< how much nearer one of them can be
    std::array<std::size_t, 2> halves{};  ///< 0: the stretch is one way
  };

  std::size_t add_stretch(std::size_t begin, std::size_t end) {
    const std::size_t number = stretches_.size();
    stretches_.emplace_back();
    Stretch stretch{.middle = begin + (end - begin) / 2};
    for (std::size_t n = begin; n < end; ++n) {
      stretch.spread_mm = std::max(stretch.spread_mm, max_difference_mm(*bits_[stretch.middle], *bits_[n]));
    }
    if (end - begin > 1) stretch.halves = {add_stretch(begin, stretch.middle), add_stretch(stretch.middle, end)};
    stretches_[number] = stretch;
    return number;
  }

  double nearest_mm(std::size_t number, const Vec3& p_mm, double nearest) const {
    constexpr double kRoundingMm = 1e-9;
    const Stretch& stretch = stretches_[number];
    const double middle_mm = bits_[stretch.middle]->distance_mm(p_mm);
    nearest = std::min(nearest, middle_mm);
    if (stretch.halves[1] == 0 || middle_mm - stretch.spread_mm > nearest + kRoundingMm) return nearest;
    for (const std::size_t half : stretch.halves) nearest = nearest_mm(half, p_mm, nearest);
    return nearest;
  }

  std::vector<const BitBody*> bits_;
  std::vector<Stretch> stretches_;  ///< the whole first
};

/// The bone's hole, or an empty one.
openvdb::FloatGrid::Ptr hole_of_bone(const detail::BoneGrids& bone) {
  if (bone.hole) return bone.hole->deepCopy();
  const openvdb::FloatGrid& before = *(bone.before ? bone.before : bone.sdf);
  openvdb::FloatGrid::Ptr hole = openvdb::FloatGrid::create(before.background());
  hole->setTransform(before.transform().copy());
  hole->setGridClass(openvdb::GRID_LEVEL_SET);
  hole->setName("hole");
  return hole;
}

/// The bone with a hole that was widened in the leaves that `changed`.
BoneModel with_hole(const BoneModel& bone, const openvdb::FloatGrid::Ptr& hole, const std::vector<Coord>& changed) {
  const auto grids = std::make_shared<detail::BoneGrids>(bone.grids());
  const openvdb::FloatGrid::Ptr sdf = bone.grids().sdf->deepCopy();
  change_leaves(*sdf, changed, [&](const Coord&) {
    return [hole_values = hole->getConstAccessor()](float value, const Coord& voxel) {
      return std::max(value, -hole_values.getValue(voxel));
    };
  });
  grids->before = bone.grids().before ? bone.grids().before : bone.grids().sdf;
  grids->hole = hole;
  grids->sdf = sdf;
  return BoneModel(grids);
}

/// Which sweeps come near a leaf of the bone, by the leaf's origin.
std::map<Coord, std::vector<std::size_t>> sweeps_by_leaf(const openvdb::FloatGrid& before, const BoneModel& bone,
                                                         std::span<const detail::BitSweep> sweeps) {
  std::map<Coord, std::vector<std::size_t>> leaves;
  const Box3 bone_mm = bone.bounds_mm();
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    const Box3 box_mm = sweeps[n].bounds_mm(bone.band_mm()).intersection(bone_mm);
    if (box_mm.isEmpty()) continue;
    for (const Coord& origin : leaves_with_bone(before, index_box(bone, box_mm), [](const Coord&) { return true; })) {
      leaves[origin].push_back(n);
    }
  }
  return leaves;
}

/// Lessens a leaf's distances to the hole by what sweeps took.
class LeafHole {
 public:
  explicit LeafHole(const openvdb::FloatGrid& hole)
      : hole_(hole), band_mm_(static_cast<double>(hole.background())), reach_mm_(leaf_reach_mm(hole)) {}

  std::array<float, Leaf::SIZE> widened(const Coord& origin, std::span<const std::size_t> near,
                                        std::span<const detail::BitSweep> sweeps) const {
    std::array<float, Leaf::SIZE> values;
    std::array<Vec3, Leaf::SIZE> places_mm;
    const auto accessor = hole_.getConstAccessor();
    for (openvdb::Index offset = 0; offset < Leaf::SIZE; ++offset) {
      const Coord voxel = origin + Leaf::offsetToLocalCoord(offset);
      values[offset] = accessor.getValue(voxel);
      places_mm[offset] = detail::from_vdb(hole_.indexToWorld(voxel));
    }
    const Vec3 centre_mm = middle_mm(hole_, origin);
    std::vector<double> changes_mm;
    for (const std::size_t number : near) {
      const detail::BitSweep& sweep = sweeps[number];
      const auto highest_mm = static_cast<double>(*std::max_element(values.begin(), values.end()));
      if (highest_mm <= -band_mm_) break;
      const double change_mm = sweep.changes_from_middle_mm(centre_mm, reach_mm_, band_mm_, changes_mm);
      if (sweep.middle_distance_mm(centre_mm) - reach_mm_ - change_mm >= highest_mm) continue;
      for (std::size_t offset = 0; offset < values.size(); ++offset) {
        const auto before_mm = static_cast<double>(values[offset]);
        if (before_mm <= -band_mm_) continue;
        const double at_middle_mm = sweep.middle_distance_mm(places_mm[offset]);
        if (at_middle_mm - change_mm >= before_mm) continue;
        const double now_mm = sweep.nearest_below(places_mm[offset], before_mm, at_middle_mm, changes_mm).distance_mm;
        values[offset] = std::min(values[offset], static_cast<float>(now_mm));
      }
    }
    return values;
  }

 private:
  const openvdb::FloatGrid& hole_;
  double band_mm_, reach_mm_;
};

/// The hole with what bits took more, near the bone as it was before; leaves that changed go to `changed`.
openvdb::FloatGrid::Ptr widened_hole(const detail::BoneGrids& bone, const CoordBBox& box, const SweptBits& bits,
                                     std::vector<Coord>& changed) {
  const openvdb::FloatGrid& before = *(bone.before ? bone.before : bone.sdf);
  openvdb::FloatGrid::Ptr hole = hole_of_bone(bone);
  const double reach_mm = leaf_reach_mm(before);
  const double band_mm = static_cast<double>(before.background());
  const double wanted_mm = band_mm + reach_mm;
  changed = leaves_with_bone(before, box, [&](const Coord& origin) {
    return bits.distance_mm(middle_mm(before, origin), wanted_mm) < wanted_mm;
  });
  change_leaves(*hole, changed, [&](const Coord&) {
    return [&](float value, const Coord& voxel) {
      const Vec3 p_mm = detail::from_vdb(hole->indexToWorld(voxel));
      return static_cast<float>(bits.distance_mm(p_mm, static_cast<double>(value)));
    };
  });
  return hole;
}

}  // namespace

BitBody swept_along(const DrillBit& bit, const BitWay& way) {
  const Pose& end = way.end;
  if (!(std::abs(end.axis.norm() - 1.0) < 1e-6)) fail("subtracting the bit: expected an axis of length 1");
  const double way_mm = (end.tip_mm - way.start.tip_mm).dot(end.axis);
  if (!((way.start.axis - end.axis).norm() < 1e-9) ||
      !((way.start.tip_mm + way_mm * end.axis - end.tip_mm).norm() < 1e-6)) {
    fail("subtracting the bit: expected a move along the bit's own axis");
  }
  return {BitProfile(bit).lengthened(std::abs(way_mm)), way_mm < 0.0 ? way.start : end};
}

std::vector<BitBody> swept_along(const DrillBit& bit, std::span<const BitWay> ways) {
  std::vector<BitBody> bodies;
  bodies.reserve(ways.size());
  for (const BitWay& way : ways) bodies.push_back(swept_along(bit, way));
  return bodies;
}

BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, std::span<const BitWay> ways) {
  check_bit(bit);
  std::vector<BitBody> swept;
  std::vector<const BitBody*> reaching;
  swept.reserve(ways.size());
  Box3 box_mm;
  const Box3 bone_mm = bone.bounds_mm();
  const double margin_mm = bit.radius_mm() + 2.0 * bone.band_mm();
  for (const BitWay& way : ways) {
    const BitBody& bit_way = swept.emplace_back(swept_along(bit, way));
    Box3 around_mm(bit_way.pose().tip_mm);
    around_mm.extend(bit_way.pose().tip_mm - bit_way.profile().length_mm() * bit_way.pose().axis);
    around_mm = grown(around_mm, margin_mm).intersection(bone_mm);
    if (around_mm.isEmpty()) continue;
    box_mm.extend(around_mm);
    reaching.push_back(&bit_way);
  }
  if (reaching.empty()) return bone;
  std::vector<Coord> changed;
  const openvdb::FloatGrid::Ptr hole =
      widened_hole(bone.grids(), index_box(bone, box_mm), SweptBits(std::move(reaching)), changed);
  return with_hole(bone, hole, changed);
}

BoneModel subtract_motion(const BoneModel& bone, const DrillBit& bit, std::span<const std::vector<Pose>> ways) {
  constexpr double kToleranceVoxels = 0.01, kLongestVoxels = 8.0;
  check_bit(bit);
  const BitProfile profile(bit);
  std::vector<detail::BitSweep> sweeps;
  for (const std::vector<Pose>& way : ways) {
    if (way.empty()) continue;
    std::vector<detail::BitSweep> cut =
        detail::cut_into_sweeps(profile, way, kToleranceVoxels * bone.voxel_mm(), kLongestVoxels * bone.voxel_mm());
    std::move(cut.begin(), cut.end(), std::back_inserter(sweeps));
  }
  const detail::BoneGrids& grids = bone.grids();
  const auto leaves = sweeps_by_leaf(*(grids.before ? grids.before : grids.sdf), bone, sweeps);
  if (leaves.empty()) return bone;
  std::vector<Coord> changed;
  changed.reserve(leaves.size());
  for (const auto& [origin, near] : leaves) changed.push_back(origin);
  const openvdb::FloatGrid::Ptr hole = hole_of_bone(grids);
  const LeafHole leaf_hole(*hole);
  change_leaves(*hole, changed, [&](const Coord& origin) {
    return [values = leaf_hole.widened(origin, leaves.at(origin), sweeps)](float /*value*/, const Coord& voxel) {
      return values[Leaf::coordToOffset(voxel)];
    };
  });
  return with_hole(bone, hole, changed);
}

BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, const Pose& start, const Pose& end) {
  const BitWay way{start, end};
  return subtract_bit(bone, bit, {&way, 1});
}

}  // namespace spinaltap
