#include "core/force/force_band.h"

#include <cmath>

namespace spinaltap {
namespace {

constexpr double kLowShare = 0.05, kHighShare = 0.95;

Interval band_of(const ForceSpread& spread) {
  if (!(spread.log_scale > 0.0)) return {spread.median, spread.median};
  return {spread_quantile(spread, kLowShare), spread_quantile(spread, kHighShare)};
}

}  // namespace

double spread_quantile(const ForceSpread& spread, double probability) {
  return spread.median * std::exp(spread.log_scale * student_quantile(probability, static_cast<int>(spread.degrees)));
}

ForceBand::ForceBand(const Material& material) {
  check_material(material);
  thrust_ = band_of(material.thrust_spread);
  torque_ = band_of(material.torque_spread);
  is_known_ = material.thrust_spread.log_scale > 0.0 || material.torque_spread.log_scale > 0.0;
}

Interval ForceBand::thrust_n(double law_n) const noexcept { return {thrust_.low * law_n, thrust_.high * law_n}; }

Interval ForceBand::torque_n_mm(double law_n_mm) const noexcept {
  return {torque_.low * law_n_mm, torque_.high * law_n_mm};
}

}  // namespace spinaltap
