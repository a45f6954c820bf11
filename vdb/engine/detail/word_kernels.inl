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
inline Lanes is_zero(Ints a) { return _mm512_cmpeq_epi32_mask(reinterpret_cast<__m512i>(a), _mm512_setzero_si512()); }
inline Lanes occupied_lanes(std::uint64_t word, unsigned bit) { return static_cast<Lanes>(word >> bit); }
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
inline Lanes is_zero(Ints a) { return a == 0; }
inline Lanes occupied_lanes(std::uint64_t word, unsigned bit) {
  constexpr std::uint64_t kAllLanes = (std::uint64_t{1} << kLanes) - 1;
  Ints lane_bit;
  for (unsigned lane = 0; lane < kLanes; ++lane) lane_bit[lane] = static_cast<std::int32_t>(1U << lane);
  return (lane_bit & static_cast<std::int32_t>(word >> bit & kAllLanes)) != 0;
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

inline bool has_occupied(std::uint64_t word, unsigned bit) {
  constexpr std::uint64_t kAllLanes = (std::uint64_t{1} << kLanes) - 1;
  return (word >> bit & kAllLanes) != 0;
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

void look_at_words(const LeafArguments& leaf, WordResult* words) {
  const WordTool& tool = *leaf.tool;
  const Floats far = all(1e30F);
  for (unsigned word = 0; word < 8; ++word) {
    const std::uint64_t occupied = leaf.words[word];
    if (occupied == 0) continue;
    const auto x = static_cast<float>(word);
    const WordPlaces places(leaf, x);
    Floats least_cylinder = far, least_cone = far, least_body = far;
    std::uint64_t unsure_bits = 0, dead_bits = 0;
    for (unsigned bit = 0; bit < 64; bit += kLanes) {
      if (!has_occupied(occupied, bit)) continue;
      const Bounds at = bounds_at(leaf, places.at_end(bit));
      const Floats cylinder = at.off - tool.radius;
      const Floats cone = (at.off - tool.cone_offset) - tool.cone_slope * at.back;
      const Lanes lives = occupied_lanes(occupied, bit);
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

/// Rows of eight voxels, a lane each.
typedef std::uint8_t Bytes __attribute__((vector_size(kLanes)));
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "byte n of a word is its row n");

inline Ints rows_at(const std::uint64_t* words, unsigned row) {
  Bytes bytes;
  __builtin_memcpy(&bytes, reinterpret_cast<const unsigned char*>(words) + row, kLanes);
  return __builtin_convertvector(bytes, Ints);
}
inline void put_rows(std::uint64_t* words, unsigned row, Ints rows) {
  const Bytes bytes = __builtin_convertvector(rows, Bytes);
  __builtin_memcpy(reinterpret_cast<unsigned char*>(words) + row, &bytes, kLanes);
}
inline bool has_any(const std::uint64_t* words, unsigned row) {
  if (kLanes < 8) return (words[row / 8] >> (8 * (row % 8)) & 0xFFFFFFFFU) != 0;
  std::uint64_t any = 0;
  for (unsigned n = row / 8; n < (row + kLanes) / 8; ++n) any |= words[n];
  return any != 0;
}

/// Words with y and z swapped, which are their own undoing.
inline void swap_rows(std::uint64_t* words) {
  for (unsigned n = 0; n < 8; ++n) {
    std::uint64_t word = words[n];
    std::uint64_t other = (word ^ word >> 7) & 0x00AA00AA00AA00AAU;
    word ^= other ^ other << 7;
    other = (word ^ word >> 14) & 0x0000CCCC0000CCCCU;
    word ^= other ^ other << 14;
    other = (word ^ word >> 28) & 0x00000000F0F0F0F0U;
    words[n] = word ^ other ^ other << 28;
  }
}

struct RowWords {
  alignas(64) std::uint64_t words[8];
  RowWords() : words{} {}
  RowWords(const std::uint64_t* leaf, bool along_y) {
    __builtin_memcpy(words, leaf, sizeof words);
    if (along_y) swap_rows(words);
  }
};

/// Where rows lie in their leaf.
struct RowPlaces {
  alignas(64) float x[64], y[64];
};
constexpr RowPlaces kRows = [] {
  RowPlaces rows{};
  for (unsigned n = 0; n < 64; ++n) {
    rows.x[n] = static_cast<float>(n / 8);
    rows.y[n] = static_cast<float>(n % 8);
  }
  return rows;
}();

/// Rows against a ball or a cylinder: the square of the distance is `square` + `bend` (z - `at`)^2.
struct RowSquares {
  Floats at, square, along;  ///< `along`: the axis, of z = 0
};

inline float bend_of(const RoundPlace& place, bool is_ball) {
  return is_ball ? 1.0F : 1.0F - place.axis[2] * place.axis[2];
}
[[gnu::always_inline]] inline RowSquares squares_at(const RoundPlace& place, bool is_ball, float per_bend,
                                                    unsigned row) {
  const Floats x = *reinterpret_cast<const Floats*>(kRows.x + row) + place.first[0];
  const Floats y = *reinterpret_cast<const Floats*>(kRows.y + row) + place.first[1];
  const float z = place.first[2];
  const Floats along = (x * place.axis[0] + y * place.axis[1]) + z * place.axis[2];
  if (is_ball) return {all(-z), x * x + y * y, along};
  const Floats slope = z - along * place.axis[2];
  const Floats at = slope * -per_bend;
  return {at, ((x * x + y * y) + (z * z - along * along)) + slope * at, along};
}

/// Whole part of what lies within 0 to 8, of the nearer of these else.
inline Ints whole(Floats value) { return __builtin_convertvector(less(more(value, Floats{}), all(8.0F)), Ints); }
inline Ints one_at(Ints bit) { return (Ints{} + 1) << bit; }
/// Bits from the whole part of `begin` up to, without it, that of `end`.
inline Ints bits_between(Floats begin, Floats end) {
  const Ints bits = one_at(whole(end)) - one_at(whole(begin));
  return bits > 0 ? bits : Ints{};
}

/// Which bit of a row is its highest; a float's exponent tells.
inline Floats highest(Ints row) {
  const Ints exponent = reinterpret_cast<Ints>(__builtin_convertvector(row, Floats)) >> 23;
  return __builtin_convertvector(exponent - 127, Floats);
}
/// Least squares of rows' voxels: of the nearest on either side; 1e30 of rows without any.
[[gnu::always_inline]] inline Floats nearest(const RowSquares& squares, float bend, Ints voxels) {
  const Floats far = all(1e15F);
  const Ints below = voxels & (one_at(whole(squares.at + 1.0F)) - 1);
  const Ints above = voxels ^ below;
  const Floats down = choose(is_zero(below), far, squares.at - highest(below));
  const Floats up = choose(is_zero(above), far, highest(above & -above) - squares.at);
  return squares.square + less(down * down, up * up) * bend;
}

/// Which voxels of rows lie no further off than the root of `square`, or surely nearer where `tolerance` is below 0.
[[gnu::always_inline]] inline Ints within(const RowSquares& squares, float per_bend, float square, float tolerance,
                                          Lanes rows) {
  const Floats half_square = (square - squares.square) * per_bend;
  const Floats half = choose(rows & not_above(Floats{}, half_square), roots(more(half_square, Floats{})), all(-1.0F));
  // From the first voxel not before the begin to the last not behind the end.
  return bits_between((squares.at - half) + (1.0F - tolerance), (squares.at + half) + (1.0F + tolerance));
}

/// Rows that lie between a place's ends.
inline Lanes between_ends(const RowSquares& squares, const RoundPlace& place) {
  const Floats last = squares.along + 7.0F * place.axis[2];
  return not_above(all(place.low), less(squares.along, last)) & not_above(more(squares.along, last), all(place.high));
}

[[gnu::always_inline]] inline float look_at_rows(const RowArguments& rows, bool is_ball, const RowWords& occupied,
                                                 RowWords& dead, RowWords& unsure) {
  const Floats out = all(rows.out_square);
  Floats least = all(1e30F);
  for (unsigned row = 0; row < 64; row += kLanes) {
    if (!has_any(occupied.words, row)) continue;
    const Ints lives = rows_at(occupied.words, row);
    Ints held{}, reached{};
    RowSquares squares{};
    float bend = 1.0F;
    for (unsigned n = rows.place_count; n-- > 0;) {
      const RoundPlace& place = rows.places[n];
      bend = bend_of(place, is_ball);
      const float per_bend = 1.0F / bend;
      squares = squares_at(place, is_ball, per_bend, row);
      const Lanes near = not_above(squares.square, out);
      if (bits(near) == 0) continue;
      const Lanes between = rows.has_ends ? near & between_ends(squares, place) : near;
      held |= within(squares, per_bend, rows.in_square, -rows.tolerance, between);
      reached |= within(squares, per_bend, rows.out_square, rows.tolerance, near);
    }
    held &= lives;
    reached &= lives & ~held;
    put_rows(dead.words, row, held);
    put_rows(unsure.words, row, reached);
    least = less(least, nearest(squares, bend, lives ^ held ^ reached));
  }
  return least_of(least);
}

float look_at_rows(const RowArguments& rows, std::uint64_t* dead, std::uint64_t* unsure) {
  const RowWords occupied(rows.words, rows.along_y);
  RowWords dead_here, unsure_here;
  const float least = rows.is_ball ? look_at_rows(rows, true, occupied, dead_here, unsure_here)
                                   : look_at_rows(rows, false, occupied, dead_here, unsure_here);
  if (rows.along_y) {
    swap_rows(dead_here.words);
    swap_rows(unsure_here.words);
  }
  for (unsigned n = 0; n < 8; ++n) {
    dead[n] |= dead_here.words[n];
    unsure[n] |= unsure_here.words[n];
  }
  return least;
}

}  // namespace

WordKernels WordKernels::SPINALTAP_KERNEL_SET() {
  return {SPINALTAP_KERNEL_NAME, detail::look_at_words, detail::look_at_rows};
}

}  // namespace spinaltap::detail
