#include "apps/report/slice_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kMaxPixels = 4096.0;

struct Axes {
  Vec3 right;
  Vec3 down;
};

Axes standard_axes(Plane plane) {
  switch (plane) {
    case Plane::kAxial:
      return {Vec3::UnitX(), Vec3::UnitY()};
    case Plane::kCoronal:
      return {Vec3::UnitX(), -Vec3::UnitZ()};
    case Plane::kSagittal:
      return {Vec3::UnitY(), -Vec3::UnitZ()};
  }
  fail("unknown plane");
}

void check_crop(const Box3& crop_mm, double pixel_mm) {
  if (!(pixel_mm > 0.0)) fail("CT slice: expected pixels above 0 mm, found ", pixel_mm);
  if (crop_mm.isEmpty() || !crop_mm.min().allFinite() || !crop_mm.max().allFinite()) {
    fail("CT slice: expected a box to crop to, found an empty or infinite one");
  }
}

/// The frame of a plane that shows all `points_mm`, projected onto it.
SliceFrame frame_around(const Axes& axes, const Vec3& through_mm, const std::vector<Vec3>& points_mm, double pixel_mm) {
  Eigen::AlignedBox2d extent_mm;
  for (const Vec3& p : points_mm) {
    const Vec3 offset = p - through_mm;
    extent_mm.extend(Eigen::Vector2d(offset.dot(axes.right), offset.dot(axes.down)));
  }
  const Eigen::Vector2d pixels = (extent_mm.sizes() / pixel_mm).array().ceil().max(1.0);
  if (!(pixels.maxCoeff() <= kMaxPixels)) {
    fail("CT slice: expected at most ", kMaxPixels, " pixels a side, found ", pixels.maxCoeff(), " (crop of ",
         extent_mm.sizes().maxCoeff(), " mm at ", pixel_mm, " mm a pixel)");
  }
  SliceFrame frame;
  frame.right = axes.right;
  frame.down = axes.down;
  frame.pixel_mm = pixel_mm;
  frame.width = static_cast<int>(pixels.x());
  frame.height = static_cast<int>(pixels.y());
  const Eigen::Vector2d first_mm = extent_mm.center() - 0.5 * pixel_mm * (pixels - Eigen::Vector2d::Ones());
  frame.origin_mm = through_mm + first_mm.x() * axes.right + first_mm.y() * axes.down;
  return frame;
}

std::vector<Vec3> corners(const Box3& box) {
  std::vector<Vec3> points;
  points.reserve(8);
  for (int i = 0; i < 8; ++i) points.push_back(box.corner(static_cast<Box3::CornerType>(i)));
  return points;
}

/// Corners of the polygon in which a plane cuts a box; empty where it misses.
std::vector<Vec3> cut_corners(const Box3& box, const Vec3& through_mm, const Vec3& normal) {
  const std::vector<Vec3> points = corners(box);
  std::vector<Vec3> cut;
  for (std::size_t a = 0; a < 8; ++a) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((a & bit) != 0) continue;
      const Vec3& p = points[a];
      const Vec3& q = points[a | bit];
      const double p_side = (p - through_mm).dot(normal);
      const double q_side = (q - through_mm).dot(normal);
      if (p_side * q_side > 0.0 || p_side == q_side) continue;
      cut.push_back(p + p_side / (p_side - q_side) * (q - p));
    }
  }
  return cut;
}

/// The standard plane whose normal is closest to `normal`, turned so that it holds the plane of `normal`.
Axes turned_axes(const Vec3& normal) {
  int strongest = 0;
  normal.cwiseAbs().maxCoeff(&strongest);
  constexpr std::array<Plane, 3> kPlaneAcross{Plane::kSagittal, Plane::kCoronal, Plane::kAxial};
  const Axes standard = standard_axes(kPlaneAcross[static_cast<std::size_t>(strongest)]);
  const Vec3 right = (standard.right - standard.right.dot(normal) * normal).normalized();
  const Vec3 down = normal.cross(right);
  return {right, down.dot(standard.down) < 0.0 ? Vec3(-down) : down};
}

}  // namespace

Vec3 SliceFrame::to_pixel(const Vec3& p_patient) const {
  const Vec3 offset = p_patient - origin_mm;
  return Vec3(offset.dot(right), offset.dot(down), offset.dot(into())) / pixel_mm;
}

Vec3 SliceFrame::to_patient(const Vec3& p_pixel) const {
  return origin_mm + pixel_mm * (p_pixel.x() * right + p_pixel.y() * down + p_pixel.z() * into());
}

SliceFrame plane_frame(Plane plane, const Vec3& through_mm, const Box3& crop_mm, double pixel_mm) {
  check_crop(crop_mm, pixel_mm);
  return frame_around(standard_axes(plane), through_mm, corners(crop_mm), pixel_mm);
}

SliceFrame path_frame(const DrillPath& path, const Box3& crop_mm, double pixel_mm) {
  check_crop(crop_mm, pixel_mm);
  const Vec3 direction = path.direction();
  const Vec3 tilt = Vec3::UnitZ() - direction.z() * direction;
  const bool along_body = tilt.norm() < 1e-6;
  const Vec3 normal = along_body ? Vec3::UnitX() : tilt.normalized();
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  std::vector<Vec3> shown = cut_corners(crop_mm, middle_mm, normal);
  if (shown.empty()) shown = corners(crop_mm);
  return frame_around(turned_axes(normal), middle_mm, shown, pixel_mm);
}

SliceFrame grown_to(const SliceFrame& frame, int width, int height) {
  SliceFrame grown = frame;
  const int left = std::max(0, width - frame.width) / 2;
  const int top = std::max(0, height - frame.height) / 2;
  grown.width = std::max(frame.width, width);
  grown.height = std::max(frame.height, height);
  grown.origin_mm = frame.to_patient(Vec3(-left, -top, 0.0));
  return grown;
}

std::string orientation_letters(const Vec3& direction) {
  constexpr std::array<const char*, 3> kPositive{"L", "P", "S"};
  constexpr std::array<const char*, 3> kNegative{"R", "A", "I"};
  const double threshold = 0.3827 * direction.norm();  // sin 22.5 degrees
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(direction[static_cast<Eigen::Index>(a)]) > std::abs(direction[static_cast<Eigen::Index>(b)]);
  });
  std::string letters;
  for (const std::size_t axis : order) {
    const double value = direction[static_cast<Eigen::Index>(axis)];
    if (std::abs(value) > threshold) letters += value > 0.0 ? kPositive[axis] : kNegative[axis];
  }
  return letters;
}

CtSlice ct_slice(const CtVolume& ct, const SliceFrame& frame, const HuWindow& window) {
  if (!(window.width_hu > 0.0)) fail("CT slice: expected a window wider than 0 HU, found ", window.width_hu);
  CtSlice slice{{frame.width, frame.height, {}}, frame};
  const auto width = static_cast<std::size_t>(frame.width);
  slice.image.rgb.resize(3 * width * static_cast<std::size_t>(frame.height));
  const double black_hu = window.level_hu - 0.5 * window.width_hu;
  const double outside_hu = black_hu;
  // From pixel to pixel, as GridGeometry::to_index() has it.
  const GridGeometry& grid = ct.geometry;
  const Mat3 to_grid = grid.spacing_mm.cwiseInverse().asDiagonal() * grid.directions.inverse();
  const Vec3 along_row = frame.pixel_mm * (to_grid * frame.right);
  const double grey_per_hu = 255.0 / window.width_hu;
  tbb::parallel_for(0, frame.height, [&](int row) {
    std::uint8_t* out = slice.image.rgb.data() + 3 * width * static_cast<std::size_t>(row);
    const Vec3 begin = grid.to_index(frame.to_patient(Vec3(0.0, row, 0.0)));
    for (int column = 0; column < frame.width; ++column, out += 3) {
      const double hu = sample_hu_at_index(ct, begin + column * along_row, outside_hu);
      // The half makes of cutting off rounding.
      const double grey = 0.5 + std::clamp(grey_per_hu * (hu - black_hu), 0.0, 255.0);
      std::fill_n(out, 3, static_cast<std::uint8_t>(grey));
    }
  });
  return slice;
}

}  // namespace spinaltap
