#pragma once

#include "core/base/image.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct MaskPictureOptions {
  double margin_mm = 15.0;  ///< shown around the mask
  double pixel_mm = 0.3;
};

/// Axial, sagittal and coronal slices of a CT through a point (patient LPS, mm), side by side, cropped to the mask and
/// a margin, with the mask's outline over them. Throws Error when the mask is empty or on another grid than the CT.
Image mask_picture(const CtVolume& ct, const BoneMask& mask, const Vec3& through_mm,
                   const MaskPictureOptions& options = {});

}  // namespace spinaltap
