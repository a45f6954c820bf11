// Included once for each set of instructions, with SPINALTAP_VECTOR_BYTES set. Sums and products are written out in one
// order and never fused (-ffp-contract=off), so that all sets agree to the last bit.

constexpr unsigned kLanes = SPINALTAP_VECTOR_BYTES / sizeof(float);
typedef float Floats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
typedef std::int32_t Ints __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));

#if SPINALTAP_VECTOR_BYTES == 64
#define SPINALTAP_ROOTS(squares) reinterpret_cast<Floats>(_mm512_sqrt_ps(reinterpret_cast<__m512>(squares)))
#define SPINALTAP_BITS(lanes) static_cast<std::uint64_t>(_mm512_movepi32_mask(reinterpret_cast<__m512i>(lanes)))
#elif SPINALTAP_VECTOR_BYTES == 32
#define SPINALTAP_ROOTS(squares) reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(squares)))
#define SPINALTAP_BITS(lanes) static_cast<std::uint64_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(lanes)))
#else
inline Floats roots(Floats squares) {
  for (unsigned lane = 0; lane < kLanes; ++lane) squares[lane] = std::sqrt(squares[lane]);
  return squares;
}
inline std::uint64_t bits(Ints lanes) {
  std::uint64_t found = 0;
  for (unsigned lane = 0; lane < kLanes; ++lane) found |= static_cast<std::uint64_t>(lanes[lane] & 1) << lane;
  return found;
}
#define SPINALTAP_ROOTS(squares) roots(squares)
#define SPINALTAP_BITS(lanes) bits(lanes)
#endif

inline Floats less(Floats a, Floats b) { return a < b ? a : b; }
inline Floats more(Floats a, Floats b) { return a > b ? a : b; }

inline float least_of(Floats lanes) {
#if SPINALTAP_VECTOR_BYTES > 16
  // By halves: lane after lane would take as long as all else together.
  Ints from;
  for (unsigned half = kLanes / 2; half > 0; half /= 2) {
    for (unsigned lane = 0; lane < kLanes; ++lane) from[lane] = static_cast<std::int32_t>(lane ^ half);
    lanes = less(lanes, __builtin_shuffle(lanes, from));
  }
  return lanes[0];
#else
  float least = lanes[0];
  for (unsigned lane = 1; lane < kLanes; ++lane) least = lanes[lane] < least ? lanes[lane] : least;
  return least;
#endif
}

/// Lower bounds of the distance from the tool.
struct Bounds {
  Floats off, back, body, deep;
};

/// At bits from `bit` on. `deep`: below 0 only where the tool holds the place.
inline Bounds bounds_at(const WordTool& tool, const LeafPlace& place, float word, unsigned bit) {
  const auto along = [&](std::size_t n) {
    return (place.first[n] + word * place.per_x[n]) +
           *reinterpret_cast<const Floats*>(place.offsets->of_bits[n].data() + bit);
  };
  const Floats a = along(0), b = along(1), back = along(2);
  const Floats off_square = a * a + b * b;
  const Floats off = SPINALTAP_ROOTS(off_square);
  Floats body = Floats{} + 1e30F, deep = body;
  for (std::size_t n = 0; n < tool.piece_count; ++n) {
    const WordTool::Piece& piece = tool.pieces[n];
    const Floats beyond = more(piece.begin - back, back - piece.end);
    if (piece.ball_radius > 0.0F) {
      const Floats from_centre = back - piece.ball_centre;
      const Floats from = SPINALTAP_ROOTS(from_centre * from_centre + off_square) - piece.ball_radius;
      body = less(body, from);
      deep = less(deep, more(from, beyond));
    } else {
      const Floats side = (piece.per_off * off + piece.per_back * back) + piece.at_origin;
      const Floats from = more(side, beyond);
      body = less(body, from);
      deep = less(deep, from);
    }
  }
  return {off, back, body, deep};
}

void look(const LeafArguments& leaf, WordResult* words) {
  constexpr std::uint64_t kAllLanes = (std::uint64_t{1} << kLanes) - 1;
  const WordTool& tool = *leaf.tool;
  const Floats far = Floats{} + 1e30F;
  Ints lane_bit;
  for (unsigned lane = 0; lane < kLanes; ++lane) lane_bit[lane] = static_cast<std::int32_t>(1U << lane);
  for (unsigned word = 0; word < 8; ++word) {
    if ((leaf.due >> word & 1U) == 0) continue;
    const std::uint64_t alive = leaf.words[word];
    const auto x = static_cast<float>(word);
    Floats least_cylinder = far, least_cone = far, least_body = far;
    std::uint64_t unsure_bits = 0, inside_bits = 0;
    for (unsigned bit = 0; bit < 64; bit += kLanes) {
      const auto row = static_cast<std::int32_t>(alive >> bit & kAllLanes);
      if (row == 0) continue;
      const Bounds at = bounds_at(tool, leaf.end, x, bit);
      const Floats cylinder = at.off - tool.radius;
      const Floats cone = (at.off - tool.cone_offset) - tool.cone_slope * at.back;
      const Ints lives = (lane_bit & row) != 0;
      const Ints inside = lives & (at.deep <= -tool.spare);
      Ints unsure = lives & ~inside & (cylinder <= leaf.cylinder) & (cone <= leaf.cone) & (at.body <= leaf.body);
      const std::uint64_t inside_row = SPINALTAP_BITS(inside);
      std::uint64_t unsure_row = SPINALTAP_BITS(unsure);
      if (unsure_row != 0) {
        // A bound does not fall faster than the tool moves: half of what both ends leave of the way is left between.
        const Bounds before = bounds_at(tool, leaf.begin, x, bit);
        unsure &= at.body + before.body <= leaf.body;
        unsure_row = SPINALTAP_BITS(unsure);
      }
      const Ints other = lives & ~inside & ~unsure;
      least_cylinder = less(least_cylinder, other ? cylinder : far);
      least_cone = less(least_cone, other ? cone : far);
      least_body = less(least_body, other ? at.body : far);
      inside_bits |= inside_row << bit;
      unsure_bits |= unsure_row << bit;
    }
    words[word] = {unsure_bits, inside_bits, least_of(least_cylinder), least_of(least_cone), least_of(least_body)};
  }
}

#undef SPINALTAP_ROOTS
#undef SPINALTAP_BITS
