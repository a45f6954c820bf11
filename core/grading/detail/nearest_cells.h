#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/anatomy/point_tree.h"

namespace spinaltap {

/// PointTree::nearest() for very many positions in one region: cells keep all points that can be nearest to a position
/// in them (the dual of the points' Voronoi cells), found when one is asked first. Safe to ask from many threads.
class NearestCells {
 public:
  /// `tree` must outlive this.
  explicit NearestCells(const PointTree& tree);
  ~NearestCells();
  NearestCells(const NearestCells&) = delete;
  NearestCells& operator=(const NearestCells&) = delete;

  /// Its place in the tree's points: the same as PointTree::nearest() finds.
  std::size_t nearest(const Vec3& p_mm) const;
  /// Has the memory fetched that nearest() will read for these: sooner where several are asked one after the other.
  void expect(std::span<const Vec3> places_mm) const;

 private:
  static constexpr std::size_t kCellsASide = 4, kCellsAPart = 2, kPartsASide = kCellsASide / kCellsAPart;
  /// Halves would be searched a little sooner, but there are several times as many to make, for places that are asked
  /// too seldom.
  static constexpr double kCellMm = 1.0, kBlockMm = kCellMm * kCellsASide;
  struct Four;
  struct Block;
  struct CellPlace {
    std::array<std::size_t, 3> of_blocks{}, in_block{};
    std::size_t block = 0;  ///< in blocks_
  };

  /// False where there is none.
  bool find_cell(const Vec3& p_mm, CellPlace& place) const;
  std::unique_ptr<Block> make_block(const Vec3& middle_mm) const;

  const PointTree& tree_;
  Vec3 low_mm_ = Vec3::Zero();
  std::array<std::size_t, 3> size_{};  ///< in blocks
  mutable std::vector<std::atomic<Block*>> blocks_;
};

}  // namespace spinaltap
