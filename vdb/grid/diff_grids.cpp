#include "vdb/grid/diff_grids.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using Accessor = openvdb::FloatGrid::ConstAccessor;
using Leaf = openvdb::FloatTree::LeafNodeType;

std::array<int, 3> indices(const Coord& voxel) { return {voxel.x(), voxel.y(), voxel.z()}; }

ActiveVoxels active_voxels(const openvdb::FloatGrid& grid) {
  ActiveVoxels active{grid.activeVoxelCount(), {}, {}};
  if (active.count == 0) return active;
  const CoordBBox box = grid.evalActiveVoxelBoundingBox();
  active.low = indices(box.min());
  active.high = indices(box.max());
  return active;
}

/// Adds up what pairs of values differ by, in the order in which it is told of them.
class Tally {
 public:
  Tally(GridDifference& difference, double tolerance) : difference_(difference), tolerance_(tolerance) {}

  /// `count` voxels from `at` on with the same two values.
  void add(const Coord& at, float a, bool a_active, float b, bool b_active, std::uint64_t count) {
    const double by = a == b ? 0.0 : std::abs(static_cast<double>(a) - static_cast<double>(b));
    const bool differs = !(by <= tolerance_);
    if (!a_active && !b_active) {
      difference_.inactive_different += differs ? count : 0;
      return;
    }
    difference_.compared += count;
    if (!b_active) difference_.only_in_a += count;
    if (!a_active) difference_.only_in_b += count;
    if (!std::isnan(by)) {
      numbers_ += count;
      sum_ += by * static_cast<double>(count);
      sum_of_squares_ += by * by * static_cast<double>(count);
      difference_.linf = std::max(difference_.linf, by);
    }
    if (!differs) return;
    difference_.different += count;
    if (!first_ || at < *first_) {
      first_ = at;
      difference_.first = VoxelDifference{indices(at), Vec3::Zero(), a, b};
    }
  }

  void finish() {
    if (numbers_ == 0) return;
    difference_.l1 = sum_ / static_cast<double>(numbers_);
    difference_.l2 = std::sqrt(sum_of_squares_ / static_cast<double>(numbers_));
  }

 private:
  GridDifference& difference_;
  double tolerance_;
  std::uint64_t numbers_ = 0;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  std::optional<Coord> first_;
};

/// Where one of the grids has a leaf: its 512 voxels, one by one.
void compare_leaves(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b, Tally& tally) {
  std::set<Coord> origins;
  for (auto leaf = a.tree().cbeginLeaf(); leaf; ++leaf) origins.insert(leaf->origin());
  for (auto leaf = b.tree().cbeginLeaf(); leaf; ++leaf) origins.insert(leaf->origin());
  const Accessor in_a = a.getConstAccessor();
  const Accessor in_b = b.getConstAccessor();
  for (const Coord& origin : origins) {
    const Leaf* const leaf_a = in_a.probeConstLeaf(origin);
    const Leaf* const leaf_b = in_b.probeConstLeaf(origin);
    const auto read = [&](const Leaf* leaf, const Accessor& accessor, openvdb::Index i) {
      if (leaf != nullptr) return std::pair(leaf->getValue(i), leaf->isValueOn(i));
      return std::pair(accessor.getValue(origin), accessor.isValueOn(origin));  // a tile: one value for all
    };
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
      const auto [value_a, active_a] = read(leaf_a, in_a, i);
      const auto [value_b, active_b] = read(leaf_b, in_b, i);
      tally.add(Leaf::offsetToLocalCoord(i) + origin, value_a, active_a, value_b, active_b, 1);
    }
  }
}

/// Where neither has: the tiles of `tiles_of`, against those of the other that are as large or larger (or only larger,
/// so that no pair of equal tiles comes twice).
template <class Add>
void compare_tiles(const openvdb::FloatGrid& tiles_of, const openvdb::FloatGrid& other, bool also_equal,
                   const Add& add) {
  const Accessor accessor = other.getConstAccessor();
  auto tile = tiles_of.tree().cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    CoordBBox box;
    tile.getBoundingBox(box);
    // -1 stands for the background beyond the root's own tiles.
    const int depth = static_cast<int>(tile.getDepth());
    const int other_depth = accessor.getValueDepth(box.min());
    if (other_depth > depth || (other_depth == depth && !also_equal)) continue;
    add(box.min(), *tile, tile.isValueOn(), accessor.getValue(box.min()), accessor.isValueOn(box.min()), box.volume());
  }
}

std::vector<std::string> different_metadata(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
  std::set<std::string> names;
  const auto collect = [&](const openvdb::FloatGrid& one, const openvdb::FloatGrid& other) {
    for (auto meta = one.beginMeta(); meta != one.endMeta(); ++meta) {
      const openvdb::Metadata::ConstPtr same_name = other[meta->first];
      if (!same_name || *same_name != *meta->second) names.insert(meta->first);
    }
  };
  collect(a, b);
  collect(b, a);
  return {names.begin(), names.end()};
}

void compare(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b, double tolerance, GridDifference& difference) {
  difference.same_transform = a.transform() == b.transform();
  difference.same_background =
      a.background() == b.background() ||
      std::abs(static_cast<double>(a.background()) - static_cast<double>(b.background())) <= tolerance;
  difference.metadata = different_metadata(a, b);
  Tally tally(difference, tolerance);
  compare_leaves(a, b, tally);
  compare_tiles(a, b, true, [&](const Coord& at, float of_a, bool a_on, float of_b, bool b_on, std::uint64_t count) {
    tally.add(at, of_a, a_on, of_b, b_on, count);
  });
  compare_tiles(b, a, false, [&](const Coord& at, float of_b, bool b_on, float of_a, bool a_on, std::uint64_t count) {
    tally.add(at, of_a, a_on, of_b, b_on, count);
  });
  tally.finish();
  if (difference.first) {
    VoxelDifference& first = *difference.first;
    first.position_mm = detail::from_vdb(a.indexToWorld(Coord(first.index[0], first.index[1], first.index[2])));
  }
  const bool same_voxels = difference.only_in_a == 0 && difference.only_in_b == 0;
  difference.same = difference.same_transform && difference.same_background && difference.different == 0 &&
                    difference.inactive_different == 0 && (tolerance > 0.0 || same_voxels);
}

/// By name, and of one name by its place in the file.
using NamedGrids = std::map<std::pair<std::string, int>, openvdb::FloatGrid::ConstPtr>;

NamedGrids read_float_grids(const std::filesystem::path& path) {
  NamedGrids grids;
  std::map<std::string, int> seen;
  for (const openvdb::FloatGrid::Ptr& grid : detail::VdbFile(path).read_all_floats()) {
    if (!grid->transform().isLinear()) fail("expected grids without perspective in ", path.string());
    grids[{grid->getName(), seen[grid->getName()]++}] = grid;
  }
  if (grids.empty()) fail("expected grids of floats in ", path.string(), ", found none");
  return grids;
}

}  // namespace

std::vector<GridDifference> diff_grids(const std::filesystem::path& a, const std::filesystem::path& b,
                                       const DiffOptions& options) {
  if (!(options.tolerance >= 0.0)) fail("diff: expected a tolerance of 0 or more, found ", options.tolerance);
  const NamedGrids in_a = read_float_grids(a);
  const NamedGrids in_b = read_float_grids(b);
  std::set<std::pair<std::string, int>> names;
  for (const auto& [name, grid] : in_a) names.insert(name);
  for (const auto& [name, grid] : in_b) names.insert(name);
  std::vector<GridDifference> differences;
  for (const auto& name : names) {
    GridDifference difference;
    difference.name = name.first + (name.second > 0 ? " (" + std::to_string(name.second + 1) + ")" : "");
    const auto of_a = in_a.find(name);
    const auto of_b = in_b.find(name);
    difference.in_a = of_a != in_a.end();
    difference.in_b = of_b != in_b.end();
    if (difference.in_a) difference.a = active_voxels(*of_a->second);
    if (difference.in_b) difference.b = active_voxels(*of_b->second);
    if (difference.in_a && difference.in_b) compare(*of_a->second, *of_b->second, options.tolerance, difference);
    differences.push_back(std::move(difference));
  }
  return differences;
}

}  // namespace spinaltap
