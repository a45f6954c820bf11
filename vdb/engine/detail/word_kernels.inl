// Compiled once for each set of instructions: see kernel_sets.h.

#include "vdb/engine/detail/word_kernels.h"

#if SPINALTAP_VECTOR_BYTES > 16
#ifndef __clang__
// GCC 12's header passes a register on purpose that nothing has written.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#endif

namespace spinaltap::detail {
namespace {

constexpr unsigned kLanes = SPINALTAP_VECTOR_BYTES / sizeof(float);
typedef float Floats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
typedef std::int32_t Ints __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));

inline Floats all(float value) { return Floats{} + value; }

#if SPINALTAP_VECTOR_BYTES == 64
/// Those lanes of a row of which something holds.
using Lanes = std::uint16_t;
inline Lanes not_above(Floats a, Floats b) {
  return _mm512_cmp_ps_mask(reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b), _CMP_LE_OQ);
}
inline Floats choose(Lanes lanes, Floats there, Floats else_where) {
  return reinterpret_cast<Floats>(
      _mm512_mask_blend_ps(lanes, reinterpret_cast<__m512>(else_where), reinterpret_cast<__m512>(there)));
}
inline Lanes living(std::uint64_t alive, unsigned bit) { return static_cast<Lanes>(alive >> bit); }
inline std::uint64_t bits(Lanes lanes) { return lanes; }
inline Floats roots(Floats squares) {
  return reinterpret_cast<Floats>(_mm512_sqrt_ps(reinterpret_cast<__m512>(squares)));
}
inline Floats less(Floats a, Floats b) {
  return reinterpret_cast<Floats>(_mm512_min_ps(reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b)));
}
inline Floats more(Floats a, Floats b) {
  return reinterpret_cast<Floats>(_mm512_max_ps(reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b)));
}
inline float least_of(Floats lanes) { return _mm512_reduce_min_ps(reinterpret_cast<__m512>(lanes)); }
#else
using Lanes = Ints;
inline Lanes not_above(Floats a, Floats b) { return a <= b; }
inline Floats choose(Lanes lanes, Floats there, Floats else_where) { return lanes ? there : else_where; }
inline Lanes living(std::uint64_t alive, unsigned bit) {
  constexpr std::uint64_t kAllLanes = (std::uint64_t{1} << kLanes) - 1;
  Ints lane_bit;
  for (unsigned lane = 0; lane < kLanes; ++lane) lane_bit[lane] = static_cast<std::int32_t>(1U << lane);
  return (lane_bit & static_cast<std::int32_t>(alive >> bit & kAllLanes)) != 0;
}
inline Floats less(Floats a, Floats b) { return a < b ? a : b; }
inline Floats more(Floats a, Floats b) { return a > b ? a : b; }
#if SPINALTAP_VECTOR_BYTES == 32
inline std::uint64_t bits(Lanes lanes) {
  return static_cast<std::uint64_t>(static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(lanes))));
}
inline Floats roots(Floats squares) {
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(squares)));
}
inline float least_of(Floats lanes) {
  const __m256 all = reinterpret_cast<__m256>(lanes);
  __m128 half = _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
  half = _mm_min_ps(half, _mm_movehl_ps(half, half));
  return _mm_cvtss_f32(_mm_min_ss(half, _mm_shuffle_ps(half, half, 1)));
}
#else
inline std::uint64_t bits(Lanes lanes) {
  std::uint64_t found = 0;
  for (unsigned lane = 0; lane < kLanes; ++lane) found |= static_cast<std::uint64_t>(lanes[lane] & 1) << lane;
  return found;
}
inline Floats roots(Floats squares) {
  for (unsigned lane = 0; lane < kLanes; ++lane) squares[lane] = __builtin_sqrtf(squares[lane]);
  return squares;
}
inline float least_of(Floats lanes) {
  float least = lanes[0];
  for (unsigned lane = 1; lane < kLanes; ++lane) least = lanes[lane] < least ? lanes[lane] : least;
  return least;
}
#endif
#endif

/// Seen from the tool: two directions across its axis, and back along it.
struct Places {
  Floats a, b, back;
};

/// A word's, seen from one end of the tool's way.
struct WordPlace {
  Floats first[3];  ///< of bit 0, in all lanes
  const WordOffsets* offsets;

  WordPlace() = default;
  WordPlace(const LeafPlace& place, float word) : offsets(place.offsets) {
    for (std::size_t n = 0; n < 3; ++n) first[n] = all(place.first[n] + word * place.per_x[n]);
  }
  /// Of bits from `bit` on.
  Places at(unsigned bit) const {
    const auto along = [&](std::size_t n) {
      return first[n] + *reinterpret_cast<const Floats*>(offsets->of_bits[n] + bit);
    };
    return {along(0), along(1), along(2)};
  }
};

/// A word's, at the begin of the tool's way and after each of its pieces.
struct WordPlaces {
  WordPlace after[LeafArguments::kMostPieces + 1];
  unsigned last;

  WordPlaces(const LeafArguments& leaf, float word) : last(leaf.piece_count) {
    for (unsigned n = 0; n <= last; ++n) after[n] = WordPlace(leaf.places[n], word);
  }
  Places at_end(unsigned bit) const { return after[last].at(bit); }
};

inline bool has_living(std::uint64_t alive, unsigned bit) {
  constexpr std::uint64_t kAllLanes = (std::uint64_t{1} << kLanes) - 1;
  return (alive >> bit & kAllLanes) != 0;
}

/// Where nothing but a ball, or nothing but a cylinder, can have come near: squares decide, and of a voxel that the
/// tool came near to its chord does (see SweptBit), whose nearest place to the ball's centre or the cylinder's axis is
/// worked out. What lies within rounding of the wall, or passes beside the piece's ends, stays unsure.
[[gnu::always_inline]] inline void look_round(const LeafArguments& leaf, const WordTool::Piece& piece, bool is_ball,
                                              WordResult* words) {
  const WordTool& tool = *leaf.tool;
  const float centre = piece.ball_centre;
  const float radius = is_ball ? piece.ball_radius : -piece.at_origin;
  const float in = radius - tool.spare, out = radius + (tool.skin + tool.spare), near = radius + leaf.body;
  const Floats in_square = all(in > 0.0F ? in * in : -1.0F), out_square = all(out * out),
               near_square = all(near * near);
  const Floats begin = all(piece.begin + tool.spare), end = all(piece.end - tool.spare);
  const Floats far = all(1e30F);
  for (unsigned word = 0; word < 8; ++word) {
    if ((leaf.due >> word & 1U) == 0) continue;
    const std::uint64_t alive = leaf.words[word];
    const auto x = static_cast<float>(word);
    const WordPlaces places(leaf, x);
    Floats least_off = far, least = far;
    std::uint64_t unsure_bits = 0, dead_bits = 0;
    for (unsigned bit = 0; bit < 64; bit += kLanes) {
      if (!has_living(alive, bit)) continue;
      const Places at = places.at_end(bit);
      const Floats up = at.back - centre;
      const Floats off_square = at.a * at.a + at.b * at.b;
      const Floats square = is_ball ? off_square + up * up : off_square;
      const Lanes lives = living(alive, bit);
      Lanes dead = lives & not_above(square, in_square) & not_above(begin, at.back) & not_above(at.back, end);
      const Lanes near_ones = lives & ~dead & not_above(square, near_square);
      Lanes unsure{};
      if (bits(near_ones) != 0) {
        Lanes passed{};
        Places to = at;
        for (unsigned way = places.last; way-- > 0;) {
          const Places from = places.after[way].at(bit);
          const Floats from_up = from.back - centre;
          const Floats way_a = to.a - from.a, way_b = to.b - from.b, way_back = to.back - from.back;
          Floats towards = from.a * way_a + from.b * way_b, length_square = way_a * way_a + way_b * way_b;
          if (is_ball) {
            towards = towards + from_up * way_back;
            length_square = length_square + way_back * way_back;
          }
          const Floats share = less(more(Floats{} - towards / more(length_square, all(1e-30F)), Floats{}), all(1.0F));
          const Floats a = from.a + share * way_a, b = from.b + share * way_b, back = from.back + share * way_back;
          const Floats nearest_up = back - centre;
          const Floats nearest_off = a * a + b * b;
          const Floats nearest = is_ball ? nearest_off + nearest_up * nearest_up : nearest_off;
          const Lanes held = not_above(nearest, in_square) & not_above(begin, back) & not_above(back, end);
          passed |= held;
          unsure |= not_above(nearest, out_square);
          to = from;
        }
        passed &= near_ones;
        unsure &= near_ones & ~passed;
        unsure_bits |= bits(unsure) << bit;
        dead |= passed;
      }
      dead_bits |= bits(dead) << bit;
      const Lanes other = lives & ~dead & ~unsure;
      if (!is_ball || leaf.wants_cylinder) least_off = less(least_off, choose(other, off_square, far));
      if (is_ball) least = less(least, choose(other, square, far));
    }
    const float off = !is_ball || leaf.wants_cylinder ? __builtin_sqrtf(least_of(least_off)) : 0.0F;
    const float from = (is_ball ? __builtin_sqrtf(least_of(least)) : off) - radius;
    const float cylinder = off - tool.radius;
    // Where there is no cone, or the cylinder bounds what is near, its bound is as good as the cone's.
    words[word] = {unsure_bits, dead_bits, cylinder, cylinder, from};
  }
}

/// Lower bounds of the distance from the tool.
struct Bounds {
  Floats off, back, body, deep;
};

/// `deep`: below 0 only where the tool holds the place.
inline Bounds bounds_at(const LeafArguments& leaf, const Places& at) {
  const WordTool& tool = *leaf.tool;
  const Floats off_square = at.a * at.a + at.b * at.b;
  const Floats off = roots(off_square);
  Floats body = all(leaf.rest), deep = all(1e30F);
  for (unsigned left = leaf.pieces; left != 0; left &= left - 1) {
    const WordTool::Piece& piece = tool.pieces[__builtin_ctz(left)];
    const Floats beyond = more(piece.begin - at.back, at.back - piece.end);
    if (piece.ball_radius > 0.0F) {
      const Floats from_centre = at.back - piece.ball_centre;
      const Floats from = roots(from_centre * from_centre + off_square) - piece.ball_radius;
      body = less(body, from);
      deep = less(deep, more(from, beyond));
    } else {
      const Floats side = (piece.per_off * off + piece.per_back * at.back) + piece.at_origin;
      const Floats from = more(side, beyond);
      body = less(body, from);
      deep = less(deep, from);
    }
  }
  return {off, at.back, body, deep};
}

/// Where several pieces may have come near.
inline void look_all(const LeafArguments& leaf, WordResult* words) {
  const WordTool& tool = *leaf.tool;
  const Floats far = all(1e30F);
  for (unsigned word = 0; word < 8; ++word) {
    if ((leaf.due >> word & 1U) == 0) continue;
    const std::uint64_t alive = leaf.words[word];
    const auto x = static_cast<float>(word);
    const WordPlaces places(leaf, x);
    Floats least_cylinder = far, least_cone = far, least_body = far;
    std::uint64_t unsure_bits = 0, dead_bits = 0;
    for (unsigned bit = 0; bit < 64; bit += kLanes) {
      if (!has_living(alive, bit)) continue;
      const Bounds at = bounds_at(leaf, places.at_end(bit));
      const Floats cylinder = at.off - tool.radius;
      const Floats cone = (at.off - tool.cone_offset) - tool.cone_slope * at.back;
      const Lanes lives = living(alive, bit);
      const Lanes dead = lives & not_above(at.deep, all(-tool.spare));
      Lanes unsure = lives & ~dead & not_above(cylinder, all(leaf.cylinder)) & not_above(cone, all(leaf.cone)) &
                     not_above(at.body, all(leaf.body));
      if (bits(unsure) != 0) {
        // A bound does not fall faster than the tool moves: half of what both ends leave of the way is left between.
        Lanes reached{};
        Floats after = at.body;
        for (unsigned way = places.last; way-- > 0;) {
          const Floats before = bounds_at(leaf, places.after[way].at(bit)).body;
          reached |= not_above(after + before, all(leaf.piece));
          after = before;
        }
        unsure &= reached;
        unsure_bits |= bits(unsure) << bit;
      }
      dead_bits |= bits(dead) << bit;
      const Lanes other = lives & ~dead & ~unsure;
      least_cylinder = less(least_cylinder, choose(other, cylinder, far));
      least_cone = less(least_cone, choose(other, cone, far));
      least_body = less(least_body, choose(other, at.body, far));
    }
    words[word] = {unsure_bits, dead_bits, least_of(least_cylinder), least_of(least_cone), least_of(least_body)};
  }
}

void look(const LeafArguments& leaf, WordResult* words) {
  if ((leaf.pieces & (leaf.pieces - 1)) == 0) {
    const WordTool::Piece& piece = leaf.tool->pieces[__builtin_ctz(leaf.pieces)];
    if (piece.ball_radius > 0.0F) return look_round(leaf, piece, true, words);
    if (piece.per_back == 0.0F) return look_round(leaf, piece, false, words);
  }
  look_all(leaf, words);
}

}  // namespace

WordKernels WordKernels::SPINALTAP_KERNEL_SET() { return {SPINALTAP_KERNEL_NAME, detail::look}; }

}  // namespace spinaltap::detail
