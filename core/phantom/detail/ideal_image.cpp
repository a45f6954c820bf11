#include "core/phantom/detail/ideal_image.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace spinaltap {

IdealImage::IdealImage(const Solid& solid, const GridGeometry& geometry, const ScanOptions& options,
                       const Surroundings* surroundings)
    : solid_(solid), options_(options), surroundings_(surroundings) {
  const double samples = options.samples_per_pixel;
  step_mm_ =
      Vec3(options.pixel_mm / samples, options.pixel_mm / samples, options.slice_step_mm / options.samples_per_step);
  const double back = 0.5 * (samples - 1.0) / samples * options.pixel_mm;
  origin_mm_ = geometry.origin_mm - Vec3(back, back, 0.0);
  cell_mm_ = std::cbrt(step_mm_.prod());
  const Box3 bounds = solid.bounds_mm();
  const std::array<int, 2> max{options.columns * options.samples_per_pixel, options.rows * options.samples_per_pixel};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double low = (bounds.min()[i] - cell_mm_ - origin_mm_[i]) / step_mm_[i];
    const double high = (bounds.max()[i] + cell_mm_ - origin_mm_[i]) / step_mm_[i];
    first_[axis] = static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(max[axis])));
    size_[axis] =
        static_cast<int>(std::clamp(std::ceil(high) + 1.0, 0.0, static_cast<double>(max[axis]))) - first_[axis];
    size_[axis] = std::max(size_[axis], 0);
  }
}

Vec3 IdealImage::position_mm(double column, double row, double plane) const {
  return origin_mm_ + Vec3(first_[0] + column, first_[1] + row, plane).cwiseProduct(step_mm_);
}

std::size_t IdealImage::offset(int column, int row, int plane) const {
  return (static_cast<std::size_t>(plane - held_begin_) * static_cast<std::size_t>(size_[1]) +
          static_cast<std::size_t>(row)) *
             static_cast<std::size_t>(size_[0]) +
         static_cast<std::size_t>(column);
}

std::span<const float> IdealImage::plane(int index) const {
  return std::span(values_).subspan(offset(0, 0, index),
                                    static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]));
}

void IdealImage::hold(int begin, int end) {
  const std::size_t plane_size = static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]);
  std::vector<float> values(plane_size * static_cast<std::size_t>(end - begin), 0.0F);
  int fresh = begin;
  if (begin >= held_begin_ && begin < held_end_) {
    fresh = std::min(held_end_, end);
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(offset(0, 0, begin)),
                plane_size * static_cast<std::size_t>(fresh - begin), values.begin());
  }
  values_ = std::move(values);
  held_begin_ = begin;
  held_end_ = end;
  constexpr int kTile = 32;
  const int across = (size_[0] + kTile - 1) / kTile, down = (size_[1] + kTile - 1) / kTile;
  if (fresh >= end) return;
  tbb::parallel_for(0, across * down, [&](int tile) {
    const int column = tile % across * kTile, row = tile / across * kTile;
    fill({{column, row, fresh}, {std::min(column + kTile, size_[0]), std::min(row + kTile, size_[1]), end}});
  });
}

/// Leaves blocks that the solid cannot reach at 0, halves those that it may, and samples small ones.
void IdealImage::fill(const Block& block) {
  constexpr int kSmall = 4;
  const std::array<int, 3> size{block.high[0] - block.low[0], block.high[1] - block.low[1],
                                block.high[2] - block.low[2]};
  const auto longest = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const Vec3 centre = position_mm(0.5 * (block.low[0] + block.high[0] - 1), 0.5 * (block.low[1] + block.high[1] - 1),
                                  0.5 * (block.low[2] + block.high[2] - 1));
  const double half_diagonal = 0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1).cwiseProduct(step_mm_).norm();
  double distance = 0.0;
  solid_.evaluate({&centre, 1}, {&distance, 1}, {});
  if (distance > half_diagonal + 0.5 * cell_mm_) return;
  const bool whole_inside = distance < -(half_diagonal + 0.5 * cell_mm_);
  if (!whole_inside && size[longest] > kSmall) {
    Block first = block, second = block;
    first.high[longest] = second.low[longest] = block.low[longest] + size[longest] / 2;
    fill(first);
    fill(second);
    return;
  }
  std::vector<Vec3> points(static_cast<std::size_t>(size[0]));
  std::vector<double> distances(points.size());
  for (int plane = block.low[2]; plane < block.high[2]; ++plane) {
    for (int row = block.low[1]; row < block.high[1]; ++row) {
      for (std::size_t n = 0; n < points.size(); ++n) {
        points[n] = position_mm(block.low[0] + static_cast<int>(n), row, plane);
      }
      solid_.evaluate(points, distances, {});
      float* out = &values_[offset(block.low[0], row, plane)];
      for (std::size_t n = 0; n < points.size(); ++n) {
        const double covered = std::clamp(0.5 - distances[n] / cell_mm_, 0.0, 1.0);
        if (covered <= 0.0) continue;
        const double own = solid_.hu(points[n], distances[n], cell_mm_);
        const double around = surroundings_ == nullptr ? options_.surroundings_hu : surroundings_->hu(points[n]);
        out[n] = static_cast<float>(covered * (own - around));
      }
    }
  }
}

}  // namespace spinaltap
