#include "vdb/remaining/hole_cutter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap {
namespace {

using openvdb::Coord;

using Leaf = openvdb::FloatGrid::TreeType::LeafNodeType;
/// The poses of ways, each way's straight from one to the next.
using Ways = std::vector<std::vector<Pose>>;

/// From a leaf's middle to its corners' voxels.
double leaf_reach_mm(const openvdb::FloatGrid& grid) { return 3.5 * std::sqrt(3.0) * grid.voxelSize()[0]; }

Vec3 middle_mm(const openvdb::FloatGrid& grid, const Coord& leaf_origin) {
  return detail::from_vdb(grid.indexToWorld(leaf_origin.asVec3d() + openvdb::Vec3d(3.5)));
}

/// Changes all values of some leaves, which are made where there are none. `prepare(origin)` gives what makes of a
/// value and its voxel a new value. Those within the band are active; a leaf without any becomes a tile.
template <class Origins, class Prepare>
void change_leaves(openvdb::FloatGrid& grid, const Origins& origins, const Prepare& prepare) {
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
  for (const Coord& origin : origins) {
    const Leaf* const leaf = grid.tree().probeConstLeaf(origin);
    if (!leaf->isEmpty()) continue;
    const float value = leaf->getFirstValue();
    const bool is_even = std::all_of(leaf->buffer().data(), leaf->buffer().data() + Leaf::SIZE,
                                     [value](float other) { return other == value; });
    if (is_even) grid.tree().addTile(1, origin, value, false);
  }
}

/// The distances of a bone before anything was drilled.
const openvdb::FloatGrid& before_of(const detail::BoneGrids& bone) { return *(bone.before ? bone.before : bone.sdf); }

/// Origins of those leaves within a box that hold bone or its band, in order.
std::vector<Coord> leaves_with_bone(const openvdb::FloatGrid& bone, const Box3& box_mm) {
  const auto& transform = bone.transform();
  const Coord low = Coord::floor(transform.worldToIndex(detail::to_vdb(box_mm.min())));
  const Coord high = Coord::ceil(transform.worldToIndex(detail::to_vdb(box_mm.max())));
  std::vector<Coord> origins;
  const auto accessor = bone.getConstAccessor();
  for (int k = low.z() & ~7; k <= high.z(); k += 8) {
    for (int j = low.y() & ~7; j <= high.y(); j += 8) {
      for (int i = low.x() & ~7; i <= high.x(); i += 8) {
        const Coord origin(i, j, k);
        if (accessor.probeConstLeaf(origin) != nullptr || accessor.getValue(origin) < 0.0F) origins.push_back(origin);
      }
    }
  }
  return origins;
}

/// The bone's hole, or an empty one.
openvdb::FloatGrid::Ptr hole_of_bone(const detail::BoneGrids& bone) {
  if (bone.hole) return bone.hole->deepCopy();
  const openvdb::FloatGrid& before = before_of(bone);
  openvdb::FloatGrid::Ptr hole = openvdb::FloatGrid::create(before.background());
  hole->setTransform(before.transform().copy());
  hole->setGridClass(openvdb::GRID_LEVEL_SET);
  hole->setName("hole");
  return hole;
}

/// Which sweeps come near a leaf of the bone, by the leaf's origin.
std::map<Coord, std::vector<std::size_t>> sweeps_by_leaf(const BoneModel& bone,
                                                         std::span<const detail::BitSweep> sweeps) {
  std::map<Coord, std::vector<std::size_t>> leaves;
  const openvdb::FloatGrid& before = before_of(bone.grids());
  const Box3 bone_mm = bone.bounds_mm();
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    const Box3 box_mm = sweeps[n].bounds_mm(bone.band_mm()).intersection(bone_mm);
    if (box_mm.isEmpty()) continue;
    for (const Coord& origin : leaves_with_bone(before, box_mm)) leaves[origin].push_back(n);
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

}  // namespace

struct HoleCutter::State {
  /// A chunk's sweeps are found, cut out and forgotten together; what is left of the last chunk is cut out of a copy.
  /// So the same poses give the same bits whenever the bone is asked for.
  static constexpr std::size_t kPosesAChunk = 512;

  BoneModel bone;  ///< as it was given
  openvdb::FloatGrid::Ptr hole = hole_of_bone(bone.grids());
  std::set<Coord> changed = {};  ///< leaves of `hole`, since then
  DrillBit bit = {};
  double max_jump_mm = 0.0;
  std::optional<Pose> last = {};
  Ways pending = {};  ///< of the chunk that is not whole
  std::size_t poses = 0;
  /// All so far, where it was asked for.
  struct Whole {
    openvdb::FloatGrid::Ptr hole;
    std::set<Coord> changed;
    std::optional<BoneModel> bone;
  };
  std::optional<Whole> whole = {};

  void add(const Pose& pose, bool begins_way) {
    whole.reset();
    if (begins_way || pending.empty()) pending.emplace_back();
    pending.back().push_back(pose);
    if (++poses < kPosesAChunk) return;
    cut_out(pending, *hole, changed);
    pending = {{pose}};
    poses = 0;
  }
  /// Where the bit has come to next: a ToolInput or a ToolMove each.
  template <class Move>
  void add_moves(std::span<const Move> moves) {
    bool goes_on = last.has_value();  // the first way then begins with a pose that is there
    for (const std::vector<Pose>& way : cutting_ways(moves, bit, max_jump_mm, last)) {
      for (std::size_t n = goes_on ? 1 : 0; n < way.size(); ++n) add(way[n], n == 0);
      goes_on = false;
    }
  }
  void end_chunk() {
    if (poses > 0) cut_out(pending, *hole, changed);
    pending.clear();
    poses = 0;
  }
  void cut_out(const Ways& ways, openvdb::FloatGrid& from, std::set<Coord>& leaves_changed) const;
  const Whole& whole_hole();
  BoneModel cut_bone() const;
};

void HoleCutter::State::cut_out(const Ways& ways, openvdb::FloatGrid& from, std::set<Coord>& leaves_changed) const {
  constexpr double kToleranceVoxels = 0.01, kLongestVoxels = 8.0;
  std::vector<detail::BitSweep> sweeps;
  for (const std::vector<Pose>& way : ways) {
    std::vector<detail::BitSweep> of_way =
        detail::cut_into_sweeps(bit, way, kToleranceVoxels * bone.voxel_mm(), kLongestVoxels * bone.voxel_mm());
    std::move(of_way.begin(), of_way.end(), std::back_inserter(sweeps));
  }
  const auto leaves = sweeps_by_leaf(bone, sweeps);
  std::vector<Coord> origins;
  origins.reserve(leaves.size());
  for (const auto& [origin, near] : leaves) origins.push_back(origin);
  leaves_changed.insert(origins.begin(), origins.end());
  const LeafHole leaf_hole(from);
  change_leaves(from, origins, [&](const Coord& origin) {
    return [values = leaf_hole.widened(origin, leaves.at(origin), sweeps)](float /*value*/, const Coord& voxel) {
      return values[Leaf::coordToOffset(voxel)];
    };
  });
}

const HoleCutter::State::Whole& HoleCutter::State::whole_hole() {
  if (whole) return *whole;
  whole.emplace(Whole{hole->deepCopy(), changed, {}});
  if (poses > 0) cut_out(pending, *whole->hole, whole->changed);
  return *whole;
}

BoneModel HoleCutter::State::cut_bone() const {
  if (whole->changed.empty()) return bone;
  const auto grids = std::make_shared<detail::BoneGrids>(bone.grids());
  const openvdb::FloatGrid::Ptr sdf = bone.grids().sdf->deepCopy();
  change_leaves(*sdf, whole->changed, [&](const Coord&) {
    return [hole_values = whole->hole->getConstAccessor()](float value, const Coord& voxel) {
      return std::max(value, -hole_values.getValue(voxel));
    };
  });
  grids->before = bone.grids().before ? bone.grids().before : bone.grids().sdf;
  grids->hole = whole->hole;
  grids->sdf = sdf;
  return BoneModel(grids);
}

HoleCutter::HoleCutter(BoneModel bone) : state_(std::make_unique<State>(State{.bone = std::move(bone)})) {}
HoleCutter::~HoleCutter() = default;
HoleCutter::HoleCutter(HoleCutter&&) noexcept = default;
HoleCutter& HoleCutter::operator=(HoleCutter&&) noexcept = default;

void HoleCutter::take_bit(const DrillBit& bit, double max_jump_mm) {
  check_bit(bit);
  state_->end_chunk();
  state_->bit = bit;
  state_->max_jump_mm = max_jump_mm;
  state_->last.reset();
}

void HoleCutter::add(std::span<const ToolInput> inputs) { state_->add_moves(inputs); }
void HoleCutter::add(std::span<const ToolMove> moves) { state_->add_moves(moves); }

void HoleCutter::add(const DrilledHole& hole) {
  Ways ways = hole.ways;
  for (std::vector<Pose>& way : ways) {
    for (Pose& pose : way) {
      const std::optional<Pose> sound = valid_pose(pose, hole.bit);
      if (!sound)
        fail("cutting a hole: expected places that are finite, axes of length 1, and of plates sides across them");
      pose = *sound;
    }
  }
  take_bit(hole.bit, std::numeric_limits<double>::infinity());
  for (const std::vector<Pose>& way : ways) {
    for (std::size_t n = 0; n < way.size(); ++n) state_->add(way[n], n == 0);
  }
}

const BoneModel& HoleCutter::bone() {
  state_->whole_hole();
  if (!state_->whole->bone) state_->whole->bone = state_->cut_bone();
  return *state_->whole->bone;
}

CutHole HoleCutter::hole() {
  const auto grids = std::make_shared<detail::BoneGrids>();
  grids->hole = state_->whole_hole().hole;
  return {state_->bone, grids};
}

BoneModel without_holes(const BoneModel& bone, std::span<const DrilledHole> holes) {
  if (holes.empty()) return bone;
  HoleCutter cutter(bone);
  for (const DrilledHole& hole : holes) cutter.add(hole);
  return cutter.bone();
}

}  // namespace spinaltap
