// Compiled once for each set of instructions: see kernel_sets.h.

#include "core/engine/detail/disc_kernels.h"

namespace spinaltap::detail {
namespace {

constexpr std::size_t kLanes = SPINALTAP_VECTOR_BYTES / sizeof(float);
typedef float Floats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES)));
typedef float LooseFloats __attribute__((vector_size(SPINALTAP_VECTOR_BYTES), aligned(4), may_alias));
typedef float Quads __attribute__((vector_size(16)));
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
  std::uint8_t* const reached = result.reached - g.begin;
  const float tilt = 2.0F * (1.0F - g.ellipse.squeeze_squared);
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
    const Ints is_faced =
        2 * turned < size ? (from_below > 0.0F) & (to_above > 0.0F) : ~((from_below < 0.0F) & (to_above < 0.0F));
    // Along the rest of the ring points are ever further off: see DiscEllipse::far_round(). The last term is for the
    // ends' rounding.
    const Floats radius = __builtin_convertvector(ring, Floats) * g.spacing;
    const Floats far_round = tilt * ((radius + g.off_axis) * radius) + g.off_axis;
    const Floats dax = ax - g.x, day = ay - g.y, dbx = bx - g.x, dby = by - g.y;
    const Floats along_a = dax * g.ellipse.tilt_x + day * g.ellipse.tilt_y;
    const Floats along_b = dbx * g.ellipse.tilt_x + dby * g.ellipse.tilt_y;
    const Floats square_a = dax * dax + day * day;
    const Floats square_b = dbx * dbx + dby * dby;
    const Floats to_a = from_below > far_round ? square_a - along_a * along_a : square_a * g.ellipse.squeeze_squared;
    const Floats to_b = to_above > far_round ? square_b - along_b * along_b : square_b * g.ellipse.squeeze_squared;
    const Floats from_circle = radius - g.off_axis;
    const Floats to_circle = from_circle * from_circle * g.ellipse.squeeze_squared;
    const Ints has_ends = is_known & is_faced;
    const Floats below_square = has_ends ? to_a : to_circle;
    const Floats above_square = has_ends ? to_b : to_circle;
    const Ints lives = ~(is_beyond | (ends == static_cast<std::int32_t>(kDeadRing)));
    const Ints reaches_below = lives & (below_square <= g.reach_square);
    const Ints reaches_above = lives & (above_square <= g.reach_square);
    const Floats other_below = lives & ~reaches_below ? below_square : Floats{} + kNoSquare;
    const Floats other_above = lives & ~reaches_above ? above_square : Floats{} + kNoSquare;
    const Floats other = other_below < other_above ? other_below : other_above;
    least = other < least ? other : least;
    *reinterpret_cast<LooseBytes*>(reached + n) =
        __builtin_convertvector((reaches_below & kReachesBelow) | (reaches_above & kReachesAbove), Bytes);
  }
  // By quarters and halves: lane after lane each would wait for the last.
  Quads quads[kLanes / 4];
  __builtin_memcpy(quads, &least, sizeof(least));
  Quads few = quads[0];
  for (std::size_t n = 1; n < kLanes / 4; ++n) few = quads[n] < few ? quads[n] : few;
  const Quads halves = __builtin_shufflevector(few, few, 2, 3, 0, 1);
  few = halves < few ? halves : few;
  result.least_square = few[1] < few[0] ? few[1] : few[0];
}

}  // namespace

DiscKernels DiscKernels::SPINALTAP_KERNEL_SET() { return {SPINALTAP_KERNEL_NAME, detail::check, detail::gap_squares}; }

}  // namespace spinaltap::detail
