#include <algorithm>
#include <cmath>

#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap::detail {

bool BitSweep::is_at_wall_throughout(const Vec3& p, double around_mm) const {
  return std::all_of(poses_.begin(), poses_.end(), [&](const Pose& pose) { return is_at_wall(pose, p, around_mm); });
}

void BitSweep::middle_distances_at_wall(const Vec3& first, double step_mm, WallCube& distances_mm) const {
  // Seen from the bit, places in a row lie on a line.
  const Moment& middle = moments_[middle_];
  const double radius_mm = outline_->radius_mm();
  const Eigen::Matrix<double, 2, 3> across = middle.rows.topRows<2>();
  const Eigen::Vector2d from = across * (first - middle.tip_mm);
  const Eigen::Matrix<double, 2, 3> steps = step_mm * across;
  double* row_mm = distances_mm.data();
  for (int x = 0; x < kWallCubeSide; ++x) {
    for (int y = 0; y < kWallCubeSide; ++y, row_mm += kWallCubeSide) {
      const double u = from.x() + x * steps(0, 0) + y * steps(0, 1);
      const double v = from.y() + x * steps(1, 0) + y * steps(1, 1);
      for (int z = 0; z < kWallCubeSide; ++z) {
        const double at_u = u + z * steps(0, 2);
        const double at_v = v + z * steps(1, 2);
        row_mm[z] = std::sqrt(at_u * at_u + at_v * at_v) - radius_mm;
      }
    }
  }
}

SweepSample BitSweep::nearest_below_at_wall(const Vec3& p, double limit_mm, double at_middle_mm,
                                            std::span<const double> changes_mm) const {
  // There the distance is that from the axis, less the radius: along each chord, how near a straight line comes.
  const double radius_mm = outline_->radius_mm();
  const auto seen_across = [&](const Moment& moment) -> Eigen::Vector2d {
    return moment.rows.topRows<2>() * (p - moment.tip_mm);
  };
  double min_mm = limit_mm;
  double least_squared = limit_mm > -radius_mm ? (limit_mm + radius_mm) * (limit_mm + radius_mm) : 0.0;
  Eigen::Vector2d nearest = Eigen::Vector2d::Zero();
  std::size_t at_moment = moments_.size();
  const auto take = [&](const Eigen::Vector2d& seen, std::size_t moment) {
    const double squared = seen.squaredNorm();
    if (!(squared < least_squared)) return;
    least_squared = squared;
    min_mm = std::sqrt(squared) - radius_mm;
    nearest = seen;
    at_moment = moment;
  };
  if (moments_.size() == 1) take(seen_across(moments_[0]), 0);
  for (std::size_t n = 0; n + 1 < moments_.size(); ++n) {
    // What a point moves along a chord is most at one of its ends.
    if (at_middle_mm - std::max(changes_mm[n], changes_mm[n + 1]) >= min_mm) continue;
    const Eigen::Vector2d begin = seen_across(moments_[n]);
    const Eigen::Vector2d way = seen_across(moments_[n + 1]) - begin;
    const double squared = way.squaredNorm();
    const double t = squared > 0.0 ? std::clamp(-begin.dot(way) / squared, 0.0, 1.0) : 0.0;
    take(begin + t * way, t > 0.5 ? n + 1 : n);
  }
  if (at_moment == moments_.size()) return {limit_mm, Vec3::Zero()};
  const double off_mm = nearest.norm();
  const Eigen::Vector2d out =
      off_mm > 0.0 ? Eigen::Vector2d(nearest / off_mm) : Eigen::Vector2d(Eigen::Vector2d::UnitX());
  return {min_mm, moments_[at_moment].rows.topRows<2>().transpose() * out};
}

}  // namespace spinaltap::detail
