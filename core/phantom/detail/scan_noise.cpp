#include "core/phantom/detail/scan_noise.h"

#include <cmath>

#include "core/base/random.h"

namespace spinaltap {

ScanNoise::ScanNoise(const ScanOptions& options) : options_(options) {
  const double sigma = options.blur_mm / options.pixel_mm;  // pixels
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> exact;
  double squares = 0.0;
  for (int n = -reach; n <= reach; ++n) {
    exact.push_back(sigma > 0.0 ? std::exp(-0.5 * n * n / (sigma * sigma)) : 1.0);
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

}  // namespace spinaltap
