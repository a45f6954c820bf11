#include "core/segment/float_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

std::vector<float> gaussian_kernel(double sigma_voxels) {
  const int reach = std::max(1, static_cast<int>(std::ceil(kBlurReach * sigma_voxels)));
  std::vector<double> kernel;
  kernel.reserve(2 * static_cast<std::size_t>(reach) + 1);
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    const double deviations = i / sigma_voxels;
    kernel.push_back(std::exp(-0.5 * deviations * deviations));
    sum += kernel.back();
  }
  std::vector<float> normalised;
  normalised.reserve(kernel.size());
  for (const double value : kernel) normalised.push_back(static_cast<float>(value / sum));
  return normalised;
}

/// Convolves every line of the grid along one axis.
void blur_axis(FloatGrid& grid, int axis, const std::vector<float>& kernel) {
  const auto& size = grid.geometry.size;
  const int length = size[static_cast<std::size_t>(axis)];
  const int reach = static_cast<int>(kernel.size() / 2);
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? grid.geometry.offset(0, 1, 0) : grid.geometry.offset(0, 0, 1);
  const int outer_axis = axis == 2 ? 1 : 2;
  const int inner_axis = axis == 0 ? 1 : 0;
  tbb::parallel_for(0, size[static_cast<std::size_t>(outer_axis)], [&](int outer) {
    std::vector<float> line(static_cast<std::size_t>(length) + 2 * static_cast<std::size_t>(reach));
    for (int inner = 0; inner < size[static_cast<std::size_t>(inner_axis)]; ++inner) {
      std::array<int, 3> first{0, 0, 0};
      first[static_cast<std::size_t>(outer_axis)] = outer;
      first[static_cast<std::size_t>(inner_axis)] = inner;
      float* const values = grid.values.data() + grid.geometry.offset(first[0], first[1], first[2]);
      for (int i = 0; i < length + 2 * reach; ++i) {
        line[static_cast<std::size_t>(i)] =
            values[static_cast<std::size_t>(std::clamp(i - reach, 0, length - 1)) * stride];
      }
      for (int i = 0; i < length; ++i) {
        float sum = 0.0F;
        for (std::size_t tap = 0; tap < kernel.size(); ++tap)
          sum += kernel[tap] * line[static_cast<std::size_t>(i) + tap];
        values[static_cast<std::size_t>(i) * stride] = sum;
      }
    }
  });
}

/// The part of a grid within a box. `read(i, j, k)` gives the value of a voxel that may lie beyond the grid.
template <class Read>
FloatGrid crop(const GridGeometry& geometry, const VoxelBox& box, const Read& read) {
  FloatGrid result{crop_geometry(geometry, box), {}};
  result.values.resize(result.geometry.voxel_count());
  const auto& size = result.geometry.size;
  tbb::parallel_for(0, size[2], [&](int k) {
    std::size_t next = result.geometry.offset(0, 0, k);
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) result.values[next++] = read(box.low[0] + i, box.low[1] + j, box.low[2] + k);
    }
  });
  return result;
}

}  // namespace

VoxelBox mask_box(const BoneMask& mask) {
  const auto& size = mask.geometry.size;
  VoxelBox box;
  box.low = size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (!mask.at(i, j, k)) continue;
        box.low = {std::min(box.low[0], i), std::min(box.low[1], j), std::min(box.low[2], k)};
        box.high = {std::max(box.high[0], i), std::max(box.high[1], j), std::max(box.high[2], k)};
      }
    }
  }
  return box;
}

VoxelBox grow_box(const VoxelBox& box, double margin_mm, const GridGeometry& geometry) {
  VoxelBox grown = box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int margin = static_cast<int>(std::ceil(margin_mm / geometry.spacing_mm[static_cast<Eigen::Index>(axis)]));
    grown.low[axis] = box.low[axis] - margin;
    grown.high[axis] = box.high[axis] + margin;
  }
  return grown;
}

GridGeometry crop_geometry(const GridGeometry& geometry, const VoxelBox& box) {
  if (box.empty()) fail("expected a box of at least one voxel, found an empty one");
  GridGeometry cropped = geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) cropped.size[axis] = box.high[axis] - box.low[axis] + 1;
  cropped.origin_mm = geometry.to_patient(Vec3(box.low[0], box.low[1], box.low[2]));
  return cropped;
}

FloatGrid crop_hu(const CtVolume& ct, const VoxelBox& box) {
  const auto& size = ct.geometry.size;
  return crop(ct.geometry, box, [&](int i, int j, int k) {
    return static_cast<float>(
        ct.at(std::clamp(i, 0, size[0] - 1), std::clamp(j, 0, size[1] - 1), std::clamp(k, 0, size[2] - 1)));
  });
}

FloatGrid crop_mask(const BoneMask& mask, const VoxelBox& box) {
  return crop(mask.geometry, box,
              [&](int i, int j, int k) { return mask.geometry.contains(i, j, k) && mask.at(i, j, k) ? 1.0F : 0.0F; });
}

FloatGrid gaussian_blur(const FloatGrid& grid, double sigma_mm) {
  constexpr double kMaxVoxels = 1000.0;
  if (!(sigma_mm > 0.0) || !(sigma_mm <= kMaxVoxels * grid.geometry.smallest_spacing_mm())) {
    fail("blur: expected a width above 0 and up to ", kMaxVoxels, " voxels, found ", sigma_mm, " mm");
  }
  FloatGrid result = grid;
  for (int axis = 0; axis < 3; ++axis) {
    blur_axis(result, axis, gaussian_kernel(sigma_mm / grid.geometry.spacing_mm[axis]));
  }
  return result;
}

double sample_clamped(const FloatGrid& grid, const Vec3& p_index) {
  const std::array<std::size_t, 3> strides{1, grid.geometry.offset(0, 1, 0), grid.geometry.offset(0, 0, 1)};
  std::size_t low = 0;
  std::array<std::size_t, 3> step{};  // to the higher voxel, none at the border
  Vec3 t;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const int last = grid.geometry.size[axis] - 1;
    const double p = std::clamp(p_index[a], 0.0, static_cast<double>(last));
    const int below = static_cast<int>(p);
    low += static_cast<std::size_t>(below) * strides[axis];
    step[axis] = below < last ? strides[axis] : 0;
    t[a] = p - below;
  }
  // Not std::lerp: its care for special cases takes most of the time of those who ask millions of times.
  const auto mix = [](double at_low, double at_high, double share) { return at_low + share * (at_high - at_low); };
  const float* const corner = grid.values.data() + low;
  const auto row = [&](std::size_t offset) {
    return mix(static_cast<double>(corner[offset]), static_cast<double>(corner[offset + step[0]]), t.x());
  };
  return mix(mix(row(0), row(step[1]), t.y()), mix(row(step[2]), row(step[1] + step[2]), t.y()), t.z());
}

}  // namespace spinaltap
