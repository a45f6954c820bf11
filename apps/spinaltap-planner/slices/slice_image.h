#pragma once

#include <QColor>
#include <QImage>
#include <QString>
#include <memory>
#include <utility>
#include <vector>

#include "apps/report/slice_frame.h"
#include "apps/spinaltap-planner/opened_bone.h"

namespace spinaltap {

/// The name of a level in a slice.
struct SliceName {
  QString text;
  QColor colour;
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< where it ends, device pixels: to the left of the level's bone
};

/// What slices are made of: a bone alone is one.
struct SliceSource {
  SliceSource(std::shared_ptr<const OpenedBone> opened = nullptr,
              std::shared_ptr<const SpineSegmentation> outlined = nullptr)
      : bone(std::move(opened)), levels(std::move(outlined)) {}

  std::shared_ptr<const OpenedBone> bone;
  std::shared_ptr<const SpineSegmentation> levels;  ///< outlined; null: none

  bool operator==(const SliceSource&) const = default;
};

/// The grey picture of a slice with its levels' outlines, made anew only where CT, levels, place or window differ from
/// the last: what lies over it can be drawn again cheaply.
class SliceImage {
 public:
  /// One pixel per pixel of `frame`.
  const QImage& of(const SliceSource& source, const SliceFrame& frame, const HuWindow& window);
  /// Of the levels in it.
  const std::vector<SliceName>& names() const { return names_; }

 private:
  void draw_levels(const SpineSegmentation& levels);

  SliceSource source_;
  HuWindow window_;
  CtSlice slice_;
  std::vector<SliceName> names_;
  QImage image_;  ///< looks at the pixels of slice_
};

}  // namespace spinaltap
