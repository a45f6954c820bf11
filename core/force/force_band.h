#pragma once

#include "core/base/statistics.h"
#include "core/points/material.h"

namespace spinaltap {

/// What a force of a material's law may be in a bone and with a tool that no source has measured: 5 % and 95 % of the
/// predictive distribution over sources (docs/validation.md). One factor each, so that a cycle pays nothing for it.
class ForceBand {
 public:
  /// Throws Error on a bad material.
  explicit ForceBand(const Material& material);

  /// N, about a thrust of the law's; lateral forces go with it.
  Interval thrust_n(double law_n) const noexcept;
  /// N·mm, about a torque of the law's.
  Interval torque_n_mm(double law_n_mm) const noexcept;
  /// Whether the material says how widely sources differ. Without, a band is as narrow as the law's own figure.
  bool is_known() const { return is_known_; }

 private:
  Interval thrust_;
  Interval torque_;
  bool is_known_;
};

/// The force of a source over the law's that as large a share of sources stays below as `probability`, between 0 and 1.
double spread_quantile(const ForceSpread& spread, double probability);

}  // namespace spinaltap
