#include "core/segment/mask_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

/// The box around a mask, with a voxel of outside on each side.
struct PaddedMask {
  GridGeometry geometry;
  std::vector<std::uint8_t> inside;
};

PaddedMask padded(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  std::array<int, 3> low = geometry.size;
  std::array<int, 3> high{-1, -1, -1};
  std::size_t at = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i, ++at) {
        if (inside[at] == 0) continue;
        const std::array<int, 3> here{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], here[axis]);
          high[axis] = std::max(high[axis], here[axis]);
        }
      }
    }
  }
  PaddedMask box;
  if (high[0] < 0) return box;
  box.geometry.spacing_mm = geometry.spacing_mm;
  for (std::size_t axis = 0; axis < 3; ++axis) box.geometry.size[axis] = high[axis] - low[axis] + 3;
  box.inside.assign(box.geometry.voxel_count(), 0);
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        if (inside[geometry.offset(i, j, k)] == 0) continue;
        box.inside[box.geometry.offset(i - low[0] + 1, j - low[1] + 1, k - low[2] + 1)] = 1;
      }
    }
  }
  return box;
}

/// Voxels of each part of those that are `value`, neighbours a step along at most `reach` axes apart; the part that
/// holds the first voxel first.
std::vector<std::size_t> parts_of(const PaddedMask& mask, std::uint8_t value, int reach) {
  const std::array<int, 3>& size = mask.geometry.size;
  std::vector<std::uint8_t> seen(mask.inside.size(), 0);
  std::vector<std::array<int, 3>> todo;
  std::vector<std::size_t> sizes;
  std::size_t at = 0;
  const auto visit = [&](int i, int j, int k) {
    const std::size_t voxel = mask.geometry.offset(i, j, k);
    if (seen[voxel] != 0 || mask.inside[voxel] != value) return;
    seen[voxel] = 1;
    todo.push_back({i, j, k});
  };
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++at) {
        if (seen[at] != 0 || mask.inside[at] != value) continue;
        std::size_t count = 0;
        for (visit(i, j, k); !todo.empty(); ++count) {
          const std::array<int, 3> here = todo.back();
          todo.pop_back();
          for (int dk = -1; dk <= 1; ++dk) {
            for (int dj = -1; dj <= 1; ++dj) {
              for (int di = -1; di <= 1; ++di) {
                if (std::abs(di) + std::abs(dj) + std::abs(dk) > reach) continue;
                if (mask.geometry.contains(here[0] + di, here[1] + dj, here[2] + dk))
                  visit(here[0] + di, here[1] + dj, here[2] + dk);
              }
            }
          }
        }
        sizes.push_back(count);
      }
    }
  }
  return sizes;
}

/// Corners - edges + faces - voxels of the closed voxels: each corner, edge and face counts once, by the voxels around
/// it. The padding gives every one of them its place below some voxel's.
long euler_number(const PaddedMask& mask) {
  const std::array<int, 3>& size = mask.geometry.size;
  long sum = 0;
  for (int k = 1; k < size[2]; ++k) {
    for (int j = 1; j < size[1]; ++j) {
      for (int i = 1; i < size[0]; ++i) {
        std::array<bool, 8> v{};
        for (std::size_t n = 0; n < 8; ++n) {
          const int low = static_cast<int>(n);
          v[n] = mask.inside[mask.geometry.offset(i - (low & 1), j - (low >> 1 & 1), k - (low >> 2))] != 0;
        }
        const bool corner = std::any_of(v.begin(), v.end(), [](bool one) { return one; });
        if (!corner) continue;
        // Of this corner the edges and faces that begin at it, and the voxel.
        const int edges = static_cast<int>(v[0] || v[2] || v[4] || v[6]) +
                          static_cast<int>(v[0] || v[1] || v[4] || v[5]) +
                          static_cast<int>(v[0] || v[1] || v[2] || v[3]);
        const int faces =
            static_cast<int>(v[0] || v[4]) + static_cast<int>(v[0] || v[2]) + static_cast<int>(v[0] || v[1]);
        sum += 1 - edges + faces - static_cast<int>(v[0]);
      }
    }
  }
  return sum;
}

}  // namespace

MaskShape measure_shape(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  if (inside.size() != geometry.voxel_count())
    fail("expected a mask of ", geometry.voxel_count(), " voxels, found ", inside.size());
  const PaddedMask mask = padded(inside, geometry);
  MaskShape shape;
  if (mask.inside.empty()) return shape;
  constexpr int kByCorners = 3, kByFaces = 1;
  const std::vector<std::size_t> pieces = parts_of(mask, 1, kByCorners);
  // The padding is of the outside and holds the first voxel; the others are hollows.
  const std::vector<std::size_t> outsides = parts_of(mask, 0, kByFaces);
  const std::size_t count = std::accumulate(pieces.begin(), pieces.end(), std::size_t{0});
  const std::size_t hollow = mask.inside.size() - count - outsides.front();
  shape.pieces = pieces.size();
  shape.largest_share =
      static_cast<double>(*std::max_element(pieces.begin(), pieces.end())) / static_cast<double>(count);
  shape.hollow_share = static_cast<double>(hollow) / static_cast<double>(count);
  shape.handles = static_cast<long>(pieces.size()) + static_cast<long>(outsides.size()) - 1 - euler_number(mask);
  std::vector<std::uint8_t> outside(mask.inside.size());
  std::transform(mask.inside.begin(), mask.inside.end(), outside.begin(),
                 [](std::uint8_t voxel) { return static_cast<std::uint8_t>(voxel == 0 ? 1 : 0); });
  const std::vector<float> squared_mm2 = squared_distance_to(outside, mask.geometry);
  shape.depth_mm = std::sqrt(static_cast<double>(*std::max_element(squared_mm2.begin(), squared_mm2.end())));
  return shape;
}

std::vector<LevelWarning> check_shape(const MaskShape& shape, bool is_whole_vertebra) {
  constexpr double kSevere = 0.9, kNote = 0.3, kMin = 0.1;
  std::vector<LevelWarning> warnings;
  if (shape.pieces == 0) return warnings;
  const auto add = [&](double severity, std::string text) {
    if (severity >= kMin) warnings.push_back({std::move(text), severity, std::nullopt});
  };
  const auto percent = [](double share) { return fixed_text(100.0 * share, 0) + " %"; };
  add(kSevere * ramp(1.0 - shape.largest_share, 0.02, 0.15),
      joined("it is in ", shape.pieces, " pieces, the largest holds ", percent(shape.largest_share), " of it"));
  add(kSevere * ramp(shape.hollow_share, 0.02, 0.1), joined("it encloses hollows of ", percent(shape.hollow_share),
                                                            " of its own volume: what is inside bone may be missing"));
  const long extra = shape.handles - 1;  // right ones in thin or coarse voxels have up to 7
  add(kSevere * ramp(static_cast<double>(extra), 8.0, 20.0),
      joined(shape.handles, " holes go through it, expected one, the canal: bone of low density may be missing"));
  add(kSevere * ramp(-shape.depth_mm, -4.0, -3.0), joined("nowhere is it deeper than ", fixed_text(shape.depth_mm, 1),
                                                          " mm, expected 4 mm and more: it may be a shell, or a part"));
  if (is_whole_vertebra && shape.handles < 1)
    add(kNote, "no ring of bone closes round the canal: part of the arch may be missing");
  return warnings;
}

}  // namespace spinaltap
