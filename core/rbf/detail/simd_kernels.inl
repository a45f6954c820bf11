// Compiled once for each set of instructions: see kernel_sets.h. Eight lanes are as many registers as the set needs for
// them.

#include "core/rbf/detail/simd_kernels.h"

namespace spinaltap::detail {
namespace {

using Lanes = double __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
constexpr std::size_t kWidth = SPINALTAP_VECTOR_BYTES / sizeof(double);

inline void load(const double* from, Lanes& to) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
inline void store(const Lanes& from, double* to) { __builtin_memcpy(to, &from, sizeof(Lanes)); }
inline void add_to(const Lanes& sum, double* to) {
  Lanes old;
  load(to, old);
  store(old + sum, to);
}
inline void square_root(const Lanes& of, Lanes& root) {
  for (std::size_t l = 0; l < kWidth; ++l) root[l] = __builtin_sqrt(of[l]);
}

template <int kPower, bool kGradient>
void near_sum_of(const double* targets, const SourceArrays& sources, std::size_t begin, std::size_t end, double c2,
                 std::size_t lane, LaneSums& sums) {
  Lanes x;
  Lanes y;
  Lanes z;
  load(targets + lane, x);
  load(targets + kLanes + lane, y);
  load(targets + 2 * kLanes + lane, z);
  Lanes value{};
  Lanes gx{};
  Lanes gy{};
  Lanes gz{};
  for (std::size_t j = begin; j < end; ++j) {
    const Lanes dx = x - sources.x[j];
    const Lanes dy = y - sources.y[j];
    const Lanes dz = z - sources.z[j];
    const Lanes r2 = (dx * dx + dy * dy) + (dz * dz + c2);
    Lanes r;
    square_root(r2, r);
    const double w = sources.weight[j];
    if constexpr (kPower == 1) {
      value += w * r;
      if constexpr (kGradient) {
        // At its own place a source gives 0 / tiny = 0.
        const Lanes share = w / (r > 1e-150 ? r : Lanes{} + 1e-150);
        gx += share * dx;
        gy += share * dy;
        gz += share * dz;
      }
    } else {
      const Lanes wr = w * r;
      value += wr * r2;
      if constexpr (kGradient) {
        const Lanes share = 3.0 * wr;
        gx += share * dx;
        gy += share * dy;
        gz += share * dz;
      }
    }
  }
  add_to(value, sums.value + lane);
  if constexpr (kGradient) {
    add_to(gx, sums.gradient[0] + lane);
    add_to(gy, sums.gradient[1] + lane);
    add_to(gz, sums.gradient[2] + lane);
  }
}

void near_sum(int power, bool gradient, const double* targets, const SourceArrays& sources, std::size_t begin,
              std::size_t end, double c2, LaneSums& sums) {
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
    if (power == 1) {
      gradient ? near_sum_of<1, true>(targets, sources, begin, end, c2, lane, sums)
               : near_sum_of<1, false>(targets, sources, begin, end, c2, lane, sums);
    } else {
      gradient ? near_sum_of<3, true>(targets, sources, begin, end, c2, lane, sums)
               : near_sum_of<3, false>(targets, sources, begin, end, c2, lane, sums);
    }
  }
}

/// The basis polynomials at eight places t (-1..1), and their derivatives: products of (t - t_k) from the left and
/// from the right, so that no place divides by zero.
inline void lagrange_lanes(int order, const Lanes& t, const double* inverse, bool gradient, Lanes* basis,
                           Lanes* slope) {
  Lanes left[kMaxOrder + 1];
  Lanes right[kMaxOrder + 1];
  Lanes left_slope[kMaxOrder + 1];
  Lanes right_slope[kMaxOrder + 1];
  left[0] = Lanes{} + 1.0;
  right[order] = Lanes{} + 1.0;
  left_slope[0] = Lanes{};
  right_slope[order] = Lanes{};
  const double step = 2.0 / (order - 1);
  for (int k = 0; k < order; ++k) {
    const Lanes d = t - (-1.0 + step * k);
    left[k + 1] = left[k] * d;
    if (gradient) left_slope[k + 1] = left_slope[k] * d + left[k];
  }
  for (int k = order - 1; k >= 0; --k) {
    const Lanes d = t - (-1.0 + step * k);
    right[k] = right[k + 1] * d;
    if (gradient) right_slope[k] = right_slope[k + 1] * d + right[k + 1];
  }
  for (int k = 0; k < order; ++k) {
    basis[k] = left[k] * right[k + 1] * inverse[k];
    if (gradient) slope[k] = (left_slope[k] * right[k + 1] + left[k] * right_slope[k + 1]) * inverse[k];
  }
}

template <bool kGradient>
void interpolate_with(int order, const double* places, const double* nodes, const double* inverse, double scale,
                      std::size_t lane, LaneSums& sums) {
  Lanes basis[3][kMaxOrder];
  Lanes slope[3][kMaxOrder];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Lanes t;
    load(places + axis * kLanes + lane, t);
    lagrange_lanes(order, t, inverse, kGradient, basis[axis], slope[axis]);
  }
  Lanes value{};
  Lanes gx{};
  Lanes gy{};
  Lanes gz{};
  for (int k = 0; k < order; ++k) {
    Lanes plane{};
    Lanes plane_x{};
    Lanes plane_y{};
    for (int j = 0; j < order; ++j) {
      Lanes row{};
      Lanes row_x{};
      for (int i = 0; i < order; ++i, ++nodes) {
        row += *nodes * basis[0][i];
        if constexpr (kGradient) row_x += *nodes * slope[0][i];
      }
      plane += row * basis[1][j];
      if constexpr (kGradient) {
        plane_x += row_x * basis[1][j];
        plane_y += row * slope[1][j];
      }
    }
    value += plane * basis[2][k];
    if constexpr (kGradient) {
      gx += plane_x * basis[2][k];
      gy += plane_y * basis[2][k];
      gz += plane * slope[2][k];
    }
  }
  add_to(value, sums.value + lane);
  if constexpr (kGradient) {
    add_to(gx * scale, sums.gradient[0] + lane);
    add_to(gy * scale, sums.gradient[1] + lane);
    add_to(gz * scale, sums.gradient[2] + lane);
  }
}

void interpolate(int order, bool gradient, const double* places, const double* nodes, const double* inverse,
                 double scale, LaneSums& sums) {
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
    gradient ? interpolate_with<true>(order, places, nodes, inverse, scale, lane, sums)
             : interpolate_with<false>(order, places, nodes, inverse, scale, lane, sums);
  }
}

/// See simd_kernels.h. One axis after the other, with the sums in the order that interpolate_with() has them in.
void interpolate_lattice(int order, const std::size_t* counts, const double* const* places, const double* nodes,
                         const double* inverse, double* work, double* out) {
  const auto size = static_cast<std::size_t>(order);
  Lanes basis[kMaxOrder];
  Lanes slope[kMaxOrder];  // not wanted
  double* along[2] = {work, work + (counts[1] + kLanes - 1) / kLanes * kLanes * size};
  for (std::size_t axis = 1; axis < 3; ++axis) {
    for (std::size_t first = 0; first < counts[axis]; first += kWidth) {
      Lanes t;
      load(places[axis] + first, t);
      lagrange_lanes(order, t, inverse, false, basis, slope);
      for (std::size_t l = 0; l < kWidth; ++l) {
        for (std::size_t k = 0; k < size; ++k) along[axis - 1][(first + l) * size + k] = basis[k][l];
      }
    }
  }
  const std::size_t row_size = (counts[0] + kLanes - 1) / kLanes * kLanes;
  Lanes rows[kMaxOrder * kMaxOrder];
  Lanes planes[kMaxOrder];
  for (std::size_t first = 0; first < counts[0]; first += kWidth) {
    Lanes t;
    load(places[0] + first, t);
    lagrange_lanes(order, t, inverse, false, basis, slope);
    const double* node = nodes;
    for (std::size_t r = 0; r < size * size; ++r) {
      Lanes row{};
      for (std::size_t i = 0; i < size; ++i, ++node) row += *node * basis[i];
      rows[r] = row;
    }
    for (std::size_t j = 0; j < counts[1]; ++j) {
      const double* y = along[0] + j * size;
      for (std::size_t k = 0; k < size; ++k) {
        Lanes plane{};
        for (std::size_t q = 0; q < size; ++q) plane += rows[k * size + q] * y[q];
        planes[k] = plane;
      }
      for (std::size_t m = 0; m < counts[2]; ++m) {
        const double* z = along[1] + m * size;
        Lanes value{};
        for (std::size_t k = 0; k < size; ++k) value += planes[k] * z[k];
        store(value, out + (m * counts[1] + j) * row_size + first);
      }
    }
  }
}

void multiply_spectra(const SpectrumPair* pairs, std::size_t count, const double* table, const double* source,
                      double* out) {
  constexpr std::size_t kChunk = 2 * kLanes;
  constexpr std::size_t kParts = kLanes / kWidth;
  Lanes re[kParts] = {};
  Lanes im[kParts] = {};
  for (std::size_t p = 0; p < count; ++p) {
    const double* a = table + pairs[p].table * kChunk;
    const double* b = source + pairs[p].source * kChunk;
    for (std::size_t part = 0; part < kParts; ++part) {
      Lanes a_re;
      Lanes a_im;
      Lanes b_re;
      Lanes b_im;
      load(a + part * kWidth, a_re);
      load(a + kLanes + part * kWidth, a_im);
      load(b + part * kWidth, b_re);
      load(b + kLanes + part * kWidth, b_im);
      re[part] += a_re * b_re - a_im * b_im;
      im[part] += a_re * b_im + a_im * b_re;
    }
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    store(re[part], out + part * kWidth);
    store(im[part], out + kLanes + part * kWidth);
  }
}

void multiply_complex(std::size_t rows, std::size_t inner, std::size_t columns, const double* a_re, const double* a_im,
                      const double* in_re, const double* in_im, double* out_re, double* out_im) {
  for (std::size_t column = 0; column < columns; column += kWidth) {
    for (std::size_t r = 0; r < rows; ++r) {
      Lanes re{};
      Lanes im{};
      for (std::size_t k = 0; k < inner; ++k) {
        const double c = a_re[r * inner + k];
        const double s = a_im[r * inner + k];
        Lanes from_re;
        Lanes from_im;
        load(in_re + k * columns + column, from_re);
        load(in_im + k * columns + column, from_im);
        re += c * from_re - s * from_im;
        im += c * from_im + s * from_re;
      }
      store(re, out_re + r * columns + column);
      store(im, out_im + r * columns + column);
    }
  }
}

/// One lane set of local_functions(): see simd_kernels.h.
template <int kPower>
void local_functions_of(std::size_t count, std::size_t terms, const double* points, const double* diagonal,
                        double* basis, double* factor, double* out) {
  // basis: terms x count, orthonormal polynomials over the points (modified Gram-Schmidt, twice).
  const auto at = [&](double* array, std::size_t k) { return array + k * kLanes; };
  for (std::size_t i = 0; i < count; ++i) {
    Lanes x;
    Lanes y;
    Lanes z;
    load(points + 3 * i * kLanes, x);
    load(points + (3 * i + 1) * kLanes, y);
    load(points + (3 * i + 2) * kLanes, z);
    const Lanes row[10] = {Lanes{} + 1.0, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
    for (std::size_t k = 0; k < terms; ++k) store(row[k], at(basis, k * count + i));
  }
  for (std::size_t k = 0; k < terms; ++k) {
    Lanes before{};
    for (std::size_t i = 0; i < count; ++i) {
      Lanes b;
      load(at(basis, k * count + i), b);
      before += b * b;
    }
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t l = 0; l < k; ++l) {
        Lanes dot{};
        for (std::size_t i = 0; i < count; ++i) {
          Lanes b;
          Lanes q;
          load(at(basis, k * count + i), b);
          load(at(basis, l * count + i), q);
          dot += b * q;
        }
        for (std::size_t i = 0; i < count; ++i) {
          Lanes b;
          Lanes q;
          load(at(basis, k * count + i), b);
          load(at(basis, l * count + i), q);
          store(b - dot * q, at(basis, k * count + i));
        }
      }
    }
    Lanes square{};
    for (std::size_t i = 0; i < count; ++i) {
      Lanes b;
      load(at(basis, k * count + i), b);
      square += b * b;
    }
    Lanes norm;
    square_root(square, norm);
    // Points in a plane leave nothing of a term but rounding.
    Lanes share{};
    for (std::size_t l = 0; l < kWidth; ++l) share[l] = square[l] > 1e-20 * before[l] ? 1.0 / norm[l] : 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      Lanes b;
      load(at(basis, k * count + i), b);
      store(b * share, at(basis, k * count + i));
    }
  }
  // factor: rows of the lower triangle of K = -+phi + penalty * basis basis', then of its Cholesky factor.
  const double penalty = 1e5 * static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    Lanes x;
    Lanes y;
    Lanes z;
    load(points + 3 * i * kLanes, x);
    load(points + (3 * i + 1) * kLanes, y);
    load(points + (3 * i + 2) * kLanes, z);
    for (std::size_t j = 0; j <= i; ++j) {
      Lanes px;
      Lanes py;
      Lanes pz;
      load(points + 3 * j * kLanes, px);
      load(points + (3 * j + 1) * kLanes, py);
      load(points + (3 * j + 2) * kLanes, pz);
      const Lanes dx = x - px;
      const Lanes dy = y - py;
      const Lanes dz = z - pz;
      const Lanes r2 = (dx * dx + dy * dy) + dz * dz;
      Lanes r;
      square_root(r2, r);
      Lanes sum{};
      for (std::size_t k = 0; k < terms; ++k) {
        Lanes p;
        Lanes q;
        load(at(basis, k * count + i), p);
        load(at(basis, k * count + j), q);
        sum += p * q;
      }
      sum = penalty * sum + (kPower == 1 ? -r : r * r2);
      if (i == j) {
        Lanes d;
        load(diagonal + i * kLanes, d);
        sum += d;
      }
      store(sum, at(factor, i * (i + 1) / 2 + j));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    double* row_i = at(factor, i * (i + 1) / 2);
    for (std::size_t j = 0; j <= i; ++j) {
      const double* row_j = at(factor, j * (j + 1) / 2);
      Lanes sum;
      load(row_i + j * kLanes, sum);
      for (std::size_t k = 0; k < j; ++k) {
        Lanes p;
        Lanes q;
        load(row_i + k * kLanes, p);
        load(row_j + k * kLanes, q);
        sum -= p * q;
      }
      if (j < i) {
        Lanes inverse;
        load(row_j + j * kLanes, inverse);
        store(sum * inverse, row_i + j * kLanes);
        continue;
      }
      // The diagonal holds reciprocals. Rounding may eat a pivot: that point's function is left out.
      Lanes root;
      square_root(sum, root);
      for (std::size_t l = 0; l < kWidth; ++l) root[l] = sum[l] > 0.0 ? 1.0 / root[l] : 0.0;
      store(root, row_i + i * kLanes);
    }
  }
  // L' out = e_last.
  for (std::size_t i = count; i-- > 0;) {
    Lanes sum = Lanes{} + (i + 1 == count ? 1.0 : 0.0);
    for (std::size_t k = i + 1; k < count; ++k) {
      Lanes l;
      Lanes o;
      load(at(factor, k * (k + 1) / 2 + i), l);
      load(out + k * kLanes, o);
      sum -= l * o;
    }
    Lanes inverse;
    load(at(factor, i * (i + 1) / 2 + i), inverse);
    store(sum * inverse, out + i * kLanes);
  }
}

void local_functions(int power, std::size_t count, std::size_t terms, const double* points, const double* diagonal,
                     double* work, double* out) {
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
    double* basis = work + lane;
    double* factor = work + terms * count * kLanes + lane;
    (power == 1 ? local_functions_of<1> : local_functions_of<3>)(count, terms, points + lane, diagonal + lane, basis,
                                                                 factor, out + lane);
  }
}

}  // namespace

SimdKernels SimdKernels::SPINALTAP_KERNEL_SET() {
  return {SPINALTAP_KERNEL_NAME,    detail::near_sum,         detail::interpolate,    detail::interpolate_lattice,
          detail::multiply_spectra, detail::multiply_complex, detail::local_functions};
}

}  // namespace spinaltap::detail
