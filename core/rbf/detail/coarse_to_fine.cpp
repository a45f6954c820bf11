#include "core/rbf/detail/coarse_to_fine.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/rbf/detail/octree.h"
#include "core/rbf/detail/sparse_grid.h"

namespace spinaltap::detail {
namespace {

/// The points so far, in cells that hold a dozen or two of them however they are spread: for searches of neighbours.
class NeighbourGrid {
 public:
  NeighbourGrid(std::span<const Vec3> points_mm, double cell_mm)
      : points_mm_(points_mm), smallest_cell_mm_(1e-6 * cell_mm), grid_(points_mm, cell_mm, points_mm.size()) {}

  /// Takes in the points of `order` from the first that it does not have.
  void add(const std::vector<std::uint32_t>& order) {
    constexpr double kFullest = 24.0;
    for (; size_ < order.size(); ++size_) grid_.add(order[size_]);
    // Many points in one place stay in one cell: there is an end to it.
    while (grid_.mean_occupancy() > kFullest && grid_.cell_mm() > smallest_cell_mm_) {
      SparseGrid finer(points_mm_, 0.6 * grid_.cell_mm(), points_mm_.size());
      for (const std::uint32_t index : order) finer.add(index);
      grid_ = std::move(finer);
    }
  }

  const SparseGrid& grid() const { return grid_; }

  /// Within which about `count` points of a surface lie.
  double radius_mm(std::size_t count) const {
    return grid_.cell_mm() * std::sqrt(static_cast<double>(count) / (std::numbers::pi * grid_.mean_occupancy()));
  }

 private:
  std::span<const Vec3> points_mm_;
  double smallest_cell_mm_;
  SparseGrid grid_;
  std::size_t size_ = 0;
};

/// Finds the nearest `wanted` points that come before place k.
void nearest_before(const NeighbourGrid& neighbours, std::span<const Vec3> points_mm,
                    const std::vector<std::uint32_t>& order, const std::vector<std::uint32_t>& place, std::size_t k,
                    std::size_t wanted, std::uint32_t* out) {
  constexpr double kMargin = 1.5;
  constexpr double kGrowth = 1.3;
  thread_local std::vector<std::pair<double, std::uint32_t>> found;
  for (double radius_mm = kMargin * neighbours.radius_mm(wanted);; radius_mm *= kGrowth) {
    found.clear();
    neighbours.grid().visit_within(points_mm[order[k]], radius_mm, [&](std::uint32_t index, double d2) {
      if (place[index] < k) found.emplace_back(d2, place[index]);
      return false;
    });
    if (found.size() >= wanted) break;
  }
  std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(wanted) - 1, found.end());
  found.resize(wanted);
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < wanted; ++i) out[i] = found[i].second;
}

}  // namespace

CoarseToFine coarse_to_fine(std::span<const Vec3> points_mm, std::span<const std::uint32_t> first,
                            std::size_t neighbours) {
  constexpr double kStep = 0.85;
  constexpr double kRest = 0.02;  // the last points, those that are near to others, come as they stand
  constexpr std::uint32_t kUnplaced = std::numeric_limits<std::uint32_t>::max();
  const std::size_t count = points_mm.size();
  CoarseToFine result;
  result.neighbours = neighbours;
  result.order.reserve(count);
  result.near.resize(count * neighbours);
  std::vector<std::uint32_t> place(count, kUnplaced);
  const auto take = [&](std::uint32_t index) {
    place[index] = static_cast<std::uint32_t>(result.order.size());
    result.order.push_back(index);
  };
  for (const std::uint32_t index : first) take(index);

  // In the order of an octree, so that what is near in space is near in memory.
  constexpr std::size_t kFewPoints = 8;
  std::vector<std::uint32_t> waiting = Octree(points_mm, kFewPoints).sorted();
  std::erase_if(waiting, [&](std::uint32_t index) { return place[index] != kUnplaced; });
  const Box3 bounds = bounds_of(points_mm);
  // The distance to some point taken, an upper bound of that to the nearest.
  std::vector<double> reached_mm(count, std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint8_t> covered;
  std::size_t done = 0;
  NeighbourGrid neighbour_grid(points_mm, std::max(bounds.diagonal().norm(), 1e-300));
  for (double spacing_mm = 0.5 * bounds.diagonal().norm(); done < count; spacing_mm *= kStep) {
    if (static_cast<double>(waiting.size()) < kRest * static_cast<double>(count)) {
      for (const std::uint32_t index : waiting) take(index);
      waiting.clear();
    }
    const double spacing2 = spacing_mm * spacing_mm;
    candidates.clear();
    for (const std::uint32_t index : waiting) {
      if (!(reached_mm[index] < spacing_mm)) candidates.push_back(index);
    }
    const auto covered_by = [&](const SparseGrid& grid, std::uint32_t index) {
      return grid.visit_within(points_mm[index], spacing_mm, [&](std::uint32_t, double d2) {
        if (!(d2 < spacing2)) return false;
        reached_mm[index] = std::sqrt(d2);
        return true;
      });
    };
    SparseGrid taken(points_mm, 2.0 * spacing_mm, count);
    for (const std::uint32_t index : result.order) taken.add(index);
    covered.assign(candidates.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, candidates.size(), 256), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) covered[i] = covered_by(taken, candidates[i]) ? 1 : 0;
    });
    SparseGrid fresh(points_mm, 2.0 * spacing_mm, candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (covered[i] != 0 || covered_by(fresh, candidates[i])) continue;
      fresh.add(candidates[i]);
      take(candidates[i]);
    }
    std::erase_if(waiting, [&](std::uint32_t index) { return place[index] != kUnplaced; });

    if (neighbours == 0) {
      done = result.order.size();
      continue;
    }
    neighbour_grid.add(result.order);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(done, result.order.size(), 64), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k) {
        std::uint32_t* near = result.near.data() + k * neighbours;
        if (k <= neighbours) {
          for (std::size_t i = 0; i < k; ++i) near[i] = static_cast<std::uint32_t>(i);
        } else {
          nearest_before(neighbour_grid, points_mm, result.order, place, k, neighbours, near);
        }
      }
    });
    done = result.order.size();
  }
  return result;
}

}  // namespace spinaltap::detail
