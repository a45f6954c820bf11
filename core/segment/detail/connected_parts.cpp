#include "core/segment/detail/connected_parts.h"

#include <algorithm>
#include <array>
#include <functional>

#include "core/base/error.h"
#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

/// Voxels in a row along i, and the number of the part that they belong to.
struct Run {
  int begin, end;  ///< end is not in it
  std::size_t root;
};

/// Connected parts as runs, by union of the runs of neighbouring rows (Hoshen & Kopelman 1976).
class Parts {
 public:
  Parts(std::span<const std::uint8_t> inside, const GridGeometry& geometry, Neighbours neighbours = Neighbours::by_face)
      : geometry_(geometry), reach_(neighbours == Neighbours::by_corner ? 1 : 0) {
    if (inside.size() != geometry.voxel_count()) {
      fail("connected parts: expected ", geometry.voxel_count(), " voxels, found ", inside.size());
    }
    const int rows = geometry.size[1];
    const auto row_count = static_cast<std::size_t>(rows);
    first_.push_back(0);
    for (int k = 0; k < geometry.size[2]; ++k) {
      for (int j = 0; j < rows; ++j) {
        find_runs(inside.subspan(geometry.offset(0, j, k), static_cast<std::size_t>(geometry.size[0])));
        const std::size_t row = first_.size() - 2;
        if (j > 0) join(row, row - 1);
        if (k == 0) continue;
        join(row, row - row_count);
        if (reach_ == 0) continue;
        if (j > 0) join(row, row - row_count - 1);
        if (j + 1 < rows) join(row, row - row_count + 1);
      }
    }
    for (Run& run : runs_) run.root = find(run.root);
  }

  std::size_t run_count() const { return runs_.size(); }
  /// The voxels of each part, at the index of its root; 0 at all others.
  std::vector<std::size_t> voxels_by_root() const {
    std::vector<std::size_t> voxels(runs_.size(), 0);
    for (const Run& run : runs_) voxels[run.root] += static_cast<std::size_t>(run.end - run.begin);
    return voxels;
  }
  const Run& run(std::size_t n) const { return runs_[n]; }

  /// Calls `visit(run, offset of its first voxel)` for all runs in the order of memory.
  template <class Visit>
  void for_runs(const Visit& visit) const {
    for (std::size_t row = 0; row + 1 < first_.size(); ++row) {
      const std::size_t start = row * static_cast<std::size_t>(geometry_.size[0]);
      for (std::size_t n = first_[row]; n < first_[row + 1]; ++n) {
        visit(runs_[n], start + static_cast<std::size_t>(runs_[n].begin));
      }
    }
  }

 private:
  void find_runs(std::span<const std::uint8_t> row) {
    const int length = static_cast<int>(row.size());
    for (int i = 0; i < length; ++i) {
      if (row[static_cast<std::size_t>(i)] == 0) continue;
      Run run{i, i, runs_.size()};
      while (i < length && row[static_cast<std::size_t>(i)] != 0) ++i;
      run.end = i;
      runs_.push_back(run);
    }
    first_.push_back(runs_.size());
  }

  void join(std::size_t row, std::size_t other_row) {
    std::size_t a = first_[row];
    std::size_t b = first_[other_row];
    while (a < first_[row + 1] && b < first_[other_row + 1]) {
      if (runs_[a].begin < runs_[b].end + reach_ && runs_[b].begin < runs_[a].end + reach_) {
        const std::size_t root_a = find(a);
        const std::size_t root_b = find(b);
        runs_[std::max(root_a, root_b)].root = std::min(root_a, root_b);
      }
      (runs_[a].end < runs_[b].end ? a : b) += 1;
    }
  }

  std::size_t find(std::size_t n) {
    while (runs_[n].root != n) {
      runs_[n].root = runs_[runs_[n].root].root;
      n = runs_[n].root;
    }
    return n;
  }

  const GridGeometry& geometry_;
  int reach_;  ///< how far apart along i two runs of neighbouring rows may end and begin
  std::vector<Run> runs_;
  std::vector<std::size_t> first_;  ///< run of each row, and one past the last
};

std::vector<std::uint8_t> border_of(const GridGeometry& geometry) {
  std::vector<std::uint8_t> border(geometry.voxel_count(), 0);
  const auto& size = geometry.size;
  const auto at_end = [](int index, int length) { return index == 0 || index == length - 1; };
  std::size_t voxel = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++voxel) {
        if (at_end(i, size[0]) || at_end(j, size[1]) || at_end(k, size[2])) border[voxel] = 1;
      }
    }
  }
  return border;
}

}  // namespace

std::vector<std::uint8_t> parts_that_touch(std::span<const std::uint8_t> inside, std::span<const std::uint8_t> touched,
                                           const GridGeometry& geometry) {
  if (touched.size() != inside.size()) {
    fail("connected parts: expected two masks of one size, found ", inside.size(), " and ", touched.size(), " voxels");
  }
  const Parts parts(inside, geometry);
  std::vector<std::uint8_t> is_touched(parts.run_count(), 0);
  parts.for_runs([&](const Run& run, std::size_t first) {
    const auto begin = touched.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::any_of(begin, begin + (run.end - run.begin), [](std::uint8_t t) { return t != 0; })) {
      is_touched[run.root] = 1;
    }
  });
  std::vector<std::uint8_t> result(inside.size(), 0);
  parts.for_runs([&](const Run& run, std::size_t first) {
    if (is_touched[run.root] == 0) return;
    std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(first), run.end - run.begin, std::uint8_t{1});
  });
  return result;
}

std::vector<std::size_t> part_sizes(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                    Neighbours neighbours) {
  std::vector<std::size_t> voxels = Parts(inside, geometry, neighbours).voxels_by_root();
  std::erase(voxels, std::size_t{0});
  std::sort(voxels.begin(), voxels.end(), std::greater<>());
  return voxels;
}

std::vector<std::uint8_t> largest_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  const Parts parts(inside, geometry);
  const std::vector<std::size_t> voxels = parts.voxels_by_root();
  const auto largest = static_cast<std::size_t>(std::max_element(voxels.begin(), voxels.end()) - voxels.begin());
  std::vector<std::uint8_t> result(inside.size(), 0);
  parts.for_runs([&](const Run& run, std::size_t first) {
    if (run.root != largest) return;
    std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(first), run.end - run.begin, std::uint8_t{1});
  });
  return result;
}

std::vector<std::uint8_t> fill_hollows(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                       double seal_mm) {
  if (!(seal_mm >= 0.0 && seal_mm <= 50.0)) fail("fill: expected gaps of 0 to 50 mm to seal, found ", seal_mm, " mm");
  const auto limit = static_cast<float>(seal_mm * seal_mm);
  std::vector<std::uint8_t> filled(inside.begin(), inside.end());
  std::vector<std::uint8_t> roomy(inside.size());
  const auto is_far = [&](float squared_mm2) { return static_cast<std::uint8_t>(squared_mm2 > limit ? 1 : 0); };
  {
    const std::vector<float> to_bone = squared_distance_within(inside, geometry, seal_mm);
    std::transform(to_bone.begin(), to_bone.end(), roomy.begin(), is_far);
  }
  const std::vector<std::uint8_t> reached = parts_that_touch(roomy, border_of(geometry), geometry);
  const std::vector<float> to_reached = squared_distance_within(reached, geometry, seal_mm);
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (is_far(to_reached[i]) != 0) filled[i] = 1;
  }
  return filled;
}

}  // namespace spinaltap
