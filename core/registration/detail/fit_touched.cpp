#include "core/registration/detail/fit_touched.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/registration/detail/matrix6.h"
#include "core/registration/detail/measured_spread.h"

namespace spinaltap::detail {
namespace {

constexpr double kCapMm = 3.0;  ///< of a distance in a cost

/// Some thousands of the points, picked all over the surface.
std::vector<Vec3> thinned(const std::vector<Vec3>& points_mm) {
  constexpr std::size_t kAbout = 8000;
  const std::size_t one_of = std::max<std::size_t>(1, points_mm.size() / kAbout);
  std::vector<Vec3> kept;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    if (mix_bits(n) % one_of == 0) kept.push_back(points_mm[n]);
  }
  return kept;
}

/// The equations of one step: turns about `centre_mm` and shifts that bring distances to 0.
class StepEquations {
 public:
  explicit StepEquations(const Vec3& centre_mm) : centre_mm_(centre_mm) {}

  void add(const Vec3& place_mm, const Vec3& normal, double distance_mm, double weight) {
    Vector6 row;
    row << (place_mm - centre_mm_).cross(normal), normal;
    normal_ += weight * row * row.transpose();
    right_ -= weight * distance_mm * row;
  }
  const Matrix6& normal_matrix() const { return normal_; }

  /// The step, held back where nothing holds it, and never so far that its directions mean nothing.
  RigidPose step(double held_back, double reach_mm) const {
    constexpr double kMaxShiftMm = 8.0, kMaxTurnRad = 0.2;
    Vector6 hold;
    hold << Vec3::Constant(reach_mm * reach_mm), Vec3::Ones();
    const Matrix6 held = normal_ + Matrix6(Vector6(held_back * hold).asDiagonal());
    const Vector6 solved = held.ldlt().solve(right_);
    if (!solved.allFinite()) return {};
    const double shorter = std::min({1.0, kMaxTurnRad / std::max(1e-12, solved.head<3>().norm()),
                                     kMaxShiftMm / std::max(1e-12, solved.tail<3>().norm())});
    return small_motion(shorter * solved.head<3>(), shorter * solved.tail<3>(), centre_mm_);
  }

 private:
  Vec3 centre_mm_;
  Matrix6 normal_ = Matrix6::Zero();
  Vector6 right_ = Vector6::Zero();
};

double reach_of(const std::vector<Vec3>& places_mm, const Vec3& middle_mm) {
  double sum = 0.0;
  for (const Vec3& p_mm : places_mm) sum += (p_mm - middle_mm).squaredNorm();
  return std::sqrt(sum / static_cast<double>(places_mm.size()));
}

double capped_square(double distance_mm) { return std::min(distance_mm * distance_mm, kCapMm * kCapMm); }

double median_size(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

TouchedFit::TouchedFit(const BoneShape& bone, std::span<const Vec3> touched_mm)
    : bone_(bone), touched_mm_(touched_mm.begin(), touched_mm.end()), thinned_(thinned(bone.points_mm())) {}

FittedPose TouchedFit::coarse(const RigidPose& start, const CoarseRound& round) const {
  FittedPose fit;
  fit.pose = start;
  std::vector<Vec3> places_mm(touched_mm_.size());
  for (int n = 0; n <= round.steps; ++n) {
    for (std::size_t k = 0; k < places_mm.size(); ++k) places_mm[k] = fit.pose.apply(touched_mm_[k]);
    const double share = static_cast<double>(n) / static_cast<double>(round.steps);
    const double scale_mm = round.from_mm * std::pow(round.to_mm / round.from_mm, share);
    const Vec3 middle_mm = middle_of(places_mm);
    StepEquations equations(middle_mm);
    double weights = 0.0, cost = 0.0;
    for (const Vec3& place_mm : places_mm) {
      const PointTree::Nearest nearest = thinned_.nearest(place_mm);
      const Vec3 away = place_mm - thinned_.points_mm()[nearest.index];
      cost += capped_square(nearest.distance_mm);
      if (!(nearest.distance_mm > 1e-9)) continue;
      const double ratio = nearest.distance_mm / scale_mm;
      const double weight = 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
      weights += weight;
      equations.add(place_mm, away / nearest.distance_mm, nearest.distance_mm, weight);
    }
    fit.cost = cost / static_cast<double>(places_mm.size());
    if (n < round.steps) {
      constexpr double kHeldBack = 0.02;
      fit.pose = equations.step(kHeldBack * weights, reach_of(places_mm, middle_mm)).after(fit.pose);
    }
  }
  return fit;
}

void TouchedFit::find_feet(const RigidPose& pose, std::vector<Vec3>& places_mm, std::vector<Foot>& feet) const {
  constexpr double kNearMm = 1.0;     // of places that may lie beside the plane of their nearest sample
  constexpr double kUpright = 0.9;    // further away: the sample's normal is the direction
  constexpr double kNearShare = 0.7;  // of the band within which the field's value is the distance
  constexpr double kSlope = 0.5;
  places_mm.resize(touched_mm_.size());
  feet.resize(touched_mm_.size());
  std::vector<Vec3> feet_mm(touched_mm_.size());
  for (std::size_t n = 0; n < places_mm.size(); ++n) {
    places_mm[n] = pose.apply(touched_mm_[n]);
    const PointTree::Nearest nearest = bone_.nearest(places_mm[n]);
    const Vec3 away = places_mm[n] - bone_.points_mm()[nearest.index];
    const Vec3& normal = bone_.normals()[nearest.index];
    const double height_mm = away.dot(normal);
    if (nearest.distance_mm < kNearMm || std::abs(height_mm) > kUpright * nearest.distance_mm) {
      feet[n] = {height_mm, normal};
    } else {
      const double sign = height_mm < 0.0 ? -1.0 : 1.0;
      feet[n] = {sign * nearest.distance_mm, sign * away / nearest.distance_mm};
    }
    feet_mm[n] = places_mm[n] - feet[n].distance_mm * feet[n].normal;
  }
  // The field itself is right near its zero set only: there it moves the feet onto it, and turns their normals.
  std::vector<double> values_mm(feet.size());
  std::vector<Vec3> gradients(feet.size());
  bone_.surface().evaluate(feet_mm, values_mm, gradients);
  for (std::size_t n = 0; n < feet.size(); ++n) {
    const double slope = gradients[n].norm();
    if (!(std::abs(values_mm[n]) < kNearShare * bone_.trusted_band_mm() && slope > kSlope)) continue;
    feet[n] = {feet[n].distance_mm + values_mm[n] / slope, gradients[n] / slope};
  }
}

FittedPose TouchedFit::fine(const RigidPose& start, double told_noise_mm) const {
  constexpr int kMostSteps = 60;
  constexpr double kDoneMm = 1e-5;
  constexpr double kDeviations = 3.5;
  constexpr double kOfMedian = 1.4826;  // a normal law's deviation over the median of its size
  constexpr double kLeastMm = 0.02;
  FittedPose fit;
  fit.pose = start;
  fit.residuals_mm.resize(touched_mm_.size());
  fit.is_kept.assign(touched_mm_.size(), 1);
  std::vector<Vec3> places_mm;
  std::vector<Foot> feet;
  for (int n = 0; n <= kMostSteps; ++n) {
    find_feet(fit.pose, places_mm, feet);
    fit.cost = 0.0;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      fit.residuals_mm[k] = feet[k].distance_mm;
      fit.cost += capped_square(feet[k].distance_mm) / static_cast<double>(feet.size());
    }
    // Whom to keep is settled half way, so that the end is a fixed point.
    if (n <= kMostSteps / 2) {
      const double limit_mm =
          kDeviations * std::max({kOfMedian * median_size(fit.residuals_mm), told_noise_mm, kLeastMm});
      for (std::size_t k = 0; k < feet.size(); ++k) fit.is_kept[k] = std::abs(feet[k].distance_mm) <= limit_mm ? 1 : 0;
    }
    if (n == kMostSteps) break;
    const Vec3 middle_mm = middle_of(places_mm);
    StepEquations equations(middle_mm);
    for (std::size_t k = 0; k < feet.size(); ++k) {
      if (fit.is_kept[k] != 0) equations.add(places_mm[k], feet[k].normal, feet[k].distance_mm, 1.0);
    }
    constexpr double kHeldBack = 1e-4;
    const double reach_mm = reach_of(places_mm, middle_mm);
    const RigidPose step = equations.step(kHeldBack * static_cast<double>(feet.size()), reach_mm);
    fit.pose = step.after(fit.pose);
    const double moved_mm =
        (step.apply(middle_mm) - middle_mm).norm() + reach_mm * angle_between_rad(step, RigidPose{});
    if (moved_mm < kDoneMm && n > 3) {
      n = std::max(n, kMostSteps - 1);  // one more, for the residuals
    }
  }
  return fit;
}

PoseCovariance TouchedFit::covariance(const FittedPose& fit, double noise_mm, double search_mm,
                                      double search_deg) const {
  constexpr double kLeastNoiseMm = 1e-6;
  constexpr double kNoSearchMm = 20.0, kNoSearchDeg = 20.0;
  std::vector<Vec3> places_mm;
  std::vector<Foot> feet;
  find_feet(fit.pose, places_mm, feet);
  const Vec3 middle_mm = middle_of(places_mm);
  StepEquations equations(middle_mm);
  const double weight = 1.0 / std::pow(std::max(noise_mm, kLeastNoiseMm), 2);
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (fit.is_kept[k] != 0) equations.add(places_mm[k], feet[k].normal, feet[k].distance_mm, weight);
  }
  const double far_mm = search_mm > 0.0 ? search_mm : kNoSearchMm;
  const double far_rad = (search_deg > 0.0 ? search_deg : kNoSearchDeg) * kDegree;
  Vector6 known;
  known << Vec3::Constant(1.0 / (far_rad * far_rad)), Vec3::Constant(1.0 / (far_mm * far_mm));
  const Matrix6 information = equations.normal_matrix() + Matrix6(known.asDiagonal());
  const Matrix6 inverse = information.ldlt().solve(Matrix6::Identity());
  return covariance_of(0.5 * (inverse + inverse.transpose()), middle_mm);
}

}  // namespace spinaltap::detail
