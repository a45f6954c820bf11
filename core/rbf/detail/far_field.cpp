#include "core/rbf/detail/far_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spinaltap::detail {
namespace {

constexpr std::size_t kChunk = 2 * kLanes;

std::size_t as_size(int value) { return static_cast<std::size_t>(value); }

/// Rows of complex numbers are padded to whole vectors.
std::size_t padded(std::size_t columns) { return (columns + kLanes - 1) / kLanes * kLanes; }

}  // namespace

FarField::FarField(RadialKernel kernel, double c2, int order, const SimdKernels& simd)
    : kernel_(kernel), c2_(c2), order_(as_size(order)), length_(2 * as_size(order) - 1), simd_(simd) {
  chunks_ = (length_ * length_ * order_ + kLanes - 1) / kLanes;
  cos_.resize(length_ * length_);
  sin_.resize(length_ * length_);
  minus_sin_.resize(length_ * length_);
  for (std::size_t k = 0; k < length_; ++k) {
    for (std::size_t m = 0; m < length_; ++m) {
      const double angle =
          -2.0 * std::numbers::pi * static_cast<double>((k * m) % length_) / static_cast<double>(length_);
      cos_[k * length_ + m] = std::cos(angle);
      sin_[k * length_ + m] = std::sin(angle);
      minus_sin_[k * length_ + m] = -sin_[k * length_ + m];
      if (m >= order_) continue;
      short_cos_.push_back(cos_[k * length_ + m]);
      short_sin_.push_back(sin_[k * length_ + m]);
    }
  }
}

void FarField::store(const double* re, const double* im, double* spectrum, std::size_t stride) const {
  const std::size_t row = padded(order_);
  std::size_t out = 0;
  for (std::size_t line = 0; line < length_ * length_; ++line) {
    for (std::size_t k = 0; k < order_; ++k, ++out) {
      double* to = spectrum + (out / kLanes) * stride + out % kLanes;
      to[0] = re[line * row + k];
      to[kLanes] = im[line * row + k];
    }
  }
  for (; out < chunks_ * kLanes; ++out) {
    double* to = spectrum + (out / kLanes) * stride + out % kLanes;
    to[0] = 0.0;
    to[kLanes] = 0.0;
  }
}

void FarField::transform(const double* nodes, double* spectrum, std::size_t stride) const {
  const std::size_t n = order_;
  const std::size_t size = length_;
  // Along x, real to half a spectrum; rows are padded for the vector loops.
  const std::size_t row = padded(n);
  thread_local std::vector<double> work;
  const std::size_t plane = n * row;
  const std::size_t first = n * plane;
  const std::size_t second = size * plane;
  const std::size_t third = size * size * row;
  work.assign(2 * (first + second + third), 0.0);
  double* x_re = work.data();
  double* x_im = x_re + first;
  double* z_re = x_im + first;
  double* z_im = z_re + second;
  double* y_re = z_im + second;
  double* y_im = y_re + third;
  for (std::size_t line = 0; line < n * n; ++line) {
    for (std::size_t i = 0; i < n; ++i) {
      const double value = nodes[line * n + i];
      for (std::size_t k = 0; k < n; ++k) {
        x_re[line * row + k] += value * cos_[i * size + k];
        x_im[line * row + k] += value * sin_[i * size + k];
      }
    }
  }
  simd_.multiply_complex(size, n, plane, short_cos_.data(), short_sin_.data(), x_re, x_im, z_re, z_im);
  for (std::size_t kz = 0; kz < size; ++kz) {
    simd_.multiply_complex(size, n, row, short_cos_.data(), short_sin_.data(), z_re + kz * plane, z_im + kz * plane,
                           y_re + kz * size * row, y_im + kz * size * row);
  }
  store(y_re, y_im, spectrum, stride);
}

void FarField::transform_back(const double* spectrum, std::size_t stride, double* nodes) const {
  const std::size_t n = order_;
  const std::size_t size = length_;
  const std::size_t row = padded(n);
  thread_local std::vector<double> work;
  const std::size_t first = size * size * row;
  const std::size_t second = size * n * row;
  const std::size_t third = n * n * row;
  work.assign(2 * (first + second + third), 0.0);
  double* y_re = work.data();
  double* y_im = y_re + first;
  double* z_re = y_im + first;
  double* z_im = z_re + second;
  double* x_re = z_im + second;
  double* x_im = x_re + third;
  std::size_t in = 0;
  for (std::size_t line = 0; line < size * size; ++line) {
    for (std::size_t k = 0; k < n; ++k, ++in) {
      const double* from = spectrum + (in / kLanes) * stride + in % kLanes;
      y_re[line * row + k] = from[0];
      y_im[line * row + k] = from[kLanes];
    }
  }
  for (std::size_t kz = 0; kz < size; ++kz) {
    simd_.multiply_complex(n, size, row, cos_.data(), minus_sin_.data(), y_re + kz * size * row, y_im + kz * size * row,
                           z_re + kz * n * row, z_im + kz * n * row);
  }
  simd_.multiply_complex(n, size, n * row, cos_.data(), minus_sin_.data(), z_re, z_im, x_re, x_im);
  const double scale = 1.0 / static_cast<double>(size * size * size);
  for (std::size_t line = 0; line < n * n; ++line) {
    for (std::size_t i = 0; i < n; ++i) {
      // The other half of the spectrum is this half's conjugate.
      double sum = x_re[line * row];
      for (std::size_t k = 1; k < n; ++k) {
        sum += 2.0 * (x_re[line * row + k] * cos_[i * size + k] + x_im[line * row + k] * sin_[i * size + k]);
      }
      nodes[line * n + i] = scale * sum;
    }
  }
}

void FarField::prepare_table(double half_mm) {
  if (table_half_mm_ == half_mm) return;
  table_half_mm_ = half_mm;
  table_.assign(chunks_ * kOffsets * kChunk, 0.0);
  const double step_mm = 2.0 * half_mm / static_cast<double>(order_ - 1);
  const int n = static_cast<int>(order_);
  const int size = static_cast<int>(length_);
  const std::size_t half = padded(order_);
  tbb::parallel_for(std::uint32_t{0}, kOffsets, [&](std::uint32_t offset) {
    const int dx = static_cast<int>(offset % 7) - 3;
    const int dy = static_cast<int>(offset / 7 % 7) - 3;
    const int dz = static_cast<int>(offset / 49) - 3;
    if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) < 2) return;
    // Full transforms, one axis after the other: x to half a spectrum.
    const auto signed_index = [&](int m) { return m < n ? m : m - size; };
    const std::size_t full = length_ * length_ * half;
    std::vector<double> a_re(full, 0.0);
    std::vector<double> a_im(full, 0.0);
    std::vector<double> b_re(full, 0.0);
    std::vector<double> b_im(full, 0.0);
    for (int z = 0; z < size; ++z) {
      const double rz = step_mm * (dz * (n - 1) + signed_index(z));
      for (int y = 0; y < size; ++y) {
        const double ry = step_mm * (dy * (n - 1) + signed_index(y));
        double* re = a_re.data() + (as_size(z) * length_ + as_size(y)) * half;
        double* im = a_im.data() + (as_size(z) * length_ + as_size(y)) * half;
        for (int x = 0; x < size; ++x) {
          const double rx = step_mm * (dx * (n - 1) + signed_index(x));
          const double value = phi(kernel_, rx * rx + ry * ry + rz * rz, c2_);
          for (std::size_t k = 0; k < order_; ++k) {
            re[k] += value * cos_[as_size(x) * length_ + k];
            im[k] += value * sin_[as_size(x) * length_ + k];
          }
        }
      }
    }
    simd_.multiply_complex(length_, length_, length_ * half, cos_.data(), sin_.data(), a_re.data(), a_im.data(),
                           b_re.data(), b_im.data());
    for (std::size_t kz = 0; kz < length_; ++kz) {
      const std::size_t plane = kz * length_ * half;
      simd_.multiply_complex(length_, length_, half, cos_.data(), sin_.data(), b_re.data() + plane, b_im.data() + plane,
                             a_re.data() + plane, a_im.data() + plane);
    }
    store(a_re.data(), a_im.data(), table_.data() + offset * kChunk, kOffsets * kChunk);
  });
}

void FarField::translate(const Octree& tree, const InteractionLists& lists, std::uint32_t begin, std::uint32_t end,
                         const std::vector<std::uint32_t>& multipole_slot, const std::vector<double>& multipole,
                         const std::vector<std::uint32_t>& local_slot, std::vector<double>& local) {
  // The boxes that take part, numbered within the level.
  std::vector<std::uint32_t> targets;
  std::vector<std::uint32_t> sources;
  std::vector<std::uint32_t> place(end - begin, Octree::kNone);
  for (std::uint32_t b = begin; b < end; ++b) {
    if (lists.far.count(b) == 0) continue;
    targets.push_back(b);
    for (const FarBox* f = lists.far.begin(b); f != lists.far.end(b); ++f) {
      if (place[f->box - begin] != Octree::kNone) continue;
      place[f->box - begin] = static_cast<std::uint32_t>(sources.size());
      sources.push_back(f->box);
    }
  }
  if (targets.empty()) return;
  const double half_mm = tree.half_width_mm(tree.boxes()[begin]);
  const bool scales = c2_ == 0.0;
  prepare_table(scales ? 1.0 : half_mm);
  const double scale = scales ? std::pow(half_mm, power_of(kernel_)) : 1.0;

  std::vector<std::vector<SpectrumPair>> pairs(targets.size());
  for (std::size_t t = 0; t < targets.size(); ++t) {
    pairs[t].reserve(lists.far.count(targets[t]));
    for (const FarBox* f = lists.far.begin(targets[t]); f != lists.far.end(targets[t]); ++f) {
      pairs[t].push_back({f->offset, place[f->box - begin]});
    }
  }
  const std::size_t nodes = order_ * order_ * order_;
  const std::size_t source_stride = sources.size() * kChunk;
  source_spectra_.resize(std::max(source_spectra_.size(), chunks_ * source_stride));
  tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t s) {
    transform(multipole.data() + multipole_slot[sources[s]] * nodes, source_spectra_.data() + s * kChunk,
              source_stride);
  });
  // Targets in blocks: their spectra stay in the cache, and so do those of the sources around them.
  constexpr std::size_t kBlock = 512;
  constexpr std::size_t kTargetStride = kBlock * kChunk;
  target_spectra_.resize(chunks_ * kTargetStride);
  for (std::size_t first = 0; first < targets.size(); first += kBlock) {
    const std::size_t last = std::min(targets.size(), first + kBlock);
    tbb::parallel_for(std::size_t{0}, chunks_, [&](std::size_t chunk) {
      for (std::size_t t = first; t < last; ++t) {
        simd_.multiply_spectra(pairs[t].data(), pairs[t].size(), table_.data() + chunk * kOffsets * kChunk,
                               source_spectra_.data() + chunk * source_stride,
                               target_spectra_.data() + chunk * kTargetStride + (t - first) * kChunk);
      }
    });
    tbb::parallel_for(first, last, [&](std::size_t t) {
      thread_local std::vector<double> sum;
      sum.resize(nodes);
      transform_back(target_spectra_.data() + (t - first) * kChunk, kTargetStride, sum.data());
      double* to = local.data() + local_slot[targets[t]] * nodes;
      for (std::size_t k = 0; k < nodes; ++k) to[k] += scale * sum[k];
    });
  }
}

}  // namespace spinaltap::detail
