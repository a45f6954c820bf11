#pragma once

#include <cstdint>

namespace spinaltap {

/// Random numbers by counter: the same seed and index give the same number, whatever thread asks, in whatever order.
/// The mixer is SplitMix64 (Steele, Lea & Flood 2014).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1).
constexpr double random_uniform(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mix_bits(mix_bits(seed) ^ index) >> 11) * 0x1.0p-53;
}

/// Standard normal (mean 0, deviation 1), by the Box-Muller transform.
double random_normal(std::uint64_t seed, std::uint64_t index);

}  // namespace spinaltap
