#include "core/heat/hole_heat.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kFinishedWallMm = 1.0;
constexpr double kPulseS = 0.05;           ///< a pulse takes up heat for so long
constexpr std::size_t kWorkPerCycle = 40;  ///< pulses and bins that a cycle looks at
constexpr double kFarPower = 14.0;         ///< e^-14: as good as nothing
constexpr double kLongShare = 0.03;        ///< of its age, a pulse's deviation in time from which it counts as two
constexpr double kLongestShare = 0.9;      ///< to which, since the later half must not lie in the future
constexpr double kMaxHoleMm = 1000.0;

double checked_transfer(const HoleHeatOptions& options) {
  if (!(options.wall_conductivity_w_mm_k > 0.0)) {
    fail("heat of a hole: expected a conductivity above 0, found ", options.wall_conductivity_w_mm_k);
  }
  return options.wall_transfer_w_mm2_k / options.wall_conductivity_w_mm_k;
}

}  // namespace

double wall_back_mm(const DrillBit& bit) { return kFinishedWallMm + bit.head_mm(); }

HoleHeat::HoleHeat(const HoleHeatOptions& options)
    : kernel_(options.radius_mm, options.distance_mm, checked_transfer(options)) {
  if (!(options.length_mm > 0.0) || !(options.length_mm <= kMaxHoleMm)) {
    fail("heat of a hole: expected a length of up to ", kMaxHoleMm, " mm, found ", options.length_mm);
  }
  bins_.resize(static_cast<std::size_t>(std::ceil(options.length_mm / kBinMm)));
  reset();
}

void HoleHeat::reset() noexcept {
  for (Bin& bin : bins_) bin.count = 0;
  first_ = end_ = open_ = 0;
  time_s_ = max_diffusivity_mm2_s_ = first_s_ = 0.0;
  has_place_ = false;
  place_ = 0;
  turn_ = now_ = ever_ = {};
}

void HoleHeat::update(double depth_mm, double heat_w, double dt_s, const ThermalTissue& tissue) noexcept {
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return;
  time_s_ += dt_s;
  const double place = depth_mm / kBinMm;
  const double heat_k_mm3 = heat_w * dt_s / tissue.capacity_j_mm3_k;
  if (place >= 0.0 && place < static_cast<double>(bins_.size()) && heat_k_mm3 > 0.0 && std::isfinite(heat_k_mm3)) {
    add(depth_mm, heat_k_mm3, tissue.diffusivity_mm2_s());
  }
  if (end_ > first_) go_on();
}

void HoleHeat::add(double depth_mm, double heat_k_mm3, double diffusivity_mm2_s) noexcept {
  const auto index = static_cast<std::size_t>(depth_mm / kBinMm);
  if (first_ == end_) {
    first_ = index;
    end_ = index + 1;
    first_s_ = time_s_;
    place_ = index;
  }
  first_ = std::min(first_, index);
  end_ = std::max(end_, index + 1);
  max_diffusivity_mm2_s_ = std::max(max_diffusivity_mm2_s_, diffusivity_mm2_s);
  Bin& bin = bins_[index];
  const bool goes_on = open_ == index && bin.count > 0 && time_s_ - bin.pulses[bin.count - 1].begin_s <= kPulseS;
  open_ = index;
  if (!goes_on) {
    if (bin.count == kPulses) {
      // The two that time has brought nearest to one become one.
      const auto mean_s = [&](std::size_t n) { return bin.pulses[n].moment_s / bin.pulses[n].heat_k_mm3; };
      std::size_t merged = 0;
      double least = 0.0;
      for (std::size_t n = 0; n + 1 < kPulses; ++n) {
        const double share = (mean_s(n + 1) - mean_s(n)) / (time_s_ - mean_s(n + 1) + kPulseS);
        if (n == 0 || share < least) {
          merged = n;
          least = share;
        }
      }
      Pulse& kept = bin.pulses[merged];
      const Pulse& gone = bin.pulses[merged + 1];
      kept.heat_k_mm3 += gone.heat_k_mm3;
      kept.moment_s += gone.moment_s;
      kept.square_s2 += gone.square_s2;
      kept.depth_k_mm4 += gone.depth_k_mm4;
      kept.spread_mm2_s += gone.spread_mm2_s;
      for (std::size_t n = merged + 1; n + 1 < kPulses; ++n) bin.pulses[n] = bin.pulses[n + 1];
      --bin.count;
    }
    bin.pulses[bin.count++] = {0.0, 0.0, 0.0, 0.0, 0.0, time_s_};
  }
  Pulse& pulse = bin.pulses[bin.count - 1];
  pulse.heat_k_mm3 += heat_k_mm3;
  pulse.moment_s += heat_k_mm3 * time_s_;
  pulse.square_s2 += heat_k_mm3 * time_s_ * time_s_;
  pulse.depth_k_mm4 += heat_k_mm3 * depth_mm;
  pulse.spread_mm2_s += heat_k_mm3 * diffusivity_mm2_s;
}

double HoleHeat::rise_of(const Pulse& pulse, double age_s, double at_mm, double depth_mm) const noexcept {
  const double spread_mm2 = age_s * pulse.spread_mm2_s / pulse.heat_k_mm3;
  const double away_mm = depth_mm - at_mm;
  const double mirrored_mm = depth_mm + at_mm;
  const double per_mm2 = 0.25 / spread_mm2;
  const double power = away_mm * away_mm * per_mm2;
  if (power > kFarPower) return 0.0;
  double along = std::exp(-power);
  const double mirrored_power = mirrored_mm * mirrored_mm * per_mm2;
  if (mirrored_power < kFarPower) along += std::exp(-mirrored_power);
  return pulse.heat_k_mm3 * kernel_.at(spread_mm2) * along * std::sqrt(per_mm2) * std::numbers::inv_sqrtpi;
}

double HoleHeat::rise_of(std::size_t index, double depth_mm, double time_s) const noexcept {
  const Bin& bin = bins_[index];
  double sum = 0.0;
  for (std::size_t n = 0; n < bin.count; ++n) {
    const Pulse& pulse = bin.pulses[n];
    const double mean_s = pulse.moment_s / pulse.heat_k_mm3;
    const double at_mm = pulse.depth_k_mm4 / pulse.heat_k_mm3;
    const double age_s = time_s - mean_s;
    if (!(age_s > 0.0)) continue;
    const double variance_s2 = std::max(pulse.square_s2 / pulse.heat_k_mm3 - mean_s * mean_s, 0.0);
    const double share = variance_s2 / (age_s * age_s);
    if (share > kLongShare * kLongShare && share < kLongestShare * kLongestShare) {
      const double deviation_s = std::sqrt(variance_s2);
      sum += 0.5 * (rise_of(pulse, age_s - deviation_s, at_mm, depth_mm) +
                    rise_of(pulse, age_s + deviation_s, at_mm, depth_mm));
    } else {
      sum += rise_of(pulse, age_s, at_mm, depth_mm);
    }
  }
  return sum;
}

double HoleHeat::rise_k(double depth_mm) const noexcept {
  double sum = 0.0;
  for (std::size_t n = first_; n < end_; ++n) sum += rise_of(n, depth_mm, time_s_);
  return sum;
}

void HoleHeat::begin_place() noexcept {
  const double reach_mm = std::sqrt(4.0 * kFarPower * max_diffusivity_mm2_s_ * (time_s_ - first_s_)) + kBinMm;
  const auto reach = static_cast<std::size_t>(std::min(reach_mm / kBinMm, 1e6)) + 1;
  bin_ = std::max(first_, place_ > reach ? place_ - reach : 0);
  bin_end_ = std::min(end_, place_ + reach + 1);
  sum_k_ = 0.0;
  place_s_ = time_s_;
  has_place_ = true;
}

void HoleHeat::go_on() noexcept {
  for (std::size_t work = 0; work < kWorkPerCycle;) {
    if (!has_place_) begin_place();
    const double depth_mm = (static_cast<double>(place_) + 0.5) * kBinMm;
    while (bin_ < bin_end_ && work < kWorkPerCycle) {
      sum_k_ += rise_of(bin_, depth_mm, place_s_);
      work += 1 + bins_[bin_].count;
      ++bin_;
    }
    if (bin_ < bin_end_) return;
    ++work;
    if (sum_k_ > turn_.rise_k) turn_ = {sum_k_, depth_mm, place_s_};
    if (sum_k_ > now_.rise_k) now_ = turn_;
    if (sum_k_ > ever_.rise_k) ever_ = {sum_k_, depth_mm, place_s_};
    has_place_ = false;
    if (++place_ < end_) continue;
    place_ = first_;
    now_ = turn_;
    turn_ = {};
  }
}

}  // namespace spinaltap
