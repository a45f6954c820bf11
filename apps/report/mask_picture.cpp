#include "apps/report/mask_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/ct_slice.h"
#include "core/base/error.h"
#include "core/segment/float_grid.h"

namespace spinaltap {
namespace {

constexpr int kSliceGap = 6;  // pixels between the slices

Box3 box_of(const BoneMask& mask, double margin_mm) {
  const VoxelBox voxels = mask_box(mask);
  if (voxels.empty()) fail("picture: expected a mask with voxels in it, found an empty one");
  Box3 box;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](std::size_t axis) { return (corner >> axis) & 1 ? voxels.high[axis] : voxels.low[axis]; };
    box.extend(mask.geometry.to_patient(Vec3(end(0), end(1), end(2))));
  }
  return {box.min() - Vec3::Constant(margin_mm), box.max() + Vec3::Constant(margin_mm)};
}

bool in_mask(const BoneMask& mask, const Vec3& p_patient) {
  const Eigen::Array3d p = mask.geometry.to_index(p_patient).array().round();
  const auto index = [&](int axis) { return static_cast<int>(std::clamp(p[axis], -1.0, 1e6)); };
  return mask.geometry.contains(index(0), index(1), index(2)) && mask.at(index(0), index(1), index(2));
}

/// Colours the pixels within the mask that have a neighbour outside it.
void draw_outline(CtSlice& slice, const BoneMask& mask) {
  constexpr std::array<std::uint8_t, 3> kColour{0xF0, 0xE4, 0x42};  // Okabe & Ito's yellow
  const int width = slice.frame.width;
  const int height = slice.frame.height;
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto at = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  };
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      inside[at(column, row)] = in_mask(mask, slice.frame.to_patient(Vec3(column, row, 0.0))) ? 1 : 0;
    }
  }
  for (int row = 1; row + 1 < height; ++row) {
    for (int column = 1; column + 1 < width; ++column) {
      const bool rim =
          inside[at(column, row)] != 0 && (inside[at(column - 1, row)] == 0 || inside[at(column + 1, row)] == 0 ||
                                           inside[at(column, row - 1)] == 0 || inside[at(column, row + 1)] == 0);
      if (rim)
        std::copy(kColour.begin(), kColour.end(), slice.image.rgb.begin() + 3 * static_cast<long>(at(column, row)));
    }
  }
}

}  // namespace

Image mask_picture(const CtVolume& ct, const BoneMask& mask, const Vec3& through_mm,
                   const MaskPictureOptions& options) {
  if (mask.geometry.size != ct.geometry.size) fail("picture: expected a mask on the CT's grid, found another");
  const Box3 box_mm = box_of(mask, options.margin_mm);
  std::vector<CtSlice> slices;
  for (const Plane plane : {Plane::kAxial, Plane::kSagittal, Plane::kCoronal}) {
    slices.push_back(ct_slice(ct, plane_frame(plane, through_mm, box_mm, options.pixel_mm)));
    draw_outline(slices.back(), mask);
  }
  Image picture;
  for (const CtSlice& slice : slices) {
    picture.width += slice.image.width + (picture.width > 0 ? kSliceGap : 0);
    picture.height = std::max(picture.height, slice.image.height);
  }
  picture.rgb.assign(3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), 0);
  int left = 0;
  for (const CtSlice& slice : slices) {
    for (int row = 0; row < slice.image.height; ++row) {
      std::copy_n(slice.image.rgb.begin() + 3L * row * slice.image.width, 3L * slice.image.width,
                  picture.rgb.begin() + 3L * (static_cast<long>(row) * picture.width + left));
    }
    left += slice.image.width + kSliceGap;
  }
  return picture;
}

}  // namespace spinaltap
