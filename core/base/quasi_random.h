#pragma once

#include <cstdint>

namespace spinaltap {

/// How many dimensions sobol_uniform() has.
inline constexpr int kSobolDimensions = 12;

/// Number `index` of a Sobol sequence, scrambled by `seed`: uniform in (0, 1), spread more evenly than random numbers,
/// most evenly in whole powers of two. By counter: the same whatever thread asks, in whatever order. Directions: Joe &
/// Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 2008. Scrambling:
/// Owen's, by Burley, "Practical hash-based Owen scrambling", J. Comput. Graph. Tech. 2020. Throws Error on a dimension
/// that there is not.
double sobol_uniform(std::uint64_t seed, std::uint32_t index, int dimension);

/// The same, as standard normal numbers (mean 0, deviation 1).
double sobol_normal(std::uint64_t seed, std::uint32_t index, int dimension);

}  // namespace spinaltap
