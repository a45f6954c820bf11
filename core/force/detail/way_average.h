#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace spinaltap {

/// Something that comes in bursts along a way, per millimetre of the way: averaged over the last of it by two boxes,
/// one after the other. Points die disc by disc; boxes as long as whole numbers of discs let nothing of that through.
class WayAverage {
 public:
  using Sums = Eigen::Matrix<double, 5, 1>;

  /// `box_mm`: length of each box. What a bin of the way holds counts as spread evenly over it; `bins` to a box.
  WayAverage(double box_mm, int bins);

  /// What came on the next `way_mm` (0 or more) of the way, spread evenly over it.
  void add(double way_mm, const Sums& sums) noexcept;
  /// Per mm. Nothing came before the first call of add().
  Sums per_mm() const noexcept;
  void reset() noexcept;

 private:
  double all_mm() const noexcept;
  double share_behind(double back_mm) const noexcept;

  double box_mm_;
  double bin_mm_;
  std::vector<Sums> bins_;  ///< a ring; the youngest is filled up to fill_mm_
  std::size_t youngest_ = 0;
  double fill_mm_ = 0.0;
  double silent_mm_;  ///< way since anything came
  bool is_empty_ = true;
};

}  // namespace spinaltap
