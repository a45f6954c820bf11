#include "vdb/detail/bit_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

/// How f changes along a chord, from the body's slopes.
double slope_along(const MeridianSample& sample, const Vec3& at, const Vec3& way) {
  const double off_mm = std::hypot(at.x(), at.y());
  // On the axis the distance off it grows whichever way one goes.
  const double per_off = off_mm > 0.0 ? (at.x() * way.x() + at.y() * way.y()) / off_mm : std::hypot(way.x(), way.y());
  return sample.per_back * way.z() + sample.per_off * per_off;
}

MeridianSample sample_of(const MeridianOutline& body, const Vec3& seen) {
  return body.at(seen.z(), std::sqrt(seen.x() * seen.x() + seen.y() * seen.y()));
}

}  // namespace

BitSweep::BitSweep(std::shared_ptr<const BitOutline> outline, std::span<const Pose> poses)
    : outline_(std::move(outline)), poses_(poses.begin(), poses.end()), middle_((poses.size() - 1) / 2) {
  moments_.resize(poses_.size());
  const Vec3 side = any_perpendicular(poses_[0].axis);
  moments_[0].rows.row(0) = side;
  moments_[0].rows.row(1) = poses_[0].axis.cross(side);
  moments_[0].rows.row(2) = -poses_[0].axis;
  for (std::size_t n = 0; n < poses_.size(); ++n) {
    moments_[n].tip_mm = poses_[n].tip_mm;
    if (n == 0) continue;
    const auto turn = Eigen::Quaterniond::FromTwoVectors(poses_[n].axis, poses_[n - 1].axis);
    moments_[n].rows = moments_[n - 1].rows * turn.toRotationMatrix();
  }
}

Vec3 BitSweep::seen_at(const Vec3& p, const Place& place) const {
  const auto seen = [&](const Moment& moment) -> Vec3 { return moment.rows * (p - moment.tip_mm); };
  const Vec3 begin = seen(moments_[place.moment]);
  if (place.t == 0.0) return begin;
  return begin + place.t * (seen(moments_[place.moment + 1]) - begin);
}

double BitSweep::middle_distance_mm(const Vec3& p) const {
  return sample_of(outline_->whole(), seen_at(p, {middle_, 0.0})).distance_mm;
}

double BitSweep::change_mm(const Pose& from, const Vec3& p, double around_mm, double wall_mm) const {
  const double reach_mm = (p - from.tip_mm).norm() + around_mm;
  double all_mm = 0.0;
  double across_mm = 0.0;
  double along_mm = 0.0;
  for (const Pose& pose : poses_) {
    // A chord is longer than its arc by less than 5% up to angles of one radian.
    const double turned_mm = 1.05 * (pose.axis - from.axis).norm() * reach_mm;
    const Vec3 way = pose.tip_mm - from.tip_mm;
    const double along = way.dot(from.axis);
    all_mm = std::max(all_mm, way.norm() + turned_mm);
    across_mm = std::max(across_mm, (way - along * from.axis).norm() + turned_mm);
    along_mm = std::max(along_mm, std::abs(along) + turned_mm);
  }
  const double back_mm = (from.tip_mm - p).dot(from.axis);
  const double spare_mm = around_mm + wall_mm + along_mm;
  const bool at_wall = back_mm - spare_mm > outline_->cylinder_begin_mm() && back_mm + spare_mm < outline_->length_mm();
  return at_wall ? across_mm : all_mm;
}

BitSweep::Place BitSweep::nearest_place(const MeridianOutline& body, const Vec3& p) const {
  // Along each chord the distance to a convex body is convex: it lies above its tangents, and where those at both ends
  // of a stretch meet comes the next look.
  constexpr double kCloseMm = 1e-6;
  constexpr int kMostLooks = 40;
  struct End {
    double t, value_mm, slope_mm;
  };
  Place best;
  Vec3 seen = seen_at(p, {0, 0.0});
  MeridianSample sample = sample_of(body, seen);
  double least_mm = sample.distance_mm;
  for (std::size_t n = 0; n + 1 < moments_.size(); ++n) {
    const Vec3 next = seen_at(p, {n + 1, 0.0});
    const MeridianSample next_sample = sample_of(body, next);
    const Vec3 way = next - seen;
    End low{0.0, sample.distance_mm, slope_along(sample, seen, way)};
    End high{1.0, next_sample.distance_mm, slope_along(next_sample, next, way)};
    if (high.value_mm < least_mm) {
      least_mm = high.value_mm;
      best = {n + 1, 0.0};
    }
    for (int look = 0; look < kMostLooks && low.slope_mm < 0.0 && high.slope_mm > 0.0; ++look) {
      const double meet = (high.value_mm - low.value_mm + low.slope_mm * low.t - high.slope_mm * high.t) /
                          (low.slope_mm - high.slope_mm);
      if (low.value_mm + low.slope_mm * (meet - low.t) > least_mm - kCloseMm) break;
      const double t = std::clamp(meet, low.t, high.t);
      const Vec3 at = seen + t * way;
      const MeridianSample between = sample_of(body, at);
      if (between.distance_mm < least_mm) {
        least_mm = between.distance_mm;
        best = {n, t};
      }
      const End end{t, between.distance_mm, slope_along(between, at, way)};
      (end.slope_mm < 0.0 ? low : high) = end;
      if (end.slope_mm == 0.0) break;
    }
    seen = next;
    sample = next_sample;
  }
  return best;
}

SweepSample BitSweep::sample_at(const Vec3& p, const Place& place) const {
  const Vec3 seen = seen_at(p, place);
  const MeridianSample sample = sample_of(outline_->whole(), seen);
  const double off_mm = std::hypot(seen.x(), seen.y());
  const Vec3 radial = off_mm > 0.0 ? Vec3(seen.x() / off_mm, seen.y() / off_mm, 0.0) : Vec3(Vec3::UnitX());
  const Vec3 own = sample.per_off * radial + sample.per_back * Vec3::UnitZ();
  const Mat3& rows = moments_[place.t > 0.5 ? place.moment + 1 : place.moment].rows;
  return {sample.distance_mm, rows.transpose() * own};
}

SweepSample BitSweep::nearest(const Vec3& p) const {
  SweepSample best{std::numeric_limits<double>::infinity(), Vec3::Zero()};
  for (const MeridianOutline& part : outline_->convex_parts()) {
    const SweepSample sample = sample_at(p, nearest_place(part, p));
    if (sample.distance_mm < best.distance_mm) best = sample;
  }
  return best;
}

Box3 BitSweep::bounds_mm(double margin_mm) const {
  Box3 box;
  for (const Pose& pose : poses_) {
    // A disc of the bit's radius across the axis reaches this far along each coordinate.
    const Vec3 across = outline_->radius_mm() * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    const Vec3 out = across + Vec3::Constant(margin_mm);
    for (const Vec3& end : {pose.tip_mm, Vec3(pose.tip_mm - outline_->length_mm() * pose.axis)}) {
      box.extend(end - out);
      box.extend(end + out);
    }
  }
  return box;
}

}  // namespace spinaltap::detail
