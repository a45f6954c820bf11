#pragma once

#include <cstddef>
#include <vector>

namespace spinaltap {

/// How warm it gets beside a hole when its wall is heated at once, evenly around and along it: the solution in bone
/// outside a cylinder without end (Carslaw and Jaeger, Conduction of Heat in Solids, 13.5), as an integral over Bessel
/// functions, kept in a table.
class HoleKernel {
 public:
  /// At `distance_mm` (above 0) from the wall of a hole of `radius_mm`. `transfer_per_mm`: what the wall gives off to a
  /// medium at the bone's first temperature, as heat transfer over conductivity; 0: nothing. Throws Error on numbers
  /// that are none of these.
  HoleKernel(double radius_mm, double distance_mm, double transfer_per_mm);

  /// Rise times heat capacity over heat per length of hole, mm^-2, `spread_mm2` (diffusivity times time) after that.
  double at(double spread_mm2) const noexcept;

 private:
  double low_log_ = 0.0;
  double per_log_ = 0.0;
  std::vector<double> table_;
  double last_spread_mm2_ = 0.0;
};

}  // namespace spinaltap
