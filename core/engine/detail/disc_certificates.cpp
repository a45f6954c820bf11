#include "core/engine/detail/disc_certificates.h"

#include <algorithm>

namespace spinaltap {
namespace {

constexpr float kNotQuite = 1.000001F;  ///< for the rounding of squares

detail::FloatLine in_float(const AxisLine& line) {
  return {static_cast<float>(line.x_mm),    static_cast<float>(line.y_mm),    static_cast<float>(line.x_slope),
          static_cast<float>(line.y_slope), static_cast<float>(line.back_mm), static_cast<float>(line.back_slope)};
}

}  // namespace

DiscCertificates::DiscCertificates(std::size_t discs, double spacing_mm, const detail::DiscKernels& kernels)
    : kernels_(kernels), spacing_mm_(static_cast<float>(spacing_mm)) {
  const std::size_t size = detail::whole_vectors(discs);  // what is beyond the last disc is asked by nobody
  for (auto* column : {&columns_.free_mm, &columns_.back_share, &columns_.x_mm, &columns_.y_mm, &columns_.x_slope,
                       &columns_.y_slope, &columns_.back_mm}) {
    column->assign(size, 0.0F);
  }
  due_.assign(size, 0);
  fail_all();
}

void DiscCertificates::fail_all() { std::fill(columns_.free_mm.begin(), columns_.free_mm.end(), -1.0F); }

void DiscCertificates::check(const Motion& motion) noexcept {
  kernels_.check(
      {in_float(motion.line), spacing_mm_, static_cast<float>(motion.across_share * motion.across_share) * kNotQuite,
       static_cast<float>(motion.turn_mm), static_cast<float>(motion.slack_mm), motion.counts_backward ? -1.0F : 0.0F,
       due_.size(), columns_.free_mm.data(), columns_.back_share.data(), columns_.x_mm.data(), columns_.y_mm.data(),
       columns_.x_slope.data(), columns_.y_slope.data(), columns_.back_mm.data(), due_.data()});
}

void DiscCertificates::renew(int disc, const AxisLine& line, double free_mm, double back_share) noexcept {
  const auto n = static_cast<std::size_t>(disc);
  const float z = static_cast<float>(disc) * spacing_mm_;
  const detail::FloatLine at = in_float(line);
  columns_.free_mm[n] = static_cast<float>(free_mm);
  columns_.back_share[n] = static_cast<float>(back_share);
  columns_.x_mm[n] = at.x + z * at.x_slope;
  columns_.y_mm[n] = at.y + z * at.y_slope;
  columns_.x_slope[n] = at.x_slope;
  columns_.y_slope[n] = at.y_slope;
  columns_.back_mm[n] = at.back + z * at.back_slope;
}

std::size_t DiscCertificates::memory_bytes() const { return columns_.free_mm.size() * 7 * sizeof(float) + due_.size(); }

}  // namespace spinaltap
