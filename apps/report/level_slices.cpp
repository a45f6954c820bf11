#include "apps/report/level_slices.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "apps/report/slice_marks.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr HuWindow kLevelWindow{1200.0, 400.0};  // -200 to 1,000 HU: cancellous bone and walls both apart
constexpr Colour kOtherLabels{150, 150, 150};
constexpr double kOverviewRoomMm = 10.0;
constexpr double kLevelRoomMm = 8.0;
constexpr double kMaxOverviewPixels = 900.0;
constexpr double kMaxSlicePixels = 600.0;

/// The box around each label's voxels, patient LPS.
std::map<int, Box3> label_boxes(const LabelVolume& labels) {
  struct Voxels {
    std::array<int, 3> low;
    std::array<int, 3> high{-1, -1, -1};
  };
  const GridGeometry& grid = labels.geometry;
  std::array<Voxels, 256> found{};
  for (Voxels& voxels : found) voxels.low = grid.size;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      const std::uint8_t* row = labels.labels.data() + grid.offset(0, j, k);
      for (int i = 0; i < grid.size[0]; ++i) {
        if (row[i] == 0) continue;
        Voxels& voxels = found[row[i]];
        const std::array<int, 3> v{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          voxels.low[axis] = std::min(voxels.low[axis], v[axis]);
          voxels.high[axis] = std::max(voxels.high[axis], v[axis]);
        }
      }
    }
  }
  std::map<int, Box3> boxes;
  for (std::size_t label = 1; label < found.size(); ++label) {
    const Voxels& voxels = found[label];
    if (voxels.high[0] < 0) continue;
    Box3 box;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const auto end = [&](std::size_t axis) {
        return (corner >> axis & 1U) != 0 ? voxels.high[axis] + 0.5 : voxels.low[axis] - 0.5;
      };
      box.extend(grid.to_patient(Vec3(end(0), end(1), end(2))));
    }
    boxes[static_cast<int>(label)] = box;
  }
  return boxes;
}

void check_grids(const CtVolume& ct, const LabelVolume& labels) {
  check_geometry(ct.geometry, "CT");
  const bool same = labels.geometry.size == ct.geometry.size &&
                    labels.geometry.to_patient(Vec3::Zero()).isApprox(ct.geometry.to_patient(Vec3::Zero()), 1e-3) &&
                    labels.geometry.index_to_patient_matrix().isApprox(ct.geometry.index_to_patient_matrix(), 1e-3);
  if (!same || labels.labels.size() != labels.geometry.voxel_count()) {
    fail("picture of levels: expected a label map on the CT's grid, found another");
  }
}

Vec3 clamped(const Vec3& p, const Box3& box) { return p.cwiseMax(box.min()).cwiseMin(box.max()); }

}  // namespace

Image framed(const LevelSlice& slice) {
  Image image{slice.image.width + 2 * kSliceBorder, slice.image.height + 2 * kSliceBorder, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  fill_rectangle(image, 0, 0, image.width, image.height, kPictureGround);
  paste(slice.image, image, kSliceBorder, kSliceBorder);
  const SliceFrame& plane = slice.frame.plane;
  draw_side_letters(image, {0, 0, image.width, image.height}, plane.right, plane.down, 2, kWhite);
  // Its left end stands under the slice's.
  draw_scale_bar(image, {kSliceBorder - 6, 0, slice.image.width, image.height}, plane.pixel_mm);
  return image;
}

LevelSlices::LevelSlices(const CtVolume& ct, const LabelVolume& labels, const LevelsPicture& what)
    : ct_(ct), labels_(labels), what_(what), levels_(what.levels) {
  check_grids(ct, labels);
  if (!(what.pixel_mm >= 0.05 && what.pixel_mm <= 10.0)) {
    fail("picture of levels: expected pixels of 0.05 to 10 mm, found ", what.pixel_mm);
  }
  if (levels_.empty()) fail("picture of levels: expected a level or more, found none");
  if (what.seed_mm && !what.seed_mm->allFinite()) fail("picture of levels: the seed's position is not finite");
  boxes_mm_ = label_boxes(labels);
  if (boxes_mm_.empty()) fail("picture of levels: expected a label map with voxels in it, found an empty one");
  std::set<int> seen;
  for (const PictureLevel& level : levels_) {
    if (!boxes_mm_.contains(level.label)) fail("picture of levels: no voxel has label ", level.label);
    if (!level.centre_mm.allFinite()) fail("picture of levels: the centre of label ", level.label, " is not finite");
    if (!seen.insert(level.label).second) fail("picture of levels: label ", level.label, " is given twice");
  }
  if (what.chosen && !seen.contains(*what.chosen)) {
    fail("picture of levels: the chosen label ", *what.chosen, " is none of the levels");
  }
  std::sort(levels_.begin(), levels_.end(), [](const PictureLevel& a, const PictureLevel& b) {
    return a.centre_mm.z() != b.centre_mm.z() ? a.centre_mm.z() > b.centre_mm.z() : a.label < b.label;
  });
}

std::string LevelSlices::title(const PictureLevel& level) const {
  const auto found = labels_.names.find(level.label);
  const bool named = found != labels_.names.end() && !found->second.name.empty();
  const std::string title = upper_case(named ? found->second.name : "label " + std::to_string(level.label));
  return level.suspect ? title + " ?" : title;
}

Colour level_colour(std::size_t n) {
  constexpr std::array<Colour, 6> kCycle{{{0x56, 0xB4, 0xE9},
                                          {0xE6, 0x9F, 0x00},
                                          {0x00, 0x9E, 0x73},
                                          {0xF0, 0xE4, 0x42},
                                          {0xCC, 0x79, 0xA7},
                                          {0xD5, 0x5E, 0x00}}};
  return kCycle[n % kCycle.size()];
}

Colour LevelSlices::colour(const PictureLevel& level) const {
  const auto found = std::find_if(levels_.begin(), levels_.end(),
                                  [&](const PictureLevel& other) { return other.label == level.label; });
  return level_colour(static_cast<std::size_t>(found - levels_.begin()));
}

LabelPixels LevelSlices::pixels_of(const BentFrame& frame) const {
  return {frame.plane.width, frame.plane.height, labels_on(labels_, frame)};
}

Image LevelSlices::draw(const BentFrame& frame) const {
  Image image = bent_slice(ct_, frame, kLevelWindow, kPictureGround);
  const LabelPixels pixels = pixels_of(frame);
  for (const auto& [label, box] : boxes_mm_) {
    const auto level = std::find_if(levels_.begin(), levels_.end(),
                                    [wanted = label](const PictureLevel& one) { return one.label == wanted; });
    const bool known = level != levels_.end();
    draw_label_outline(image, pixels, label, known ? colour(*level) : kOtherLabels, known && level->suspect);
  }
  return image;
}

void LevelSlices::draw_seed(LevelSlice& slice, double max_depth_mm) const {
  if (!what_.seed_mm) return;
  const Vec3 p = slice.frame.to_pixel(*what_.seed_mm);
  const double far = 1e6;
  if (!(std::abs(p.z()) * slice.frame.plane.pixel_mm <= max_depth_mm) || !(p.head<2>().cwiseAbs().maxCoeff() < far)) {
    return;
  }
  draw_cross(slice.image, static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
}

/// For the longest name and some air.
double LevelSlices::room_for_names_mm(double pixel_mm) const {
  int width = 0;
  for (const PictureLevel& level : levels_) width = std::max(width, pixel_text_width(title(level), 2));
  return (width + 12) * pixel_mm;
}

LevelSlice LevelSlices::overview(Plane plane) const {
  if (plane == Plane::kAxial) fail("picture of levels: an overview is sagittal or coronal");
  Box3 box;
  std::vector<Vec3> centres;
  for (const PictureLevel& level : levels_) {
    box.extend(boxes_mm_.at(level.label));
    centres.push_back(level.centre_mm);
  }
  Vec3 low = box.min() - Vec3::Constant(kOverviewRoomMm);
  Vec3 high = box.max() + Vec3::Constant(kOverviewRoomMm);
  const double pixel_mm = std::max(what_.pixel_mm, (high - low).maxCoeff() / kMaxOverviewPixels);
  // Names stand before the bodies and to their left, in the picture's left and right.
  if (plane == Plane::kSagittal) low.y() = box.min().y() - room_for_names_mm(pixel_mm);
  if (plane == Plane::kCoronal) high.x() = box.max().x() + room_for_names_mm(pixel_mm);
  const SliceFrame frame = plane_frame(plane, box.center(), Box3(low, high), pixel_mm);
  LevelSlice slice{{}, bent_through(frame, centres), plane == Plane::kSagittal ? "SAGITTAL" : "CORONAL"};
  if (levels_.size() > 1) slice.caption += " ALONG THE COLUMN";
  slice.image = draw(slice.frame);
  draw_names(slice, pixels_of(slice.frame), plane);
  draw_seed(slice, 1e6);
  return slice;
}

/// Where no level's bone lies in the rows of the letters, so that no outline is hidden.
void LevelSlices::draw_names(LevelSlice& slice, const LabelPixels& pixels, Plane plane) const {
  std::vector<int> rows;
  int closest = slice.image.height;
  for (const PictureLevel& level : levels_) {
    const Vec3 centre_mm = clamped(level.centre_mm, boxes_mm_.at(level.label));
    rows.push_back(static_cast<int>(std::lround(slice.frame.to_pixel(centre_mm).y())));
    if (rows.size() > 1) closest = std::min(closest, std::abs(rows.back() - rows[rows.size() - 2]));
  }
  const int scale = closest >= 2 * kTextHeight + 3 ? 2 : 1;
  const int half = kTextHeight * scale / 2 + 1;
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const int row = std::clamp(rows[n], half, std::max(half, slice.image.height - 1 - half));
    const std::string name = title(levels_[n]);
    const int centre = static_cast<int>(std::lround(slice.frame.to_pixel(levels_[n].centre_mm).x()));
    int left = std::clamp(centre, 0, slice.image.width - 1);
    int right = left;
    for (int y = std::max(0, row - half); y <= std::min(slice.image.height - 1, row + half); ++y) {
      for (int x = 0; x < slice.image.width; ++x) {
        if (pixels.at(x, y) <= 0) continue;
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
    const int x = plane == Plane::kSagittal ? left - 6 - pixel_text_width(name, scale) : right + 7;
    draw_text(slice.image, x, row - kTextHeight * scale / 2, name, scale, colour(levels_[n]));
  }
}

LevelSlice LevelSlices::level_slice(Plane plane, const PictureLevel& level, double pixel_mm) const {
  const Box3& bone = boxes_mm_.at(level.label);
  const Box3 box(bone.min() - Vec3::Constant(kLevelRoomMm), bone.max() + Vec3::Constant(kLevelRoomMm));
  // A body that the CT's border cuts may have its centre beyond it.
  const Vec3 through_mm = clamped(level.centre_mm, bone);
  pixel_mm = std::max(pixel_mm, box.sizes().maxCoeff() / kMaxSlicePixels);
  LevelSlice slice{{}, flat(plane_frame(plane, through_mm, box, pixel_mm)), {}};
  slice.image = draw(slice.frame);
  draw_seed(slice, 5.0);
  const int axis = plane == Plane::kSagittal ? 0 : plane == Plane::kCoronal ? 1 : 2;
  const char* name = plane == Plane::kSagittal ? "SAGITTAL X" : plane == Plane::kCoronal ? "CORONAL Y" : "AXIAL Z";
  slice.caption = std::string(name) + " " + fixed_text(through_mm[axis], 1) + " MM";
  return slice;
}

}  // namespace spinaltap
