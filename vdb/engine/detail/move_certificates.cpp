#include "vdb/engine/detail/move_certificates.h"

#include <algorithm>
#include <cmath>

#include "core/base/instruction_set.h"

namespace spinaltap::detail {

/// A line as certificates hold it, and what checks need beside.
struct MoveCertificates::Line {
  float axis_x, axis_y, axis_z;
  float foot_x, foot_y, foot_z, turn_x, turn_y, turn_z, back;
  float turned, half, edge;
  float noise, back_noise;  ///< what rounding may hide, mm: of feet, and of places along the axis
};

namespace {

struct Columns {
  const float *x, *y, *z, *foot_x, *foot_y, *foot_z, *turn_x, *turn_y, *turn_z, *back, *free, *forward, *backward;
};

/// The same operations in the same order whatever the vectors' length, so that machines agree to the last bit.
template <class Line>
[[gnu::always_inline]] inline void check_boxes(const Columns& c, const Line& at, std::size_t begin, std::size_t count,
                                               float* __restrict left) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t n = begin + i;
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
    const float moved = std::sqrt(dx * dx + dy * dy + dz * dz);
    // Sums of absolute values are no less than the lengths they stand for.
    const float turn = std::abs(ex) + std::abs(ey) + std::abs(ez) + at.turned;
    const float off =
        std::abs(qx - along * at.axis_x) + std::abs(qy - along * at.axis_y) + std::abs(qz - along * at.axis_z);
    const float advance = (at.back - c.back[n]) - (c.x[n] * ex + c.y[n] * ey + c.z[n] * ez);
    const float a = advance * c.forward[n];
    const float b = -advance * c.backward[n];
    const float counted = (a > b ? a : b) + c.forward[n] * at.back_noise;
    left[i] = c.free[n] - (moved + (turn * (at.half + off) + at.edge) * (1.0F + c.forward[n]) + counted + at.noise);
  }
}

template <class Line>
void check_portable(const Columns& c, const Line& at, std::size_t begin, std::size_t count, float* left) {
  check_boxes(c, at, begin, count, left);
}

#if defined(__x86_64__)
template <class Line>
[[gnu::target("avx2")]] void check_avx2(const Columns& c, const Line& at, std::size_t begin, std::size_t count,
                                        float* left) {
  check_boxes(c, at, begin, count, left);
}

const bool kHasAvx2 = instruction_set() >= InstructionSet::avx2;
#endif

}  // namespace

template <class Self, class Visit>
void MoveCertificates::for_each_column(Self& self, const Visit& visit) {
  for (auto* column : {&self.x_, &self.y_, &self.z_, &self.foot_x_, &self.foot_y_, &self.foot_z_, &self.turn_x_,
                       &self.turn_y_, &self.turn_z_, &self.back_, &self.free_, &self.forward_, &self.backward_}) {
    visit(*column);
  }
}

MoveCertificates::MoveCertificates(std::span<const Vec3> centres_mm, double half_mm)
    : half_mm_(half_mm + 1e-4) {  // centres are rounded to float
  for_each_column(*this, [&](std::vector<float>& column) { column.assign(centres_mm.size(), 0.0F); });
  std::fill(free_.begin(), free_.end(), -1.0F);
  if (centres_mm.empty()) return;
  middle_mm_ = bounds_of(centres_mm).center();
  for (std::size_t n = 0; n < centres_mm.size(); ++n) {
    const Vec3 p = centres_mm[n] - middle_mm_;
    max_mm_ = std::max(max_mm_, p.norm());
    x_[n] = static_cast<float>(p.x());
    y_[n] = static_cast<float>(p.y());
    z_[n] = static_cast<float>(p.z());
  }
}

MoveCertificates::Line MoveCertificates::relative(const BitLine& line) const noexcept {
  const Vec3 tip = line.tip_mm - middle_mm_;
  const double back_mm = tip.dot(line.axis);
  const Vec3 foot = tip - back_mm * line.axis;
  const Vec3 turn = line.axis - axis_;
  const auto f = [](double value) { return static_cast<float>(value); };
  // 2^-24 of what floats are made of, with room.
  constexpr double kRounding = 3e-7;
  return {f(line.axis.x()),
          f(line.axis.y()),
          f(line.axis.z()),
          f(foot.x()),
          f(foot.y()),
          f(foot.z()),
          f(turn.x()),
          f(turn.y()),
          f(turn.z()),
          f(back_mm),
          f(line.turned * 1.00001),
          f(half_mm_),
          f(line.edge_mm * 1.00001),
          f(kRounding * (foot.norm() + max_mm_ * turn.norm())),
          f(kRounding * (std::abs(back_mm) + max_mm_))};
}

void MoveCertificates::check(const BitLine& line, std::size_t begin, std::size_t end, float* left_mm) const noexcept {
  const Columns columns{x_.data(),      y_.data(),       z_.data(),       foot_x_.data(), foot_y_.data(),
                        foot_z_.data(), turn_x_.data(),  turn_y_.data(),  turn_z_.data(), back_.data(),
                        free_.data(),   forward_.data(), backward_.data()};
  const Line at = relative(line);
#if defined(__x86_64__)
  if (kHasAvx2) return check_avx2(columns, at, begin, end - begin, left_mm);
#endif
  check_portable(columns, at, begin, end - begin, left_mm);
}

void MoveCertificates::renew(std::size_t box, const BitLine& line, const FreeMove& free) noexcept {
  const Line at = relative(line);
  foot_x_[box] = at.foot_x;
  foot_y_[box] = at.foot_y;
  foot_z_[box] = at.foot_z;
  turn_x_[box] = at.turn_x;
  turn_y_[box] = at.turn_y;
  turn_z_[box] = at.turn_z;
  back_[box] = at.back;
  // Shares rounded up, what is free down.
  forward_[box] = static_cast<float>(free.forward * 1.000001);
  backward_[box] = static_cast<float>(free.backward * 1.000001);
  free_[box] = static_cast<float>(free.free_mm * (free.free_mm > 0.0 ? 1.0 - 1e-6 : 1.0)) -
               (at.noise + forward_[box] * at.back_noise);
}

void MoveCertificates::copy(std::size_t from, std::size_t to) noexcept {
  for_each_column(*this, [&](std::vector<float>& column) { column[to] = column[from]; });
}

}  // namespace spinaltap::detail
