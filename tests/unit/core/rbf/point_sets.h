#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/random.h"

namespace spinaltap::test {

/// The n-th of evenly distributed places in a cube of half width `reach_mm` around the origin.
inline Vec3 random_place(std::uint64_t seed, std::uint64_t n, double reach_mm = 10.0) {
  const auto coordinate = [&](std::uint64_t axis) {
    return reach_mm * (2.0 * random_uniform(seed, 3 * n + axis) - 1.0);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

inline std::vector<Vec3> random_points(std::size_t count, std::uint64_t seed, double reach_mm = 10.0) {
  std::vector<Vec3> points_mm;
  for (std::size_t i = 0; i < count; ++i) points_mm.push_back(random_place(seed, i, reach_mm));
  return points_mm;
}

/// Points of a ball's surface, evenly spread by the golden angle.
inline std::vector<Vec3> ball_points(std::size_t count, double radius_mm = 10.0) {
  std::vector<Vec3> points_mm;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
    const double off = std::sqrt(1.0 - z * z);
    points_mm.push_back(radius_mm * Vec3(off * std::cos(angle), off * std::sin(angle), z));
  }
  return points_mm;
}

/// Eight clusters of equally many points at random places, each five times smaller than the one before: the densities
/// differ by a factor of 10^9 and more.
inline std::vector<Vec3> clustered_points(std::size_t count, std::uint64_t seed, double reach_mm = 10.0) {
  constexpr std::size_t kClusters = 8;
  std::vector<Vec3> points_mm;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t cluster = i % kClusters;
    const double size_mm = reach_mm * std::pow(0.2, static_cast<double>(cluster));
    points_mm.push_back(random_place(seed, cluster, reach_mm) + random_place(seed + 1, i, size_mm));
  }
  return points_mm;
}

inline std::vector<double> random_weights(std::size_t count, std::uint64_t seed) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(random_normal(seed, i));
  return weights;
}

}  // namespace spinaltap::test
