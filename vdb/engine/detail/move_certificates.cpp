#include "vdb/engine/detail/move_certificates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace spinaltap::detail {

template <class Self, class Visit>
void MoveCertificates::for_each_column(Self& self, const Visit& visit) {
  for (auto* column : {&self.x_, &self.y_, &self.z_, &self.foot_x_, &self.foot_y_, &self.foot_z_, &self.turn_x_,
                       &self.turn_y_, &self.turn_z_, &self.back_, &self.free_, &self.forward_, &self.backward_,
                       &self.side_x_, &self.side_y_, &self.side_z_, &self.sine_, &self.axial_, &self.rest_}) {
    visit(*column);
  }
}

MoveCertificates::MoveCertificates(std::span<const Vec3> centres_mm, double half_mm, const MoveKernels& kernels)
    : half_mm_(half_mm + 1e-4), kernels_(&kernels) {  // centres are rounded to float
  for_each_column(*this, [&](std::vector<float>& column) { column.assign(centres_mm.size() + kMoveBlock, 0.0F); });
  std::fill(free_.begin(), free_.end(), -1.0F);
  std::fill(sine_.begin(), sine_.end(), static_cast<float>(FreeMove::kNoSide));
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

void MoveCertificates::move_to(const BitLine& line) noexcept {
  const Vec3 tip = line.tip_mm - middle_mm_;
  const double back_mm = tip.dot(line.axis);
  const Vec3 foot = tip - back_mm * line.axis;
  const Vec3 turn = line.axis - axis_;
  const auto f = [](double value) { return static_cast<float>(value); };
  // 2^-24 of what floats are made of, with room.
  constexpr double kRounding = 3e-7;
  line_ = {f(line.axis.x()),
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
           f(line.turned > 0.0 ? line.way_mm * 1.00001 : 0.0),
           f(kRounding * (foot.norm() + max_mm_ * turn.norm())),
           f(kRounding * (std::abs(back_mm) + max_mm_))};
}

void MoveCertificates::check(std::size_t begin, std::size_t end, float* left_mm) const noexcept {
  const MoveColumns columns{x_.data(),      y_.data(),       z_.data(),        foot_x_.data(), foot_y_.data(),
                            foot_z_.data(), turn_x_.data(),  turn_y_.data(),   turn_z_.data(), back_.data(),
                            free_.data(),   forward_.data(), backward_.data(), side_x_.data(), side_y_.data(),
                            side_z_.data(), sine_.data(),    axial_.data(),    rest_.data()};
  kernels_->check(columns, line_, begin, end - begin, left_mm);
}

FreeMove MoveCertificates::together(std::size_t begin, std::size_t end, const float* left_mm) const noexcept {
  // In lanes, as one minimum after the other would wait for each.
  constexpr std::size_t kLanes = 8;
  std::array<float, kLanes> left, forward, backward;
  left.fill(std::numeric_limits<float>::infinity());
  forward.fill(0.0F);
  backward.fill(0.0F);
  const auto take = [&](std::size_t lane, std::size_t n) {
    left[lane] = std::min(left[lane], left_mm[n]);
    forward[lane] = std::max(forward[lane], forward_[n]);
    backward[lane] = std::max(backward[lane], backward_[n]);
  };
  std::size_t n = begin;
  for (; n + kLanes <= end; n += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, n + lane);
  }
  for (; n < end; ++n) take(0, n);
  return {static_cast<double>(*std::ranges::min_element(left)), static_cast<double>(*std::ranges::max_element(forward)),
          static_cast<double>(*std::ranges::max_element(backward))};
}

void MoveCertificates::renew(std::size_t box, const FreeMove& free) noexcept {
  const MoveLine& at = line_;
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
  const float noise = at.noise + forward_[box] * at.back_noise;
  const auto rounded_down = [&](double mm) { return static_cast<float>(mm * (mm > 0.0 ? 1.0 - 1e-6 : 1.0)) - noise; };
  free_[box] = rounded_down(free.free_mm);
  rest_[box] = rounded_down(free.rest_mm);
  side_x_[box] = static_cast<float>(free.side.x());
  side_y_[box] = static_cast<float>(free.side.y());
  side_z_[box] = static_cast<float>(free.side.z());
  sine_[box] = static_cast<float>(free.has_side() ? std::min(1.0, free.angle_sine * 1.000001) : FreeMove::kNoSide);
  axial_[box] = static_cast<float>(free.axial);
}

void MoveCertificates::copy(std::size_t from, std::size_t to) noexcept {
  for_each_column(*this, [&](std::vector<float>& column) { column[to] = column[from]; });
}

}  // namespace spinaltap::detail
