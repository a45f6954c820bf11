#include "core/ct/detail/slice_stack.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr float kAir = -1024.0F;
constexpr double kOnGrid = 1e-6;  // of a step: nearer than this is there

/// Values at i + fraction from those at i - 1, i, i + 1 and i + 2.
struct CubicWeights {
  int whole = 0;
  std::array<float, 4> weights{0.0F, 1.0F, 0.0F, 0.0F};

  /// Of reading at index n - shift, for every n.
  explicit CubicWeights(double shift) {
    double t = -shift - std::floor(-shift);
    whole = static_cast<int>(std::floor(-shift));
    if (t > 1.0 - kOnGrid) {
      t = 0.0;
      ++whole;
    }
    if (t < kOnGrid) return;
    weights = {static_cast<float>(t * (-0.5 + t * (1.0 - 0.5 * t))), static_cast<float>(1.0 + t * t * (1.5 * t - 2.5)),
               static_cast<float>(t * (0.5 + t * (2.0 - 1.5 * t))), static_cast<float>(t * t * (0.5 * t - 0.5))};
  }
  bool is_copy() const { return weights[1] == 1.0F; }
};

/// Applies weights to a line of `count` values at `stride`. Beyond the line is air; the border's own value goes on for
/// the outer taps of values within the line.
void shift_line(const float* in, std::ptrdiff_t stride, int count, const CubicWeights& shift, int first, int width,
                float* out, std::ptrdiff_t out_stride) {
  for (int n = 0; n < width; ++n) {
    const int at = first + n + shift.whole;
    float value = kAir;
    if (shift.is_copy()) {
      if (at >= 0 && at < count) value = in[at * stride];
    } else if (at >= 0 && at + 1 < count) {
      const auto tap = [&](int m) { return in[std::clamp(m, 0, count - 1) * stride]; };
      value = shift.weights[0] * tap(at - 1) + shift.weights[1] * tap(at) + shift.weights[2] * tap(at + 1) +
              shift.weights[3] * tap(at + 2);
    }
    out[n * out_stride] = value;
  }
}

/// The pixels of the resampled grid, counted in those of the first slice.
struct PixelWindow {
  int first_i = 0;
  int first_j = 0;
  int columns = 0;
  int rows = 0;
};

std::vector<float> shifted_slice(std::span<const std::int16_t> hu, const GridGeometry& slices, const SlicePlace& place,
                                 const PixelWindow& window) {
  const int columns = slices.size[0];
  const int rows = slices.size[1];
  const std::vector<float> in(hu.begin(), hu.end());
  const CubicWeights shift_i(place.sideways_mm.x() / slices.spacing_mm.x());
  const CubicWeights shift_j(place.sideways_mm.y() / slices.spacing_mm.y());
  std::vector<float> wide(static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(rows));
  for (int j = 0; j < rows; ++j) {
    shift_line(in.data() + static_cast<std::ptrdiff_t>(j) * columns, 1, columns, shift_i, window.first_i,
               window.columns, wide.data() + static_cast<std::ptrdiff_t>(j) * window.columns, 1);
  }
  std::vector<float> out(static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(window.rows));
  for (int i = 0; i < window.columns; ++i) {
    shift_line(wide.data() + i, window.columns, rows, shift_j, window.first_j, window.rows, out.data() + i,
               window.columns);
  }
  return out;
}

PixelWindow window_of(const GridGeometry& slices, std::span<const SlicePlace> places) {
  constexpr double kMax = 1e6;  // pixels: beyond, numbers of voxels could overflow
  Eigen::Array2d low = Eigen::Array2d::Zero();
  Eigen::Array2d high = Eigen::Array2d::Zero();
  for (const SlicePlace& place : places) {
    const Eigen::Array2d pixels = place.sideways_mm.array() / slices.spacing_mm.head<2>().array();
    if (!(pixels.abs() < kMax).all()) fail("expected slices that lie over each other, found some far apart");
    low = low.min(pixels);
    high = high.max(pixels);
  }
  const auto down = [](double value) { return static_cast<int>(std::floor(value + kOnGrid)); };
  const auto up = [](double value) { return static_cast<int>(std::ceil(value - kOnGrid)); };
  return {down(low.x()), down(low.y()), slices.size[0] + up(high.x()) - down(low.x()),
          slices.size[1] + up(high.y()) - down(low.y())};
}

/// The slices on either side of a height, and how far it lies from the first to the second.
struct Between {
  std::size_t below = 0;
  std::size_t above = 0;
  float t = 0.0F;
};

Between find_between(std::span<const SlicePlace> places, double along_mm, double step_mm) {
  const auto after = std::upper_bound(places.begin(), places.end(), along_mm + kOnGrid * step_mm,
                                      [](double value, const SlicePlace& place) { return value < place.along_mm; });
  Between between;
  between.below = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - places.begin() - 1, 0));
  between.above = std::min(between.below + 1, places.size() - 1);
  const double gap_mm = places[between.above].along_mm - places[between.below].along_mm;
  const double t = gap_mm > 0.0 ? (along_mm - places[between.below].along_mm) / gap_mm : 0.0;
  if (t * gap_mm < kOnGrid * step_mm) between.above = between.below;
  between.t = between.above == between.below ? 0.0F : static_cast<float>(std::min(t, 1.0));
  return between;
}

}  // namespace

CtVolume resample_stack(const GridGeometry& slices, std::span<const SlicePlace> places, double step_mm,
                        std::span<const std::int16_t> hu, const Progress& progress) {
  check_geometry(slices, "CT");
  if (places.size() != static_cast<std::size_t>(slices.size[2]) || hu.size() != slices.voxel_count()) {
    fail("expected a place and values for each of ", slices.size[2], " slices, found ", places.size(), " and ",
         hu.size());
  }
  if (!(step_mm > 0.0)) fail("expected a step above 0 mm, found ", step_mm);
  const PixelWindow window = window_of(slices, places);
  const double length_mm = places.back().along_mm;
  constexpr double kMaxGrowth = 4.0;
  const double voxels = (std::floor(length_mm / step_mm + kOnGrid) + 1.0) * window.columns * window.rows;
  if (!(voxels <= kMaxGrowth * static_cast<double>(slices.voxel_count()))) {
    fail("expected slices that resampling makes at most ", kMaxGrowth, " times as many voxels of, found ", voxels,
         " from ", slices.voxel_count());
  }
  GridGeometry grid = slices;
  grid.size = {window.columns, window.rows, static_cast<int>(std::floor(length_mm / step_mm + kOnGrid)) + 1};
  grid.spacing_mm.z() = step_mm;
  grid.origin_mm = slices.to_patient(Vec3(window.first_i, window.first_j, 0.0));
  check_geometry(grid, "resampled CT");

  std::vector<std::int16_t> resampled(grid.voxel_count());
  const std::size_t slice_size = slices.offset(0, 0, 1);
  ProgressCounter counter(progress, "resampling slices", static_cast<std::size_t>(grid.size[2]));
  tbb::parallel_for(0, grid.size[2], [&](int k) {
    const Between between = find_between(places, k * step_mm, step_mm);
    const auto slice = [&](std::size_t n) {
      return shifted_slice(hu.subspan(n * slice_size, slice_size), slices, places[n], window);
    };
    std::vector<float> values = slice(between.below);
    if (between.above != between.below) {
      const std::vector<float> above = slice(between.above);
      for (std::size_t n = 0; n < values.size(); ++n) values[n] += between.t * (above[n] - values[n]);
    }
    std::int16_t* out = resampled.data() + grid.offset(0, 0, k);
    for (std::size_t n = 0; n < values.size(); ++n) {
      out[n] = static_cast<std::int16_t>(std::lround(std::clamp(values[n], -32768.0F, 32767.0F)));
    }
    counter.add();
  });
  return make_ct_volume(grid, std::move(resampled));
}

}  // namespace spinaltap
