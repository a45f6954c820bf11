#include "core/segment/mask_shape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/segment/detail/connected_parts.h"
#include "core/segment/detail/warning_list.h"
#include "core/segment/distance_transform.h"
#include "core/segment/float_grid.h"

namespace spinaltap {
namespace {

/// Corners - edges + faces - voxels of the closed voxels: each corner, edge and face counts once, by the voxels around
/// it. The mask does not touch the grid's border, so that all of them are met at some voxel's lowest corner.
long euler_number(const BoneMask& mask) {
  const std::array<int, 3>& size = mask.geometry.size;
  long sum = 0;
  for (int k = 1; k < size[2]; ++k) {
    for (int j = 1; j < size[1]; ++j) {
      for (int i = 1; i < size[0]; ++i) {
        std::array<bool, 8> v{};
        for (std::size_t n = 0; n < 8; ++n) {
          const int low = static_cast<int>(n);
          v[n] = mask.at(i - (low & 1), j - (low >> 1 & 1), k - (low >> 2));
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

MaskShape measure_shape(const BoneMask& whole) {
  if (whole.inside.size() != whole.geometry.voxel_count())
    fail("expected a mask of ", whole.geometry.voxel_count(), " voxels, found ", whole.inside.size());
  MaskShape shape;
  VoxelBox box = mask_box(whole);
  if (box.empty()) return shape;
  // With a voxel of outside all around.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    --box.low[axis];
    ++box.high[axis];
  }
  const FloatGrid grid = crop_mask(whole, box);
  BoneMask mask{grid.geometry, std::vector<std::uint8_t>(grid.values.size())};
  std::vector<std::uint8_t> outside(grid.values.size());
  for (std::size_t n = 0; n < grid.values.size(); ++n) {
    mask.inside[n] = grid.values[n] != 0.0F ? 1 : 0;
    outside[n] = grid.values[n] != 0.0F ? 0 : 1;
  }
  const std::vector<std::size_t> pieces = part_sizes(mask.inside, mask.geometry, Neighbours::by_corner);
  const std::size_t outsides = part_sizes(outside, mask.geometry).size();
  std::vector<std::uint8_t> first(outside.size(), 0);
  first[0] = 1;  // of the margin; what it does not reach is hollow
  const std::vector<std::uint8_t> reached = parts_that_touch(outside, first, mask.geometry);
  const auto voxels = [](const std::vector<std::uint8_t>& of) {
    return static_cast<double>(std::count(of.begin(), of.end(), std::uint8_t{1}));
  };
  const double count = voxels(mask.inside);
  shape.pieces = pieces.size();
  shape.largest_share = static_cast<double>(pieces.front()) / count;
  shape.hollow_share = (voxels(outside) - voxels(reached)) / count;
  const std::size_t hollows = outsides - 1;
  shape.handles = static_cast<long>(pieces.size() + hollows) - euler_number(mask);
  const std::vector<float> squared_mm2 = squared_distance_to(outside, mask.geometry);
  shape.depth_mm = std::sqrt(static_cast<double>(*std::max_element(squared_mm2.begin(), squared_mm2.end())));
  return shape;
}

std::vector<LevelWarning> check_shape(const MaskShape& shape, bool is_whole_vertebra) {
  constexpr double kSevere = 0.9, kNote = 0.3;
  WarningList warnings;
  if (shape.pieces == 0) return {};
  warnings.add(
      kSevere * ramp(1.0 - shape.largest_share, 0.02, 0.15),
      joined("it is in ", shape.pieces, " pieces, the largest holds ", percent_text(shape.largest_share), " of it"));
  warnings.add(kSevere * ramp(shape.hollow_share, 0.02, 0.1),
               joined("it encloses hollows of ", percent_text(shape.hollow_share),
                      " of its own volume: what is inside bone may be missing"));
  const long extra = shape.handles - 1;  // right ones in thin or coarse voxels have up to 7
  warnings.add(
      kSevere * ramp(static_cast<double>(extra), 8.0, 20.0),
      joined(shape.handles, " holes go through it, expected one, the canal: bone of low density may be missing"));
  warnings.add(kSevere * ramp(-shape.depth_mm, -4.0, -3.0),
               joined("nowhere is it deeper than ", fixed_text(shape.depth_mm, 1),
                      " mm, expected 4 mm and more: it may be a shell, or a part"));
  if (is_whole_vertebra && shape.handles < 1)
    warnings.add(kNote, "no ring of bone closes round the canal: part of the arch may be missing");
  return warnings.take();
}

}  // namespace spinaltap
