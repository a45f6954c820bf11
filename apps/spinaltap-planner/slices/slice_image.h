#pragma once

#include <QImage>
#include <memory>

#include "apps/report/slice_frame.h"
#include "apps/spinaltap-planner/opened_bone.h"

namespace spinaltap {

/// The grey picture of a slice, made anew only where CT, place or window differ from the last: what lies over it can be
/// drawn again cheaply.
class SliceImage {
 public:
  /// One pixel per pixel of `frame`.
  const QImage& of(const std::shared_ptr<const OpenedBone>& bone, const SliceFrame& frame, const HuWindow& window);

 private:
  std::shared_ptr<const OpenedBone> bone_;
  HuWindow window_;
  CtSlice slice_;
  QImage image_;  ///< looks at the pixels of slice_
};

}  // namespace spinaltap
