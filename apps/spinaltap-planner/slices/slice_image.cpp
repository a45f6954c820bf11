#include "apps/spinaltap-planner/slices/slice_image.h"

namespace spinaltap {
namespace {

bool is_same_frame(const SliceFrame& a, const SliceFrame& b) {
  return a.origin_mm == b.origin_mm && a.right == b.right && a.down == b.down && a.pixel_mm == b.pixel_mm &&
         a.width == b.width && a.height == b.height;
}

}  // namespace

const QImage& SliceImage::of(const std::shared_ptr<const OpenedBone>& bone, const SliceFrame& frame,
                             const HuWindow& window) {
  const bool is_same_window = window.width_hu == window_.width_hu && window.level_hu == window_.level_hu;
  if (bone == bone_ && is_same_window && is_same_frame(frame, slice_.frame)) return image_;
  bone_ = bone;
  window_ = window;
  slice_ = ct_slice(bone->ct, frame, window);
  image_ = QImage(slice_.image.rgb.data(), frame.width, frame.height, 3 * frame.width, QImage::Format_RGB888);
  return image_;
}

}  // namespace spinaltap
