#include "vdb/engine/detail/point_leaves.h"

#include <openvdb/openvdb.h>

#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/points/occupied_bits.h"

namespace spinaltap::detail {
namespace {

using openvdb::Coord;
using openvdb::Int32;
using CellTree = openvdb::tree::Tree4<Int32, 4, 2, 2>::Type;
using CellNode = CellTree::LeafNodeType;
using LeafNode = CellTree::RootNodeType::ChildNodeType::ChildNodeType;
static_assert(CellNode::DIM == PointLeaves::kLeafCells);
static_assert(LeafNode::DIM == PointLeaves::kLeafCells * PointLeaves::kNodeLeaves);

/// Calls visit(disc, index, cell) for every occupied point.
template <class Visit>
void visit_occupied(const PointVolume& volume, double cell_mm, const Visit& visit) {
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    visit_up(volume.occupancy_words(disc).data(), 0, volume.pattern().point_count(), [&](std::size_t index) {
      const Vec3 p = volume.point_in_path_mm(disc, index) / cell_mm;
      visit(disc, index,
            Coord(static_cast<Int32>(std::floor(p.x())), static_cast<Int32>(std::floor(p.y())),
                  static_cast<Int32>(std::floor(p.z()))));
      return true;
    });
  }
}

/// Adds a box `cells` cells wide to a level.
void list_box(CertificateTree::Level& level, const Coord& origin, int cells, double cell_mm) {
  level.half_mm = 0.5 * std::sqrt(3.0) * cells * cell_mm;
  level.centres_mm.push_back(cell_mm * (Vec3(origin.x(), origin.y(), origin.z()) + Vec3::Constant(0.5 * cells)));
}

}  // namespace

struct PointLeaves::Tree {
  CellTree cells{-1};
  std::vector<CellNode*> leaves;
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
    visit_occupied(volume, cell_mm_, [&](int, std::size_t, const Coord& cell) {
      at.setValueOn(cell, std::max(at.getValue(cell), 0) + 1);
      ++points;
    });
  }
  tree_->cells.getNodes(tree_->leaves);
  std::uint32_t begin = 0;
  for (std::size_t n = 0; n < tree_->leaves.size(); ++n) {
    CellNode& leaf = *tree_->leaves[n];
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      cells_.push_back({begin, 0, static_cast<std::uint32_t>(n), voxel.pos()});
      begin += static_cast<std::uint32_t>(voxel.getValue());
      voxel.setValue(static_cast<Int32>(cells_.size() - 1));
    }
  }
  cell_count_ = cells_.size();
  points_.resize(points);
  openvdb::tree::ValueAccessor<const CellTree> number(tree_->cells);
  visit_occupied(volume, cell_mm_, [&](int disc, std::size_t index, const Coord& place) {
    Cell& cell = cells_[static_cast<std::size_t>(number.getValue(place))];
    points_[cell.begin + cell.occupied++] =
        static_cast<std::uint32_t>(disc) << shift_ | static_cast<std::uint32_t>(index);
  });
}

PointLeaves::~PointLeaves() = default;

std::vector<CertificateTree::Level> PointLeaves::levels() const {
  std::vector<CertificateTree::Level> levels(3);
  CertificateTree::Level &cells = levels[0], &leaves = levels[1], &nodes = levels[2];
  std::vector<const LeafNode*> all;
  tree_->cells.getNodes(all);
  for (const LeafNode* node : all) {
    const std::size_t first_leaf = leaves.centres_mm.size();
    for (auto leaf = node->cbeginChildOn(); leaf; ++leaf) {
      const std::size_t first_cell = cells.centres_mm.size();
      for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) list_box(cells, voxel.getCoord(), 1, cell_mm_);
      list_box(leaves, leaf->origin(), kLeafCells, cell_mm_);
      leaves.add_children(first_cell, cells.centres_mm.size());
    }
    list_box(nodes, node->origin(), kLeafCells * kNodeLeaves, cell_mm_);
    nodes.add_children(first_leaf, leaves.centres_mm.size());
  }
  return levels;
}

void PointLeaves::drop_cell(std::size_t number, std::size_t last) noexcept {
  CellNode& leaf = *tree_->leaves[cells_[number].leaf];
  leaf.setValueOff(cells_[number].voxel, -1);
  --cell_count_;
  if (last == number) return;
  cells_[number] = cells_[last];
  leaf.setValueOnly(cells_[number].voxel, static_cast<Int32>(number));
}

std::size_t PointLeaves::active_voxel_count() const { return tree_->cells.activeVoxelCount(); }

std::size_t PointLeaves::memory_bytes() const {
  return sizeof(*this) + static_cast<std::size_t>(tree_->cells.memUsage()) + tree_->leaves.size() * sizeof(void*) +
         cells_.capacity() * sizeof(Cell) + points_.capacity() * sizeof(points_[0]);
}

}  // namespace spinaltap::detail
