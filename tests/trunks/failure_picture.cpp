#include "tests/trunks/failure_picture.h"

#include <algorithm>

#include "apps/report/label_outline.h"
#include "apps/report/slice_frame.h"
#include "apps/report/slice_marks.h"

namespace spinaltap::test {
namespace {

constexpr double kPixelMm = 0.4, kMarginMm = 14.0;
constexpr int kGap = 6;
constexpr Colour kTruth{86, 180, 233}, kFound{230, 159, 0};

/// The pixels of a slice that carry one label.
LabelPixels pixels_of(const LabelVolume& labels, int label, const SliceFrame& frame) {
  LabelPixels pixels{frame.width, frame.height, {}};
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const Vec3 at = labels.geometry.to_index(frame.to_patient(Vec3(column, row, 0.0)));
      const Eigen::Vector3i voxel = at.array().round().cast<int>();
      const bool is_there = labels.geometry.contains(voxel.x(), voxel.y(), voxel.z()) &&
                            labels.labels[labels.geometry.offset(voxel.x(), voxel.y(), voxel.z())] == label;
      pixels.labels.push_back(is_there ? 1 : 0);
    }
  }
  return pixels;
}

/// Around a label's voxels, patient LPS, and their mean.
struct LabelPlace {
  Box3 box_mm;
  Vec3 middle_mm = Vec3::Zero();
};
LabelPlace place_of(const LabelVolume& labels, int label) {
  LabelPlace place;
  const auto& size = labels.geometry.size;
  std::size_t voxel = 0, count = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++voxel) {
        if (labels.labels[voxel] != label) continue;
        const Vec3 p_mm = labels.geometry.to_patient(Vec3(i, j, k));
        place.box_mm.extend(p_mm);
        place.middle_mm += p_mm;
        ++count;
      }
    }
  }
  place.middle_mm /= static_cast<double>(std::max<std::size_t>(1, count));
  return place;
}

}  // namespace

Image failure_picture(const TrunkExam& exam, const WholeLevelScore& level) {
  const int truth = static_cast<int>(level.level);
  const LabelPlace place = place_of(exam.ground_truth, truth);
  const Box3 crop_mm(place.box_mm.min() - Vec3::Constant(kMarginMm), place.box_mm.max() + Vec3::Constant(kMarginMm));
  std::vector<Image> slices;
  Image whole;
  for (const Plane plane : {Plane::kAxial, Plane::kCoronal, Plane::kSagittal}) {
    // The body's middle lies in front of the vertebra's.
    constexpr double kForwardMm = 18.0;
    const Vec3 through_mm = place.middle_mm - Vec3(0.0, plane == Plane::kCoronal ? kForwardMm : 0.0, 0.0);
    CtSlice slice = ct_slice(exam.ct, plane_frame(plane, through_mm, crop_mm, kPixelMm));
    draw_label_outline(slice.image, pixels_of(exam.ground_truth, truth, slice.frame), 1, kTruth, false);
    if (level.found) {
      const int label = exam.report_of(level).label;
      draw_label_outline(slice.image, pixels_of(exam.found.labels, label, slice.frame), 1, kFound, true);
    }
    whole.width += slice.image.width + (slices.empty() ? 0 : kGap);
    whole.height = std::max(whole.height, slice.image.height);
    slices.push_back(std::move(slice.image));
  }
  whole.rgb.assign(3 * static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(whole.height), 0);
  int x = 0;
  for (const Image& slice : slices) {
    paste(slice, whole, x, 0);
    x += slice.width + kGap;
  }
  return whole;
}

Image captioned(const std::vector<std::pair<Image, std::string>>& pictures) {
  constexpr int kScale = 2, kLine = kScale * kTextHeight + 6;
  Image sheet;
  for (const auto& [picture, caption] : pictures) {
    sheet.width = std::max({sheet.width, picture.width, pixel_text_width(caption, kScale) + 8});
    sheet.height += kLine + picture.height + kGap;
  }
  sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 0);
  int y = 0;
  for (const auto& [picture, caption] : pictures) {
    draw_text(sheet, 4, y + 3, caption, kScale, kWhite);
    paste(picture, sheet, 0, y + kLine);
    y += kLine + picture.height + kGap;
  }
  return sheet;
}

}  // namespace spinaltap::test
