#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/points/point_volume.h"
#include "vdb/engine/detail/certificate_tree.h"

namespace spinaltap::detail {

/// The occupied points of a volume, ordered by the leaves of a VDB tree.
///
/// The tree's index space is the volume's own path frame in cells of a few spacings; an active voxel is a cell that has
/// occupied points, and its value the cell's number. Cells are numbered leaf by leaf, and a cell's points lie together.
/// A cell that is empty is dropped: its voxel is switched off, and its leaf's last cell takes its number. Nothing is
/// allocated after construction.
class PointLeaves {
 public:
  /// Edge of a cell in spacings, of a leaf in cells, of a node in leaves: of about 60, 4,000 and 250,000 points.
  static constexpr int kCellSpacings = 4;
  static constexpr int kLeafCells = 4;
  static constexpr int kNodeLeaves = 4;

  /// Throws Error on more than 2^31 points.
  explicit PointLeaves(const PointVolume& volume);
  ~PointLeaves();
  PointLeaves(const PointLeaves&) = delete;
  PointLeaves& operator=(const PointLeaves&) = delete;

  /// Centres of cells, leaves and nodes as they were numbered at first, path-local, and what lies in which.
  std::vector<CertificateTree::Level> levels() const;

  struct Cell {
    std::uint32_t begin;     ///< its first point
    std::uint32_t occupied;  ///< of points
    std::uint32_t leaf;      ///< of the tree
    std::uint32_t voxel;     ///< in the leaf
  };
  struct Point {
    int disc;
    std::size_t index;
  };

  Cell& cell(std::size_t number) { return cells_[number]; }
  /// How many cells have occupied points.
  std::size_t cell_count() const { return cell_count_; }
  Point point(std::size_t place) const {
    return {static_cast<int>(points_[place] >> shift_), points_[place] & ((std::uint32_t{1} << shift_) - 1)};
  }
  /// Takes the point at `place` out of its cell; the cell's last occupied point moves there.
  void drop_point(Cell& cell, std::size_t place) noexcept { points_[place] = points_[cell.begin + --cell.occupied]; }
  /// Takes an empty cell out of its leaf, whose last cell gets its number.
  void drop_cell(std::size_t number, std::size_t last) noexcept;

  /// Active voxels of the tree: counted anew, to check the above.
  std::size_t active_voxel_count() const;
  std::size_t memory_bytes() const;

 private:
  struct Tree;

  std::unique_ptr<Tree> tree_;
  double cell_mm_ = 0.0;
  int shift_ = 0;  ///< points_ hold disc << shift | index
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> points_;
  std::size_t cell_count_ = 0;
};

}  // namespace spinaltap::detail
