#include "core/phantom/scanner.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/detail/check_within.h"
#include "core/phantom/detail/ideal_image.h"

namespace spinaltap {
namespace {

/// The kernel at a distance: a Gaussian; for a sharp one more of it, less a wider one. Not normalised.
double kernel_at(double distance, double sigma, double sharpness) {
  if (!(sigma > 0.0)) return 1.0;
  const double narrow = std::exp(-0.5 * std::pow(distance / sigma, 2));
  if (!(sharpness > 0.0)) return narrow;
  constexpr double kWider = 2.0;
  return (1.0 + sharpness) * narrow - sharpness / kWider * std::exp(-0.5 * std::pow(distance / (kWider * sigma), 2));
}

/// Reach of the kernel in deviations of its Gaussian.
double kernel_reach(double sharpness) { return sharpness > 0.0 ? 8.0 : 4.0; }

/// The noise of a virtual scan: white noise per pixel, blurred in the slice like the image, of the deviation asked for.
class ScanNoise {
 public:
  explicit ScanNoise(const ScanOptions& options);

  /// columns * rows values, HU. The same whichever thread asks.
  std::vector<float> slice(int slice) const;

 private:
  const ScanOptions options_;
  std::vector<float> kernel_;  ///< along one axis; its squares sum to 1, which keeps the deviation
};

ScanNoise::ScanNoise(const ScanOptions& options) : options_(options) {
  const double sigma = options.blur_mm / options.pixel_mm;  // pixels
  const int reach = static_cast<int>(std::ceil(kernel_reach(options.sharpness) * sigma));
  std::vector<double> exact;
  double squares = 0.0;
  for (int n = -reach; n <= reach; ++n) {
    // A soft kernel by its old formula, so that the noise of scans stays what it was to the bit.
    exact.push_back(options.sharpness > 0.0 ? kernel_at(n, sigma, options.sharpness)
                    : sigma > 0.0           ? std::exp(-0.5 * n * n / (sigma * sigma))
                                            : 1.0);
    squares += exact.back() * exact.back();
  }
  for (const double weight : exact) kernel_.push_back(static_cast<float>(weight / std::sqrt(squares)));
}

std::vector<float> ScanNoise::slice(int slice) const {
  const std::size_t columns = static_cast<std::size_t>(options_.columns),
                    rows = static_cast<std::size_t>(options_.rows);
  std::vector<float> image(columns * rows, 0.0F);
  if (!(options_.noise_hu > 0.0)) return image;
  // White noise goes on past the edges, so that the edges are as noisy as the middle.
  const std::size_t taps = kernel_.size();
  const std::size_t wide = columns + taps - 1, high = rows + taps - 1;
  const std::uint64_t first = static_cast<std::uint64_t>(slice) * wide * high;
  std::vector<float> white(wide);
  std::vector<float> narrow(columns * high, 0.0F);
  for (std::size_t row = 0; row < high; ++row) {
    for (std::size_t column = 0; column < wide; ++column) {
      white[column] = static_cast<float>(options_.noise_hu * random_normal(options_.seed, first + row * wide + column));
    }
    float* line = &narrow[row * columns];
    for (std::size_t tap = 0; tap < taps; ++tap) {
      for (std::size_t column = 0; column < columns; ++column) line[column] += kernel_[tap] * white[column + tap];
    }
  }
  for (std::size_t row = 0; row < rows; ++row) {
    float* line = &image[row * columns];
    for (std::size_t tap = 0; tap < taps; ++tap) {
      const float* from = &narrow[(row + tap) * columns];
      for (std::size_t column = 0; column < columns; ++column) line[column] += kernel_[tap] * from[column];
    }
  }
  return image;
}

void check_options(const ScanOptions& options) {
  const auto positive = [](const char* name, double value, double max) {
    if (!(value > 0.0 && value <= max)) fail("scan: ", name, " must lie in (0, ", max, "], found ", value);
  };
  const auto not_negative = [](const char* name, double value, double max) {
    check_within("scan", name, value, 0.0, max);
  };
  positive("columns", options.columns, 8192);
  positive("rows", options.rows, 8192);
  positive("slices", options.slices, 8192);
  positive("pixel_mm", options.pixel_mm, 10.0);
  positive("slice_step_mm", options.slice_step_mm, 20.0);
  positive("slice_width_mm", options.slice_width_mm, 40.0);
  not_negative("blur_mm", options.blur_mm, 10.0);
  not_negative("sharpness", options.sharpness, 5.0);
  not_negative("noise_hu", options.noise_hu, 1000.0);
  positive("surroundings_hu plus 1025", options.surroundings_hu + 1025.0, 4096.0);
  if (options.centre_mm && !options.centre_mm->allFinite()) fail("scan: centre_mm must be finite");
  positive("samples_per_pixel", options.samples_per_pixel, 16);
  positive("samples_per_step", options.samples_per_step, 32);
}

GridGeometry field_of_view(const Solid& solid, const ScanOptions& options) {
  GridGeometry geometry;
  geometry.size = {options.columns, options.rows, options.slices};
  geometry.spacing_mm = Vec3(options.pixel_mm, options.pixel_mm, options.slice_step_mm);
  const Vec3 last(options.columns - 1, options.rows - 1, options.slices - 1);
  const Vec3 corner =
      options.centre_mm.value_or(solid.bounds_mm().center()) - 0.5 * last.cwiseProduct(geometry.spacing_mm);
  // Whole micrometres, which the decimal text of a DICOM file holds exactly.
  geometry.origin_mm = (corner * 1e3).array().round() * 1e-3;
  return geometry;
}

/// Weights of planes -n ... n steps of `step_mm` away, that sum to 1: how much of each plane's cell a box of `width_mm`
/// covers.
std::vector<float> box_weights(double width_mm, double step_mm) {
  const int reach = static_cast<int>(std::ceil(0.5 * width_mm / step_mm - 0.5));
  std::vector<float> weights;
  for (int plane = -std::max(reach, 0); plane <= std::max(reach, 0); ++plane) {
    const double low = std::max((plane - 0.5) * step_mm, -0.5 * width_mm);
    const double high = std::min((plane + 0.5) * step_mm, 0.5 * width_mm);
    weights.push_back(static_cast<float>(std::max(high - low, 0.0) / width_mm));
  }
  return weights;
}

/// Weights, that sum to 1, of the samples around a pixel's centre along a row or column: the kernel, out to 4
/// deviations beyond the pixel (8 of a sharp one); the pixel's own samples alone, alike, when there is no blur.
std::vector<float> blur_weights(const ScanOptions& options) {
  const int samples = options.samples_per_pixel;
  const double step = options.pixel_mm / samples;
  const int reach =
      options.blur_mm > 0.0 ? static_cast<int>(std::ceil(kernel_reach(options.sharpness) * options.blur_mm / step)) : 0;
  const int count = samples + 2 * reach;
  std::vector<double> exact;
  double sum = 0.0;
  for (int n = 0; n < count; ++n) {
    const double distance = (n - 0.5 * (count - 1)) * step;
    exact.push_back(kernel_at(distance, options.blur_mm, options.sharpness));
    sum += exact.back();
  }
  std::vector<float> weights;
  weights.reserve(exact.size());
  for (const double weight : exact) weights.push_back(static_cast<float>(weight / sum));
  return weights;
}

/// One slice of the image, without noise: the ideal image averaged over the slice profile and blurred.
class SliceMaker {
 public:
  SliceMaker(const IdealImage& ideal, const ScanOptions& options)
      : ideal_(ideal),
        options_(options),
        profile_(box_weights(options.slice_width_mm, options.slice_step_mm / options.samples_per_step)),
        blur_(blur_weights(options)) {}

  int plane_reach() const { return static_cast<int>(profile_.size() / 2); }

  /// columns * rows values above the surroundings, HU.
  std::vector<float> make(int slice) const {
    const std::size_t width = static_cast<std::size_t>(ideal_.width()),
                      height = static_cast<std::size_t>(ideal_.height());
    const std::size_t columns = static_cast<std::size_t>(options_.columns);
    std::vector<float> sum(width * height, 0.0F);
    int index = slice * options_.samples_per_step - plane_reach();
    for (const float weight : profile_) {
      const std::span<const float> plane = ideal_.plane(index++);
      for (std::size_t at = 0; at < sum.size(); ++at) sum[at] += weight * plane[at];
    }
    std::vector<float> narrow(columns * height, 0.0F);
    for (std::size_t row = 0; row < height; ++row) {
      for (int column = 0; column < options_.columns; ++column) {
        const Taps taps = taps_of(column, ideal_.first_column(), ideal_.width());
        float value = 0.0F;
        for (int n = taps.begin; n < taps.end; ++n) {
          const int sample = taps.first + n;
          value += blur_[static_cast<std::size_t>(n)] * sum[row * width + static_cast<std::size_t>(sample)];
        }
        narrow[row * columns + static_cast<std::size_t>(column)] = value;
      }
    }
    std::vector<float> image(columns * static_cast<std::size_t>(options_.rows), 0.0F);
    for (int row = 0; row < options_.rows; ++row) {
      float* line = &image[static_cast<std::size_t>(row) * columns];
      const Taps taps = taps_of(row, ideal_.first_row(), ideal_.height());
      for (int n = taps.begin; n < taps.end; ++n) {
        const float weight = blur_[static_cast<std::size_t>(n)];
        const float* from = &narrow[static_cast<std::size_t>(taps.first + n) * columns];
        for (std::size_t column = 0; column < columns; ++column) line[column] += weight * from[column];
      }
    }
    return image;
  }

 private:
  /// Weights begin ... end - 1 fall on the held samples first + begin ... first + end - 1.
  struct Taps {
    int first, begin, end;
  };

  Taps taps_of(int pixel, int first_held, int held) const {
    const int count = static_cast<int>(blur_.size());
    const int first = pixel * options_.samples_per_pixel - (count - options_.samples_per_pixel) / 2 - first_held;
    return {first, std::clamp(-first, 0, count), std::clamp(held - first, 0, count)};
  }

  const IdealImage& ideal_;
  const ScanOptions& options_;
  std::vector<float> profile_, blur_;
};

/// `surroundings`: null for even ones.
CtVolume scan_in(const Solid& solid, const Surroundings* surroundings, const ScanOptions& options,
                 const Progress& progress) {
  check_options(options);
  const GridGeometry geometry = field_of_view(solid, options);
  check_geometry(geometry, "scan");
  std::vector<std::int16_t> hu(geometry.voxel_count());
  IdealImage ideal(solid, geometry, options, surroundings);
  const SliceMaker maker(ideal, options);
  const ScanNoise noise(options);
  ProgressCounter done(progress, "scan", static_cast<std::size_t>(options.slices));
  const auto around_at = [&](std::size_t at, int slice) {
    const auto columns = static_cast<std::size_t>(options.columns);
    const std::size_t row = at / columns;
    const Vec3 index(static_cast<double>(at % columns), static_cast<double>(row), slice);
    return surroundings->hu(geometry.to_patient(index));
  };
  constexpr int kSlab = 8;  // slices at a time: what of the fine lattice is held
  for (int begin = 0; begin < options.slices; begin += kSlab) {
    const int end = std::min(begin + kSlab, options.slices);
    ideal.hold(begin * options.samples_per_step - maker.plane_reach(),
               (end - 1) * options.samples_per_step + maker.plane_reach() + 1);
    tbb::parallel_for(begin, end, [&](int slice) {
      const std::vector<float> signal = maker.make(slice);
      const std::vector<float> grain = noise.slice(slice);
      std::int16_t* out = &hu[geometry.offset(0, 0, slice)];
      for (std::size_t at = 0; at < signal.size(); ++at) {
        const double around_hu = surroundings == nullptr ? options.surroundings_hu : around_at(at, slice);
        const double value = around_hu + static_cast<double>(signal[at]) + static_cast<double>(grain[at]);
        out[at] = static_cast<std::int16_t>(std::lround(std::clamp(value, -1024.0, 32767.0)));
      }
      done.add();
    });
  }
  CtVolume ct = make_ct_volume(geometry, std::move(hu));
  ct.slice_thickness_mm = options.slice_width_mm;
  return ct;
}

}  // namespace

CtVolume scan(const Solid& solid, const ScanOptions& options, const Progress& progress) {
  return scan_in(solid, nullptr, options, progress);
}

CtVolume scan(const Solid& solid, const Surroundings& surroundings, const ScanOptions& options,
              const Progress& progress) {
  return scan_in(solid, &surroundings, options, progress);
}

ScanOptions scan_of_box(const Box3& box_mm, const ScanOptions& options) {
  if (box_mm.isEmpty() || !(options.pixel_mm > 0.0) || !(options.slice_step_mm > 0.0)) {
    fail("scan: a box and steps above 0 expected");
  }
  const auto count = [](double length_mm, double step_mm) {
    return static_cast<int>(std::min(std::ceil(length_mm / step_mm), 1e6)) + 1;
  };
  ScanOptions fitted = options;
  fitted.columns = count(box_mm.sizes().x(), options.pixel_mm);
  fitted.rows = count(box_mm.sizes().y(), options.pixel_mm);
  fitted.slices = count(box_mm.sizes().z(), options.slice_step_mm);
  fitted.centre_mm = box_mm.center();
  return fitted;
}

}  // namespace spinaltap
