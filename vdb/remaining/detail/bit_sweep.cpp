#include "vdb/remaining/detail/bit_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace spinaltap::detail {
namespace {

/// How f changes along a chord, from the body's slopes.
double slope_along(const MeridianSample& sample, const Vec3& at, const Vec3& way) {
  const double off_mm = std::sqrt(at.x() * at.x() + at.y() * at.y());
  // On the axis the distance off it grows whichever way one goes.
  const double per_off = off_mm > 0.0 ? (at.x() * way.x() + at.y() * way.y()) / off_mm : way.head<2>().norm();
  return sample.per_back * way.z() + sample.per_off * per_off;
}

double slope_along(const PlateBox::Sample& sample, const Vec3& /*at*/, const Vec3& way) {
  return sample.gradient.dot(way);
}

MeridianSample sample_of(const MeridianOutline& body, const Vec3& seen) {
  return body.at(seen.z(), std::sqrt(seen.x() * seen.x() + seen.y() * seen.y()));
}

PlateBox::Sample sample_of(const PlateBox& body, const Vec3& seen) { return body.sample(seen); }

}  // namespace

BitSweep::BitSweep(std::shared_ptr<const BitOutline> outline, std::span<const Pose> poses, double lengthened_mm)
    : outline_(std::move(outline)),
      poses_(poses.begin(), poses.end()),
      middle_((poses.size() - 1) / 2),
      lengthened_mm_(lengthened_mm) {
  moments_.resize(poses_.size());
  if (outline_->box() != nullptr) {
    for (std::size_t n = 0; n < poses_.size(); ++n) moments_[n] = {poses_[n].tip_mm, plate_rows(poses_[n])};
    return;
  }
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
  Vec3 begin = seen(moments_[place.moment]);
  if (place.t == 0.0) return begin;
  return begin + place.t * (seen(moments_[place.moment + 1]) - begin);
}

double BitSweep::middle_distance_mm(const Vec3& p) const {
  const Vec3 seen = moments_[middle_].rows * (p - moments_[middle_].tip_mm);
  if (const PlateBox* box = outline_->box()) return box->sample(seen).distance_mm;
  return outline_->whole().distance_mm(seen.z(), std::sqrt(seen.x() * seen.x() + seen.y() * seen.y()));
}

BitSweep::Change BitSweep::change(const Pose& from, const Pose& to, double reach_mm) const {
  // A chord is longer than its arc by less than 5% up to angles of one radian. A plate's turn is that of all its
  // directions: their chords, squared and added up, are twice the square of the longest chord at a distance of 1.
  const double chord = outline_->box() == nullptr ? (to.axis - from.axis).norm()
                                                  : (plate_rows(to) - plate_rows(from)).norm() / std::numbers::sqrt2;
  const double turned_mm = 1.05 * chord * reach_mm;
  const Vec3 way = to.tip_mm - from.tip_mm;
  const double along = way.dot(from.axis);
  return {way.norm() + turned_mm, (way - along * from.axis).norm() + turned_mm, std::abs(along) + turned_mm};
}

bool BitSweep::is_at_wall(const Pose& from, const Vec3& p, double spare_mm) const {
  const double back_mm = (from.tip_mm - p).dot(from.axis);
  return back_mm - spare_mm > outline_->cylinder_begin_mm() && back_mm + spare_mm < outline_->length_mm();
}

double BitSweep::max_change_mm(const Pose& from, const Vec3& p, double around_mm, double wall_mm,
                               double more_mm) const {
  const double reach_mm = (p - from.tip_mm).norm() + around_mm;
  Change max;
  for (const Pose& pose : poses_) {
    const Change one = change(from, pose, reach_mm);
    max = {std::max(max.all_mm, one.all_mm), std::max(max.across_mm, one.across_mm),
           std::max(max.along_mm, one.along_mm)};
  }
  const bool slides = is_at_wall(from, p, around_mm + wall_mm + max.along_mm + more_mm);
  return slides ? max.across_mm : max.all_mm + more_mm;
}

double BitSweep::change_mm(const Pose& from, const Vec3& p, double around_mm, double wall_mm) const {
  // A lengthened bit stands for one that was up to so much further back.
  return max_change_mm(from, p, around_mm, wall_mm, lengthened_mm_);
}

double BitSweep::change_from_middle_mm(const Vec3& p, double around_mm, double wall_mm) const {
  return max_change_mm(middle(), p, around_mm, wall_mm, 0.0);
}

double BitSweep::changes_from_middle_mm(const Vec3& p, double around_mm, double wall_mm,
                                        std::vector<double>& changes_mm) const {
  const double reach_mm = (p - middle().tip_mm).norm() + around_mm;
  changes_mm.resize(poses_.size());
  double max_mm = 0.0;
  for (std::size_t n = 0; n < poses_.size(); ++n) {
    const Change one = change(middle(), poses_[n], reach_mm);
    changes_mm[n] = is_at_wall(middle(), p, around_mm + wall_mm + one.along_mm) ? one.across_mm : one.all_mm;
    max_mm = std::max(max_mm, changes_mm[n]);
  }
  return max_mm;
}

template <class Body>
BitSweep::Place BitSweep::nearest_place(const Body& body, const Vec3& p, double limit_mm, double at_middle_mm,
                                        std::span<const double> changes_mm) const {
  // Along each chord the distance to a convex body is convex: it lies above its tangents, and where those at both ends
  // of a stretch meet comes the next look.
  constexpr double kCloseMm = 1e-6;
  constexpr int kMaxLooks = 40;
  struct End {
    double t, value_mm, slope_mm;
  };
  struct Look {
    Vec3 seen = Vec3::Zero();
    decltype(sample_of(body, seen)) sample{};
  };
  const auto moment_at = [&](std::size_t n) {
    const Vec3 seen = seen_at(p, {n, 0.0});
    return Look{seen, sample_of(body, seen)};
  };
  Place best;
  // Within a bit of several parts, deep inside the whole may be the seam of two: there a part's distance tells nothing.
  const bool is_whole = outline_->is_convex();
  double min_mm = is_whole ? limit_mm : std::numeric_limits<double>::infinity();
  const auto take = [&](double distance_mm, const Place& place) {
    if (!(distance_mm < min_mm)) return;
    min_mm = distance_mm;
    best = place;
  };
  if (moments_.size() == 1) {
    take(moment_at(0).sample.distance_mm, {0, 0.0, true});
    return best;
  }
  Look low_moment;
  std::size_t looked_at = moments_.size();  // the moment that low_moment is of
  for (std::size_t n = 0; n + 1 < moments_.size(); ++n) {
    // What a point moves along a chord is most at one of its ends.
    if (!changes_mm.empty() &&
        at_middle_mm - std::max(changes_mm[n], changes_mm[n + 1]) >= std::min(min_mm, limit_mm)) {
      continue;
    }
    if (looked_at != n) {
      low_moment = moment_at(n);
      take(low_moment.sample.distance_mm, {n, 0.0, true});
    }
    const Look high_moment = moment_at(n + 1);
    take(high_moment.sample.distance_mm, {n + 1, 0.0, true});
    const Vec3 way = high_moment.seen - low_moment.seen;
    End low{0.0, low_moment.sample.distance_mm, slope_along(low_moment.sample, low_moment.seen, way)};
    End high{1.0, high_moment.sample.distance_mm, slope_along(high_moment.sample, high_moment.seen, way)};
    for (int look = 0; look < kMaxLooks && low.slope_mm < 0.0 && high.slope_mm > 0.0; ++look) {
      const double meet = (high.value_mm - low.value_mm + low.slope_mm * low.t - high.slope_mm * high.t) /
                          (low.slope_mm - high.slope_mm);
      if (low.value_mm + low.slope_mm * (meet - low.t) > min_mm - kCloseMm) break;
      const double t = std::clamp(meet, low.t, high.t);
      const Vec3 at = low_moment.seen + t * way;
      const auto between = sample_of(body, at);
      take(between.distance_mm, {n, t, true});
      const End end{t, between.distance_mm, slope_along(between, at, way)};
      (end.slope_mm < 0.0 ? low : high) = end;
      if (end.slope_mm == 0.0) break;
    }
    low_moment = high_moment;
    looked_at = n + 1;
  }
  return best;
}

SweepSample BitSweep::sample_at(const Vec3& p, const Place& place) const {
  const Vec3 seen = seen_at(p, place);
  const Mat3& rows = moments_[place.t > 0.5 ? place.moment + 1 : place.moment].rows;
  if (const PlateBox* box = outline_->box()) {
    const PlateBox::Sample sample = box->sample(seen);
    return {sample.distance_mm, rows.transpose() * sample.gradient};
  }
  const MeridianSample sample = sample_of(outline_->whole(), seen);
  const double off_mm = seen.head<2>().norm();
  const Vec3 radial = off_mm > 0.0 ? Vec3(seen.x() / off_mm, seen.y() / off_mm, 0.0) : Vec3(Vec3::UnitX());
  const Vec3 own = sample.per_off * radial + sample.per_back * Vec3::UnitZ();
  return {sample.distance_mm, rows.transpose() * own};
}

SweepSample BitSweep::nearest(const Vec3& p) const {
  return nearest_below(p, std::numeric_limits<double>::infinity(), 0.0, {});
}

SweepSample BitSweep::nearest_below(const Vec3& p, double limit_mm, double at_middle_mm,
                                    std::span<const double> changes_mm) const {
  SweepSample best{limit_mm, Vec3::Zero()};
  const auto take = [&](const auto& part) {
    const Place place = nearest_place(part, p, best.distance_mm, at_middle_mm, changes_mm);
    if (!place.is_found) return;
    const SweepSample sample = sample_at(p, place);
    if (sample.distance_mm < best.distance_mm) best = sample;
  };
  if (const PlateBox* box = outline_->box()) {
    take(*box);
    return best;
  }
  for (const MeridianOutline& part : outline_->convex_parts()) take(part);
  return best;
}

Box3 BitSweep::bounds_mm(double margin_mm) const {
  Box3 box;
  if (const PlateBox* plate = outline_->box()) {
    const Vec3 middle = 0.5 * (plate->low_mm() + plate->high_mm());
    const Vec3 half = 0.5 * (plate->high_mm() - plate->low_mm());
    for (const Moment& moment : moments_) {
      const Vec3 at = moment.tip_mm + moment.rows.transpose() * middle;
      const Vec3 out = moment.rows.cwiseAbs().transpose() * half + Vec3::Constant(margin_mm);
      box.extend(at - out);
      box.extend(at + out);
    }
    return box;
  }
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
