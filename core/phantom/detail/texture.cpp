#include "core/phantom/detail/texture.h"

#include <cmath>

#include "core/base/random.h"

namespace spinaltap {
namespace {

/// One over the deviation of the raw noise, measured over ten million points.
constexpr double kUnitDeviation = 3.70;

double fade(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }
double mix(double a, double b, double t) { return a + t * (b - a); }

/// Product of the offset with one of the twelve edge directions of a cube (Perlin's sixteen, four of them twice).
double slope(std::uint64_t hash, double x, double y, double z) {
  const unsigned h = static_cast<unsigned>(hash >> 60);
  const double u = h < 8 ? x : y;
  const double v = h < 4 ? y : (h == 12 || h == 14) ? x : z;
  return ((h & 1U) != 0 ? -u : u) + ((h & 2U) != 0 ? -v : v);
}

}  // namespace

Texture::Texture(const Vec3& grain_mm, std::uint64_t seed)
    : inverse_grain_(grain_mm.cwiseInverse()), seed_(mix_bits(seed)) {}

double Texture::at(const Vec3& p_mm) const {
  const Vec3 p = p_mm.cwiseProduct(inverse_grain_);
  const double fx = std::floor(p.x()), fy = std::floor(p.y()), fz = std::floor(p.z());
  const double x = p.x() - fx, y = p.y() - fy, z = p.z() - fz;
  const auto cell = [](double f) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(f)); };
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  const auto corner = [&](std::uint64_t i, std::uint64_t j, std::uint64_t k) {
    const std::uint64_t key =
        ((cell(fx) + i) & kMask) | ((cell(fy) + j) & kMask) << 21 | ((cell(fz) + k) & kMask) << 42;
    return slope(mix_bits(seed_ ^ key), x - static_cast<double>(i), y - static_cast<double>(j),
                 z - static_cast<double>(k));
  };
  const double u = fade(x), v = fade(y), w = fade(z);
  const auto row = [&](std::uint64_t j, std::uint64_t k) { return mix(corner(0, j, k), corner(1, j, k), u); };
  return kUnitDeviation * mix(mix(row(0, 0), row(1, 0), v), mix(row(0, 1), row(1, 1), v), w);
}

}  // namespace spinaltap
