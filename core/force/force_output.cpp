#include "core/force/force_output.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {

void ForceOutput::update(const Vec3& force_n, double time_s) noexcept {
  if (!force_n.allFinite() || !std::isfinite(time_s)) return;
  const bool is_later = count_ > 0 && time_s > last_s_;
  before_n_ = last_n_;
  before_s_ = last_s_;
  count_ = is_later ? std::min(count_ + 1, 2) : 1;
  last_n_ = force_n;
  last_s_ = time_s;
}

Vec3 ForceOutput::at(double time_s) const noexcept {
  if (count_ < 2 || !(time_s > last_s_)) return last_n_;
  // Neither contact that was lost nor contact that has just begun says how force goes on.
  const double last_length_n = last_n_.norm();
  const double before_length_n = before_n_.norm();
  if (last_length_n == 0.0 || before_length_n == 0.0) return last_n_;
  const double cycle_s = last_s_ - before_s_;
  const double ahead = std::min((time_s - last_s_) / cycle_s, 1.0);
  Vec3 force_n = last_n_ + ahead * (last_n_ - before_n_);
  // Not against the last force: what points back is dropped, what goes aside stays.
  const double along = force_n.dot(last_n_);
  if (along < 0.0) force_n -= along / (last_length_n * last_length_n) * last_n_;
  const double max_n = std::max(last_length_n, before_length_n);
  const double length_n = force_n.norm();
  return length_n > max_n ? Vec3(force_n * (max_n / length_n)) : force_n;
}

}  // namespace spinaltap
