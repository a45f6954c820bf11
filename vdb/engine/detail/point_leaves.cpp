#include "vdb/engine/detail/point_leaves.h"

#include <openvdb/openvdb.h>

#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/points/living_bits.h"

namespace spinaltap::detail {
namespace {

using openvdb::Coord;
using openvdb::Int32;
using CellTree = openvdb::tree::Tree3<Int32, 4, 2>::Type;
static_assert(CellTree::LeafNodeType::DIM == PointLeaves::kLeafCells);

/// Calls visit(disc, index, cell) for every living point.
template <class Visit>
void visit_living(const PointVolume& volume, double cell_mm, const Visit& visit) {
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    visit_up(volume.alive_words(disc).data(), 0, volume.pattern().point_count(), [&](std::size_t index) {
      const Vec3 p = volume.point_in_path_mm(disc, index) / cell_mm;
      visit(disc, index,
            Coord(static_cast<Int32>(std::floor(p.x())), static_cast<Int32>(std::floor(p.y())),
                  static_cast<Int32>(std::floor(p.z()))));
      return true;
    });
  }
}

Vec3 centre(const Coord& origin, double cells) {
  return Vec3(origin.x(), origin.y(), origin.z()) + Vec3::Constant(0.5 * cells);
}

}  // namespace

struct PointLeaves::Tree {
  CellTree cells{-1};
  std::vector<CellTree::LeafNodeType*> leaves;
};

PointLeaves::PointLeaves(const PointVolume& volume)
    : tree_(std::make_unique<Tree>()),
      cell_mm_(kCellSpacings * volume.pattern().spacing_mm()),
      shift_(static_cast<int>(std::bit_width(volume.pattern().point_count() - 1))) {
  if (!(static_cast<double>(volume.disc_count()) * std::exp2(shift_) <= 0x1.0p32)) {
    fail("leaf engine: expected at most 2^31 points, found ", volume.point_count());
  }
  // How many points each cell has; then each cell's number in its place.
  std::size_t points = 0;
  {
    openvdb::tree::ValueAccessor<CellTree> at(tree_->cells);
    visit_living(volume, cell_mm_, [&](int, std::size_t, const Coord& cell) {
      at.setValueOn(cell, std::max(at.getValue(cell), 0) + 1);
      ++points;
    });
  }
  tree_->cells.getNodes(tree_->leaves);
  std::uint32_t begin = 0;
  for (std::size_t n = 0; n < tree_->leaves.size(); ++n) {
    CellTree::LeafNodeType& leaf = *tree_->leaves[n];
    const auto first = static_cast<std::uint32_t>(cells_.size());
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      cells_.push_back({begin, 0, voxel.pos()});
      cell_centres_mm_.push_back(cell_mm_ * centre(voxel.getCoord(), 1.0));
      begin += static_cast<std::uint32_t>(voxel.getValue());
      voxel.setValue(static_cast<Int32>(cells_.size() - 1));
    }
    leaves_.push_back({first, static_cast<std::uint32_t>(cells_.size()) - first, static_cast<std::uint32_t>(n)});
    leaf_centres_mm_.push_back(cell_mm_ * centre(leaf.origin(), kLeafCells));
  }
  cell_count_ = cells_.size();
  points_.resize(points);
  openvdb::tree::ValueAccessor<const CellTree> number(tree_->cells);
  visit_living(volume, cell_mm_, [&](int disc, std::size_t index, const Coord& place) {
    Cell& cell = cells_[static_cast<std::size_t>(number.getValue(place))];
    points_[cell.begin + cell.living++] =
        static_cast<std::uint32_t>(disc) << shift_ | static_cast<std::uint32_t>(index);
  });
}

PointLeaves::~PointLeaves() = default;

void PointLeaves::forget_centres() {
  cell_centres_mm_ = {};
  leaf_centres_mm_ = {};
}

std::size_t PointLeaves::drop_cell(std::size_t leaf_place, std::size_t number) noexcept {
  Leaf& leaf = leaves_[leaf_place];
  CellTree::LeafNodeType& node = *tree_->leaves[leaf.node];
  const std::size_t last = leaf.begin + --leaf.count;
  node.setValueOff(cells_[number].voxel, -1);
  --cell_count_;
  if (last != number) {
    cells_[number] = cells_[last];
    node.setValueOnly(cells_[number].voxel, static_cast<Int32>(number));
  }
  return last;
}

std::size_t PointLeaves::drop_leaf(std::size_t leaf) noexcept {
  leaves_[leaf] = leaves_.back();
  leaves_.pop_back();
  return leaves_.size();
}

std::size_t PointLeaves::active_voxel_count() const { return tree_->cells.activeVoxelCount(); }

std::size_t PointLeaves::memory_bytes() const {
  return sizeof(*this) + static_cast<std::size_t>(tree_->cells.memUsage()) + tree_->leaves.size() * sizeof(void*) +
         leaves_.capacity() * sizeof(Leaf) + cells_.capacity() * sizeof(Cell) +
         points_.capacity() * sizeof(points_[0]) +
         (cell_centres_mm_.capacity() + leaf_centres_mm_.capacity()) * sizeof(Vec3);
}

}  // namespace spinaltap::detail
