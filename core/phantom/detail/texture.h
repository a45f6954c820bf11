#pragma once

#include <cstdint>

#include "core/base/geometry.h"

namespace spinaltap {

/// A random pattern of space with one grain size: gradient noise (Perlin 2002) on a lattice whose gradients come from a
/// counter hash instead of a table, so that every seed has its own pattern without a period. Mean 0, standard deviation
/// about 1, never beyond 4.
class Texture {
 public:
  /// `grain_mm`: lattice steps along x, y and z, above 0.
  Texture(const Vec3& grain_mm, std::uint64_t seed);

  double at(const Vec3& p_mm) const;

 private:
  Vec3 inverse_grain_;
  std::uint64_t seed_;
};

}  // namespace spinaltap
