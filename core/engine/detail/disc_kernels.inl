// Included once for each set of instructions, with SPINALTAP_VECTOR_BYTES set. Sums and products are written out in one
// order and never fused (-ffp-contract=off), so that all sets agree to the last bit.

constexpr std::size_t kLanes = SPINALTAP_VECTOR_BYTES / sizeof(float);
typedef float Floats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
typedef float LooseFloats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES), aligned(4), may_alias));
typedef std::int32_t Ints __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
typedef std::int32_t LooseInts __attribute__((vector_size(SPINALTAP_VECTOR_BYTES), aligned(4), may_alias));
typedef std::int16_t LooseShorts __attribute__((vector_size(SPINALTAP_VECTOR_BYTES / 2), aligned(2), may_alias));
typedef std::int8_t Bytes __attribute__((vector_size(SPINALTAP_VECTOR_BYTES / 4)));
typedef std::int8_t LooseBytes __attribute__((vector_size(SPINALTAP_VECTOR_BYTES / 4), aligned(1), may_alias));

#define SPINALTAP_LOAD(pointer) (*reinterpret_cast<const LooseFloats*>(pointer))
#define SPINALTAP_LOAD_SHORTS(pointer) \
  __builtin_convertvector(__builtin_convertvector(*reinterpret_cast<const LooseShorts*>(pointer), Ints), Floats)

void check(const CheckArguments& c) {
  Floats lanes;
  for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] = static_cast<float>(lane);
  for (std::size_t n = 0; n < c.count; n += kLanes) {
    const Floats z = (lanes + static_cast<float>(static_cast<std::int32_t>(n))) * c.spacing;
    const Floats dx = (c.line.x + z * c.line.x_slope) - SPINALTAP_LOAD(c.x + n);
    const Floats dy = (c.line.y + z * c.line.y_slope) - SPINALTAP_LOAD(c.y + n);
    const Floats turned_x = c.line.x_slope - SPINALTAP_LOAD(c.x_slope + n);
    const Floats turned_y = c.line.y_slope - SPINALTAP_LOAD(c.y_slope + n);
    const Floats turned = (turned_x < 0.0F ? -turned_x : turned_x) + (turned_y < 0.0F ? -turned_y : turned_y);
    const Floats back = (c.line.back + z * c.line.back_slope) - SPINALTAP_LOAD(c.back + n);
    const Floats counted = back > 0.0F ? back : c.min_back * back;
    const Floats old = SPINALTAP_LOAD(c.free + n);
    const Floats left = ((old - c.slack) - c.turn * turned) - SPINALTAP_LOAD(c.back_share + n) * counted;
    const Floats allowed = left > 0.0F ? left : Floats{} + 0.0F;
    // No square root: |(dx, dy)| < left is asked of the squares.
    const Floats across = (dx * dx + dy * dy) * c.across_share_squared;
    const Ints holds = across < allowed * allowed;
    *reinterpret_cast<LooseFloats*>(c.free + n) = holds ? old : Floats{} - 1.0F;
    *reinterpret_cast<LooseBytes*>(c.due + n) = __builtin_convertvector(holds, Bytes) + 1;
  }
}

void gap_squares(const GapArguments& arguments, GapResult& result) {
  const GapArguments g = arguments;  // which nothing that is written can be
  std::uint8_t* const reached = result.is_reached - g.begin;
  Ints lanes;
  for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] = static_cast<std::int32_t>(lane);
  Floats least = Floats{} + kNoSquare;
  for (std::size_t n = g.begin; n < g.end; n += kLanes) {
    const Ints ring = lanes + static_cast<std::int32_t>(n);
    const Ints size = 6 * ring;
    const Ints ends = reinterpret_cast<const LooseInts*>(g.ends + n)[0];
    const Ints below = ends & 0xffff;
    const Ints above = (ends >> 16) & 0xffff;
    const Ints is_beyond = ring >= static_cast<std::int32_t>(g.end);
    const Ints is_known = (below < size) & ~is_beyond;
    const Floats ax = SPINALTAP_LOAD_SHORTS(g.below_x + n);
    const Floats ay = SPINALTAP_LOAD_SHORTS(g.below_y + n);
    const Floats bx = SPINALTAP_LOAD_SHORTS(g.above_x + n);
    const Floats by = SPINALTAP_LOAD_SHORTS(g.above_y + n);
    // On which side of the directions to both ends does the middle lie? Gaps of half a turn and more hold all that does
    // not lie in the rest.
    const Floats from_below = ax * g.y - ay * g.x;
    const Floats to_above = g.x * by - g.y * bx;
    const Ints width = above - below;
    const Ints turned = width > 0 ? width : width + size;
    const Ints is_faced = 2 * turned < size ? (from_below > 0.0F) & (to_above > 0.0F)
                                            : ~((from_below < 0.0F) & (to_above < 0.0F));
    const Floats to_a = (ax - g.x) * (ax - g.x) + (ay - g.y) * (ay - g.y);
    const Floats to_b = (bx - g.x) * (bx - g.x) + (by - g.y) * (by - g.y);
    const Floats to_ends = to_a < to_b ? to_a : to_b;
    const Floats to_circle = __builtin_convertvector(ring, Floats) * g.spacing - g.off_axis;
    const Floats square = is_known & is_faced ? to_ends : to_circle * to_circle;
    const Ints lives = ~(is_beyond | (ends == static_cast<std::int32_t>(kDeadRing)));
    const Ints is_reached = lives & (square <= g.reach_square);
    const Floats other = lives & ~is_reached ? square : Floats{} + kNoSquare;
    least = other < least ? other : least;
    *reinterpret_cast<LooseBytes*>(reached + n) = -__builtin_convertvector(is_reached, Bytes);
  }
  // By halves: one after the other each would wait for the last.
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t lane = 0; lane < half; ++lane) {
      least[lane] = least[lane + half] < least[lane] ? least[lane + half] : least[lane];
    }
  }
  result.least_square = least[0];
}

#undef SPINALTAP_LOAD
#undef SPINALTAP_LOAD_SHORTS
