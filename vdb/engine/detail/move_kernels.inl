// Compiled once for each set of instructions: see kernel_sets.h. Compilers make vectors of the loop.

#include "vdb/engine/detail/move_kernels.h"

namespace spinaltap::detail {
namespace {

inline float root(float square) { return __builtin_sqrtf(square); }
inline float size(float value) { return __builtin_fabsf(value); }

/// What is left of the certificate of box n.
inline float left_of(const MoveColumns& c, const MoveLine& at, std::size_t n) {
  const float qx = c.x[n] - at.foot_x;
  const float qy = c.y[n] - at.foot_y;
  const float qz = c.z[n] - at.foot_z;
  const float along = qx * at.axis_x + qy * at.axis_y + qz * at.axis_z;
  const float ex = at.turn_x - c.turn_x[n];
  const float ey = at.turn_y - c.turn_y[n];
  const float ez = at.turn_z - c.turn_z[n];
  const float dx = (at.foot_x - c.foot_x[n]) + along * ex;
  const float dy = (at.foot_y - c.foot_y[n]) + along * ey;
  const float dz = (at.foot_z - c.foot_z[n]) + along * ez;
  const float moved = root(dx * dx + dy * dy + dz * dz);
  // Sums of absolute values are no less than the lengths they stand for.
  const float turn = size(ex) + size(ey) + size(ez) + at.turned;
  const float off = size(qx - along * at.axis_x) + size(qy - along * at.axis_y) + size(qz - along * at.axis_z);
  const float advance = (at.back - c.back[n]) - (c.x[n] * ex + c.y[n] * ey + c.z[n] * ez);
  const float a = advance * c.forward[n];
  const float b = -advance * c.backward[n];
  const float counted = (a > b ? a : b) + c.forward[n] * at.back_noise;
  const float to_all_sides = moved + counted;
  // The move itself: across the old axis, and along it where that counts.
  const float old_x = at.axis_x - ex, old_y = at.axis_y - ey, old_z = at.axis_z - ez;
  const float forth = c.axial[n] * (advance - (dx * old_x + dy * old_y + dz * old_z));
  const float mx = dx + forth * old_x, my = dy + forth * old_y, mz = dz + forth * old_z;
  const float square = mx * mx + my * my + mz * mz;
  const float towards = c.side_x[n] * mx + c.side_y[n] * my + c.side_z[n] * mz;
  const float sine = c.sine[n];
  const float rest_square = square - towards * towards;
  const float aside = root(rest_square > 0.0F ? rest_square : 0.0F);
  const float cosine = root(sine < 1.0F ? 1.0F - sine * sine : 0.0F);
  const float whole = root(square);
  // The most of the move that may lead to any of the box's points.
  const float oblique = towards * cosine + aside * sine;
  const float of_step = at.way + at.turned * (size(along - at.back) + at.half + off);
  const float to_one_side = (towards >= cosine * whole ? whole : oblique) + of_step + (4.0F * at.noise + at.back_noise);
  const float used = sine <= 1.0F ? to_one_side : to_all_sides;
  const float turned = turn * (at.half + off) * (1.0F + 2.0F * c.forward[n]) + at.edge * (1.0F + c.forward[n]);
  const float less = turned + at.noise;
  // What did not hold when it was made does not hold after a move away either.
  const float at_most_left = c.free[n] > 0.0F ? 1e30F : 0.0F;
  const float unbounded = c.free[n] - (used + less);
  const float left_here = unbounded < at_most_left ? unbounded : at_most_left;
  const float left_of_rest = c.rest[n] - (to_all_sides + less);
  return left_here < left_of_rest ? left_here : left_of_rest;
}

void check(const MoveColumns& c, const MoveLine& at, std::size_t begin, std::size_t count, float* __restrict left) {
  for (std::size_t first = 0; first < count; first += kMoveBlock) {
    float block[kMoveBlock];
    for (std::size_t i = 0; i < kMoveBlock; ++i) block[i] = left_of(c, at, begin + first + i);
    const std::size_t found = count - first;
    for (std::size_t i = 0; i < kMoveBlock; ++i) {
      if (i < found) left[first + i] = block[i];
    }
  }
}

}  // namespace

MoveKernels MoveKernels::SPINALTAP_KERNEL_SET() { return {SPINALTAP_KERNEL_NAME, detail::check}; }

}  // namespace spinaltap::detail
