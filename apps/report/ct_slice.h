#pragma once

#include "apps/report/slice_frame.h"
#include "core/base/image.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Which HU are black and which white. The default is a bone window.
struct HuWindow {
  double width_hu = 1800.0;  ///< white minus black
  double level_hu = 500.0;   ///< mid-grey
};

/// A picture of a CT along a plane, with the mapping between its pixels and the patient.
struct CtSlice {
  Image image;  ///< grey, frame.width by frame.height
  SliceFrame frame;
};

/// The CT along the plane of `frame`, tri-linearly interpolated at the pixel centres, for a grid of any orientation.
/// Black outside the CT. Throws Error when the window's width is not above 0.
CtSlice ct_slice(const CtVolume& ct, const SliceFrame& frame, const HuWindow& window = {});

}  // namespace spinaltap
