#include "apps/report/bent_slice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace spinaltap {
namespace {

/// From a picture's pixels to a grid's indices, row by row without a matrix for each pixel.
struct GridWalk {
  GridWalk(const GridGeometry& grid, const BentFrame& frame)
      : geometry(grid),
        bent(frame),
        along_row(frame.plane.pixel_mm *
                  (grid.spacing_mm.cwiseInverse().asDiagonal() * (grid.directions.inverse() * frame.plane.right))) {}

  /// The nearest voxel's offset for each column of a row, or -1.
  template <typename Use>
  void each(int row, const Use& use) const {
    const Vec3 begin = geometry.to_index(bent.to_patient(0, row));
    for (int column = 0; column < bent.plane.width; ++column) {
      const Eigen::Array3d p = (begin + column * along_row).array().round().max(-1.0).min(1e9);
      const std::array<int, 3> v{static_cast<int>(p.x()), static_cast<int>(p.y()), static_cast<int>(p.z())};
      const bool within = geometry.contains(v[0], v[1], v[2]);
      use(column, within ? static_cast<std::ptrdiff_t>(geometry.offset(v[0], v[1], v[2])) : -1);
    }
  }

  const GridGeometry& geometry;
  const BentFrame& bent;
  Vec3 along_row;
};

}  // namespace

Vec3 BentFrame::to_pixel(const Vec3& p_patient) const {
  Vec3 p = plane.to_pixel(p_patient);
  if (depth_mm.empty()) return p;
  const double row = std::clamp(std::round(p.y()), 0.0, static_cast<double>(depth_mm.size() - 1));
  p.z() -= depth_mm[static_cast<std::size_t>(row)] / plane.pixel_mm;
  return p;
}

Vec3 BentFrame::to_patient(int column, int row) const {
  return plane.to_patient(Vec3(column, row, depth_mm[static_cast<std::size_t>(row)] / plane.pixel_mm));
}

BentFrame flat(const SliceFrame& plane) {
  return {plane, std::vector<double>(static_cast<std::size_t>(plane.height), 0.0)};
}

BentFrame bent_through(const SliceFrame& plane, const std::vector<Vec3>& points_mm) {
  struct Knot {
    double row_mm;
    double depth_mm;
    double count;
  };
  std::vector<Knot> sorted;
  for (const Vec3& p : points_mm) {
    const Vec3 pixel = plane.to_pixel(p) * plane.pixel_mm;
    sorted.push_back({pixel.y(), pixel.z(), 1.0});
  }
  std::sort(sorted.begin(), sorted.end(), [](const Knot& a, const Knot& b) {
    return a.row_mm != b.row_mm ? a.row_mm < b.row_mm : a.depth_mm < b.depth_mm;
  });
  std::vector<Knot> knots;
  for (const Knot& next : sorted) {
    if (!knots.empty() && next.row_mm - knots.back().row_mm < 1.0) {
      Knot& last = knots.back();
      const double count = last.count + 1.0;
      last = {(last.row_mm * last.count + next.row_mm) / count, (last.depth_mm * last.count + next.depth_mm) / count,
              count};
    } else {
      knots.push_back(next);
    }
  }
  BentFrame frame = flat(plane);
  for (int row = 0; row < plane.height && !knots.empty(); ++row) {
    const double row_mm = row * plane.pixel_mm;
    const auto after = std::find_if(knots.begin(), knots.end(), [&](const Knot& knot) { return knot.row_mm > row_mm; });
    double& depth = frame.depth_mm[static_cast<std::size_t>(row)];
    if (after == knots.begin()) {
      depth = knots.front().depth_mm;
    } else if (after == knots.end()) {
      depth = knots.back().depth_mm;
    } else {
      const Knot& before = *(after - 1);
      const double t = (row_mm - before.row_mm) / (after->row_mm - before.row_mm);
      depth = before.depth_mm + t * (after->depth_mm - before.depth_mm);
    }
  }
  return frame;
}

Image bent_slice(const CtVolume& ct, const BentFrame& frame, const HuWindow& window, const Colour& outside) {
  const int width = frame.plane.width;
  Image image{width, frame.plane.height, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height));
  const GridWalk walk(ct.geometry, frame);
  tbb::parallel_for(0, image.height, [&](int row) {
    SliceFrame line = frame.plane;
    line.origin_mm = frame.to_patient(0, row);
    line.height = 1;
    paste(ct_slice(ct, line, window).image, image, 0, row);
    walk.each(row, [&](int column, std::ptrdiff_t voxel) {
      if (voxel < 0) fill_rectangle(image, column, row, 1, 1, outside);
    });
  });
  return image;
}

std::vector<int> labels_on(const LabelVolume& labels, const BentFrame& frame) {
  const auto width = static_cast<std::size_t>(frame.plane.width);
  std::vector<int> on(width * static_cast<std::size_t>(frame.plane.height));
  const GridWalk walk(labels.geometry, frame);
  tbb::parallel_for(0, frame.plane.height, [&](int row) {
    walk.each(row, [&](int column, std::ptrdiff_t voxel) {
      on[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)] =
          voxel < 0 ? -1 : labels.labels[static_cast<std::size_t>(voxel)];
    });
  });
  return on;
}

}  // namespace spinaltap
