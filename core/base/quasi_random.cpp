#include "core/base/quasi_random.h"

#include <array>
#include <bit>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/statistics.h"

namespace spinaltap {
namespace {

constexpr int kSobolBits = 32;
using SobolNumbers = std::array<std::uint32_t, kSobolBits>;

/// A primitive polynomial's degree and coefficients, and the first odd numbers, as Joe & Kuo's table has them.
struct SobolPolynomial {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 5> first;
};
constexpr std::array<SobolPolynomial, kSobolDimensions - 1> kSobolPolynomials{{{1, 0, {1}},
                                                                               {2, 1, {1, 3}},
                                                                               {3, 1, {1, 3, 1}},
                                                                               {3, 2, {1, 1, 1}},
                                                                               {4, 1, {1, 1, 3, 3}},
                                                                               {4, 4, {1, 3, 5, 13}},
                                                                               {5, 2, {1, 1, 5, 5, 17}},
                                                                               {5, 4, {1, 1, 5, 5, 5}},
                                                                               {5, 7, {1, 1, 7, 11, 19}},
                                                                               {5, 11, {1, 1, 5, 1, 1}},
                                                                               {5, 13, {1, 1, 1, 3, 11}}}};

constexpr std::array<SobolNumbers, kSobolDimensions> make_sobol_directions() {
  std::array<SobolNumbers, kSobolDimensions> all{};
  for (int bit = 0; bit < kSobolBits; ++bit) all[0][static_cast<std::size_t>(bit)] = 1U << (kSobolBits - 1 - bit);
  for (std::size_t n = 0; n < kSobolPolynomials.size(); ++n) {
    const SobolPolynomial& one = kSobolPolynomials[n];
    SobolNumbers& to = all[n + 1];
    const auto degree = static_cast<std::size_t>(one.degree);
    for (std::size_t bit = 0; bit < to.size(); ++bit) {
      if (bit < degree) {
        to[bit] = one.first[bit] << (kSobolBits - 1 - bit);
        continue;
      }
      to[bit] = to[bit - degree] ^ (to[bit - degree] >> degree);
      for (std::size_t back = 1; back < degree; ++back) {
        if (((one.coefficients >> (degree - 1 - back)) & 1U) != 0) to[bit] ^= to[bit - back];
      }
    }
  }
  return all;
}

constexpr std::array<SobolNumbers, kSobolDimensions> kSobolDirections = make_sobol_directions();

constexpr std::uint32_t bits_reversed(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
  x = ((x >> 8) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8);
  return (x >> 16) | (x << 16);
}

/// Each bit is flipped, or not, by a hash of the bits above it.
constexpr std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
  x = bits_reversed(x);
  x += seed;
  x ^= x * 0x6c50b47cU;
  x ^= x * 0xb82f1e52U;
  x ^= x * 0xc7afe638U;
  x ^= x * 0x8d22f6e6U;
  return bits_reversed(x);
}

}  // namespace

double sobol_uniform(std::uint64_t seed, std::uint32_t index, int dimension) {
  if (dimension < 0 || dimension >= kSobolDimensions) {
    fail("Sobol sequence: expected dimension 0 to ", kSobolDimensions - 1, ", found ", dimension);
  }
  const SobolNumbers& directions = kSobolDirections[static_cast<std::size_t>(dimension)];
  std::uint32_t x = 0;
  for (std::uint32_t rest = index; rest != 0; rest &= rest - 1) {
    x ^= directions[static_cast<std::size_t>(std::countr_zero(rest))];
  }
  const auto of_dimension =
      static_cast<std::uint32_t>(mix_bits(mix_bits(seed) ^ static_cast<std::uint64_t>(dimension)) >> 32);
  return (static_cast<double>(scrambled(x, of_dimension)) + 0.5) * 0x1.0p-32;
}

double sobol_normal(std::uint64_t seed, std::uint32_t index, int dimension) {
  return normal_quantile(sobol_uniform(seed, index, dimension));
}

}  // namespace spinaltap
