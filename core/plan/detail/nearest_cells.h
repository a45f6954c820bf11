#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/plan/point_tree.h"

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

 private:
  /// Points, each coordinate for itself, for vector instructions.
  struct Points {
    std::vector<double> x, y, z;
    std::vector<std::uint32_t> index;

    std::size_t size() const { return index.size(); }
    void add(const Vec3& p_mm, std::uint32_t place);
    std::vector<double> squared_mm2(const Vec3& p_mm) const;
    std::size_t nearest(const Vec3& p_mm) const;
  };
  static constexpr int kCellsASide = 8;
  static constexpr double kCellMm = 0.5, kBlockMm = kCellMm * kCellsASide;
  struct Block {
    Points points;
    std::array<std::atomic<const Points*>, std::size_t{kCellsASide} * kCellsASide * kCellsASide> cells{};
    ~Block();
  };

  /// Those of `around` that can be nearest to a position within `half_mm` of a middle along each axis. `around` holds
  /// at least those.
  static Points can_be_nearest(const Points& around, const Vec3& middle_mm, double half_mm);
  Points block_points(const Vec3& middle_mm) const;

  const PointTree& tree_;
  Vec3 low_mm_ = Vec3::Zero();
  std::array<int, 3> size_{};  ///< in blocks
  mutable std::vector<std::atomic<Block*>> blocks_;
};

}  // namespace spinaltap
