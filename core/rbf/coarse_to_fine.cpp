#include "core/rbf/coarse_to_fine.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "core/rbf/octree.h"
#include "core/rbf/sparse_grid.h"

namespace spinaltap::detail {
namespace {

/// Finds the nearest `wanted` points that come before place k; most points of the grid lie about half a cell apart.
void nearest_before(const SparseGrid& grid, std::span<const Vec3> points_mm, const std::vector<std::uint32_t>& order,
                    const std::vector<std::uint32_t>& place, std::size_t k, std::size_t wanted, std::uint32_t* out) {
  constexpr double kFirstRadius = 1.9;  // in cells: about forty points of a surface
  constexpr double kGrowth = 1.3;
  thread_local std::vector<std::pair<double, std::uint32_t>> found;
  for (double radius_mm = kFirstRadius * grid.cell_mm();; radius_mm *= kGrowth) {
    found.clear();
    grid.visit_within(points_mm[order[k]], radius_mm, [&](std::uint32_t index, double d2) {
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
  constexpr double kManyOf = 0.02;  // a level with this share of all points so far tells how dense they are
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
  Box3 bounds;
  for (const Vec3& p : points_mm) bounds.extend(p);
  // The distance to some point taken, an upper bound of that to the nearest.
  std::vector<double> reached_mm(count, std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint8_t> covered;
  std::size_t done = 0;
  double dense_mm = 0.0;  // spacing of most of the points taken; a few may lie far closer
  for (double spacing_mm = 0.5 * bounds.diagonal().norm(); done < count; spacing_mm *= kStep) {
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
      taken.add(candidates[i]);
      take(candidates[i]);
    }
    std::erase_if(waiting, [&](std::uint32_t index) { return place[index] != kUnplaced; });

    const std::size_t added = result.order.size() - done;
    if (added == 0) continue;
    if (dense_mm == 0.0 || static_cast<double>(added) > kManyOf * static_cast<double>(done)) dense_mm = spacing_mm;
    SparseGrid dense(points_mm, 2.0 * dense_mm, result.order.size());
    for (const std::uint32_t index : result.order) dense.add(index);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(done, result.order.size(), 64), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k) {
        std::uint32_t* near = result.near.data() + k * neighbours;
        if (k <= neighbours) {
          for (std::size_t i = 0; i < k; ++i) near[i] = static_cast<std::uint32_t>(i);
        } else {
          nearest_before(dense, points_mm, result.order, place, k, neighbours, near);
        }
      }
    });
    done = result.order.size();
  }
  return result;
}

}  // namespace spinaltap::detail
