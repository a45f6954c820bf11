#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap::detail {

/// A line of the axis in float: x(z), y(z) and how far back from the tip it meets the plane at z; mm.
struct FloatLine {
  float x, y, x_slope, y_slope, back, back_slope;
};

/// Checks certificates: see DiscCertificates.
struct CheckArguments {
  FloatLine line;
  float spacing, across_share_squared, turn, slack, min_back;
  std::size_t count;  ///< of discs, whole vectors
  float* free;
  const float* back_share;
  const float* x;
  const float* y;
  const float* x_slope;
  const float* y_slope;
  const float* back;
  std::uint8_t* due;
};

/// Places on a ring: the occupied points at both ends of a gap of dead ones, the upper one in the upper half.
using GapEnds = std::uint32_t;
constexpr GapEnds kUnknownGap = 0xffffffff;
constexpr GapEnds kDeadRing = 0xfffefffe;
/// Beyond all rings.
constexpr float kNoSquare = 1e30F;

/// Ends of a ring's gap that may be within reach, together in a byte.
constexpr std::uint8_t kReachesBelow = 1;
constexpr std::uint8_t kReachesAbove = 2;
constexpr std::uint8_t kReachesBoth = kReachesBelow | kReachesAbove;

/// How far off the middle places count as: |v|² - (v . tilt)², squared. See DiscEllipse::off_centre().
struct FloatEllipse {
  float tilt_x, tilt_y;
  float squeeze_squared;  ///< 1 - |tilt|²
};
constexpr FloatEllipse kCircle{0.0F, 0.0F, 1.0F};

/// Least distances of rings: see RingGaps. Lengths are in its units.
struct GapArguments {
  // Of all rings of the disc, readable for a vector beyond the last: gaps, and where their ends lie.
  const GapEnds* ends;
  const std::int16_t* below_x;
  const std::int16_t* below_y;
  const std::int16_t* above_x;
  const std::int16_t* above_y;
  FloatEllipse ellipse;
  float x, y, off_axis, spacing;
  float reach_square;
  std::size_t begin, end;  ///< rings
};

/// What gap_squares finds.
struct GapResult {
  /// Rings, whole vectors from GapArguments::begin on, a byte each: the ends within reach, 0 for none.
  std::uint8_t* reached;
  float least_square;  ///< from the ends out of reach on; kNoSquare where no point lives there
};

/// One set of instructions. All sets do the same operations in the same order: their results are the same bits.
struct DiscKernels {
  const char* name;
  void (*check)(const CheckArguments&);
  void (*gap_squares)(const GapArguments&, GapResult&);

  // Of machines that are no x86 the first alone.
  static DiscKernels portable();
  static DiscKernels avx2();
  static DiscKernels avx512();
};

/// Floats of the longest vector: columns are this long or a multiple.
constexpr std::size_t kLongestVector = 16;
constexpr std::size_t whole_vectors(std::size_t count) {
  return (count + kLongestVector - 1) / kLongestVector * kLongestVector;
}

/// The sets that this machine can run; portable ones first, the fastest last.
const std::vector<DiscKernels>& disc_kernels();

}  // namespace spinaltap::detail
