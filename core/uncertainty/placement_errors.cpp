#include "core/uncertainty/placement_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/quasi_random.h"
#include "core/base/text_writer.h"
#include "core/grading/path_side.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

constexpr double kSmallestShape = 0.5, kLargestShape = 50.0;

/// A pair of standard normal numbers, its length replaced by a Weibull law's of this shape, with variances of 1.
struct Pair {
  double medial, cranial;
};
Pair reshaped(const Pair& normal, double shape) {
  if (shape == 2.0) return normal;
  const double length = std::hypot(normal.medial, normal.cranial);
  if (!(length > 0.0)) return normal;
  // exp(-length²/2) is uniform, and minus its logarithm to the power of 1/shape has the Weibull law. The mean square of
  // the length is 2.
  const double scale = std::sqrt(2.0 / std::tgamma(1.0 + 2.0 / shape));
  const double factor = scale * std::pow(0.5 * length * length, 1.0 / shape) / length;
  return {factor * normal.medial, factor * normal.cranial};
}

/// Where `falling`, a function that falls with the shape, has this value.
template <class Falling>
double shape_where(double value, const Falling& falling) {
  double low = kSmallestShape, high = kLargestShape;
  for (int round = 0; round < 50; ++round) {
    const double middle = 0.5 * (low + high);
    (falling(middle) > value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Deviation over mean of a Weibull law.
double variation_of_length(double shape) {
  const double mean = std::tgamma(1.0 + 1.0 / shape);
  return std::sqrt(std::max(0.0, std::tgamma(1.0 + 2.0 / shape) / (mean * mean) - 1.0));
}

/// Share of errors that are larger than `size` to one side or its opposite, where the variance of that side is 1.
double share_beyond(double size, double shape) {
  constexpr int kAngles = 250;
  const double scale = std::sqrt(2.0 / std::tgamma(1.0 + 2.0 / shape));
  double sum = 0.0;
  for (int n = 0; n < kAngles; ++n) {
    const double cosine = std::cos(0.5 * std::numbers::pi * (n + 0.5) / kAngles);
    sum += std::exp(-std::pow(size / (scale * cosine), shape));
  }
  return sum / kAngles;
}

double size_with_share_beyond(double share, double shape) {
  double low = 0.0, high = 50.0;
  for (int round = 0; round < 45; ++round) {
    const double middle = 0.5 * (low + high);
    (share_beyond(middle, shape) > share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::array<double, 6> normals_of(std::uint64_t seed, std::uint32_t index) {
  std::array<double, 6> normals{};
  for (std::size_t n = 0; n < normals.size(); ++n) normals[n] = sobol_normal(seed, index, static_cast<int>(n));
  return normals;
}

double probability_of(double normal) { return 0.5 * std::erfc(-normal * std::numbers::sqrt2 / 2.0); }

/// Probability that five standard normal numbers have at most this length: the chi distribution of five degrees.
double chi_probability(double length) {
  const double over_root_2 = length * std::numbers::sqrt2 / 2.0;
  return std::erf(over_root_2) - std::sqrt(2.0 / std::numbers::pi) * std::exp(-over_root_2 * over_root_2) *
                                     (length + length * length * length / 3.0);
}

/// The length that has this probability to be the longest.
double chi_quantile(double probability) {
  double low = 0.0, high = 40.0;
  for (int round = 0; round < 60; ++round) {
    const double middle = 0.5 * (low + high);
    (chi_probability(middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Which of PlacementError's numbers each normal number is behind, in the order in which a covariance is taken apart:
/// the entry, the direction, the depth.
constexpr std::array<std::size_t, 5> kJointOrder{0, 1, 3, 4, 2};

using JointRoot = std::array<std::array<double, 5>, 5>;

/// The lower triangle whose square the covariance is, in that order (Cholesky). Throws Error where it is none.
JointRoot root_of(const JointErrors& joint) {
  double largest = 0.0;
  for (std::size_t n = 0; n < 5; ++n) largest = std::max(largest, joint.covariance[n][n]);
  JointRoot root{};
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double left = joint.covariance[kJointOrder[i]][kJointOrder[j]];
      for (std::size_t k = 0; k < j; ++k) left -= root[i][k] * root[j][k];
      const double small = 1e-9 * largest;
      if (i == j) {
        if (!(left >= -small)) fail("placement errors: expected a covariance, found a matrix that is none");
        root[i][i] = std::sqrt(std::max(0.0, left));
      } else if (root[j][j] * root[j][j] > small) {
        root[i][j] = left / root[j][j];
      } else if (!(std::abs(left) <= std::sqrt(small * largest))) {
        fail("placement errors: expected a covariance, found a matrix that is none");
      }
    }
  }
  return root;
}

PlacementError joint_error(const JointErrors& joint, const std::array<double, 6>& normals) {
  std::array<double, 5> numbers{};
  std::copy_n(normals.begin(), numbers.size(), numbers.begin());
  double length = 0.0;
  for (const double number : numbers) length += number * number;
  length = std::sqrt(length);
  double times = probability_of(normals[5]) < joint.outlier_share ? joint.outlier_times : 1.0;
  if (std::isfinite(joint.most_deviations) && length > 0.0) {
    // The length's own distribution, cut off: as drawing again until it is short enough.
    times *= chi_quantile(chi_probability(length) * chi_probability(joint.most_deviations)) / length;
  }
  const JointRoot root = root_of(joint);
  std::array<double, 5> error = joint.mean;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = 0; k <= i; ++k) error[kJointOrder[i]] += times * root[i][k] * numbers[k];
  }
  return {error[0], error[1], error[2], error[3], error[4]};
}

PlacementError measured_error(const std::vector<PlacementError>& measured, double normal) {
  const auto count = static_cast<double>(measured.size());
  return measured[std::min(measured.size() - 1, static_cast<std::size_t>(probability_of(normal) * count))];
}

void check_joint(const JointErrors& joint) {
  constexpr double kLargest = 100.0;
  for (std::size_t i = 0; i < 5; ++i) {
    if (!(std::abs(joint.mean[i]) <= kLargest)) {
      fail("placement errors: expected means up to ", kLargest, ", found ", joint.mean[i]);
    }
    for (std::size_t j = 0; j < 5; ++j) {
      if (!(std::abs(joint.covariance[i][j]) <= kLargest * kLargest) ||
          joint.covariance[i][j] != joint.covariance[j][i]) {
        fail("placement errors: expected a symmetric covariance of numbers up to ", kLargest * kLargest, ", found ",
             joint.covariance[i][j], " and ", joint.covariance[j][i]);
      }
    }
  }
  root_of(joint);
  if (!(joint.most_deviations >= 0.1)) {
    fail("placement errors: expected to be truncated at 0.1 deviations or more, found ", joint.most_deviations);
  }
  if (!(joint.outlier_share >= 0.0 && joint.outlier_share <= 0.5) ||
      !(joint.outlier_times >= 1.0 && joint.outlier_times <= kLargest)) {
    fail("placement errors: expected a share of outliers of 0 to 0.5, that err 1 to ", kLargest,
         " times as much, found ", joint.outlier_share, " and ", joint.outlier_times);
  }
}

void check_cross(const CrossErrors& errors, const char* what) {
  constexpr double kLargest = 100.0;
  for (const double bias : {errors.medial_bias, errors.cranial_bias}) {
    if (!(std::abs(bias) <= kLargest))
      fail("placement errors: expected a bias of the ", what, " up to ", kLargest, ", found ", bias);
  }
  for (const double spread : {errors.medial, errors.cranial}) {
    if (!(spread >= 0.0 && spread <= kLargest)) {
      fail("placement errors: expected a spread of the ", what, " of 0 to ", kLargest, ", found ", spread);
    }
  }
  if (!(errors.shape >= kSmallestShape && errors.shape <= kLargestShape)) {
    fail("placement errors: expected a shape of the ", what, "'s law of ", kSmallestShape, " to ", kLargestShape,
         ", found ", errors.shape);
  }
}

}  // namespace

void check_errors(const PlacementErrors& errors) {
  constexpr double kFurthestMm = 100.0;
  check_cross(errors.entry_mm, "entry");
  check_cross(errors.direction_deg, "direction");
  if (!(std::abs(errors.along_bias_mm) <= kFurthestMm)) {
    fail("placement errors: expected a bias along the path up to ", kFurthestMm, " mm, found ", errors.along_bias_mm);
  }
  if (!(errors.along_mm >= 0.0 && errors.along_mm <= kFurthestMm)) {
    fail("placement errors: expected a spread along the path of 0 to ", kFurthestMm, " mm, found ", errors.along_mm);
  }
  if (!(std::abs(errors.correlation) <= 1.0)) {
    fail("placement errors: expected a correlation of -1 to 1, found ", errors.correlation);
  }
  if (errors.joint) check_joint(*errors.joint);
  for (const PlacementError& one : errors.measured) {
    for (const double number : {one.medial_mm, one.cranial_mm, one.along_mm, one.medial_deg, one.cranial_deg}) {
      if (!(std::abs(number) <= kFurthestMm)) {
        fail("placement errors: expected measured errors up to ", kFurthestMm, ", found ", number);
      }
    }
  }
}

PlacementErrors plain_errors(double entry_mm, double direction_deg) {
  PlacementErrors errors;
  errors.name = joined(entry_mm, " mm, ", direction_deg, " degrees");
  errors.title = "Standard deviations to each side, normal";
  errors.entry_mm.medial = errors.entry_mm.cranial = entry_mm;
  errors.direction_deg.medial = errors.direction_deg.cranial = direction_deg;
  check_errors(errors);
  return errors;
}

CrossErrors errors_of_length(const MeanAndDeviation& length) {
  constexpr double kFewest = 0.5, kMost = 40.0;
  if (!(length.mean > 0.0 && length.deviation > 0.0 && length.mean >= kFewest * length.deviation &&
        length.mean <= kMost * length.deviation)) {
    fail("placement errors: expected a mean of ", kFewest, " to ", kMost, " standard deviations, found ", length.mean,
         " with ", length.deviation);
  }
  CrossErrors errors;
  errors.shape = shape_where(length.deviation / length.mean, variation_of_length);
  errors.medial = errors.cranial = std::sqrt(0.5) * std::hypot(length.mean, length.deviation);
  return errors;
}

CrossErrors errors_of_sides(const MedianAndP95& medial, const MedianAndP95& cranial) {
  constexpr double kFewest = 2.0, kMost = 20.0;
  for (const MedianAndP95& side : {medial, cranial}) {
    if (!(side.median > 0.0 && side.p95 >= kFewest * side.median && side.p95 <= kMost * side.median)) {
      fail("placement errors: expected a 95th percentile of ", kFewest, " to ", kMost, " medians, found ", side.p95,
           " with ", side.median);
    }
  }
  constexpr double kHalf = 0.5, kTwentieth = 0.05;
  const double ratio = std::sqrt(medial.p95 / medial.median * cranial.p95 / cranial.median);
  CrossErrors errors;
  errors.shape = shape_where(ratio, [](double shape) {
    return size_with_share_beyond(kTwentieth, shape) / size_with_share_beyond(kHalf, shape);
  });
  const double of_unit =
      std::sqrt(size_with_share_beyond(kHalf, errors.shape) * size_with_share_beyond(kTwentieth, errors.shape));
  errors.medial = std::sqrt(medial.median * medial.p95) / of_unit;
  errors.cranial = std::sqrt(cranial.median * cranial.p95) / of_unit;
  return errors;
}

double correlation_by_tip(const CrossErrors& entry_mm, const CrossErrors& direction_deg, const MeanAndDeviation& tip_mm,
                          double screw_length_mm) {
  if (!(screw_length_mm > 0.0) || !(tip_mm.mean > 0.0 && tip_mm.deviation >= 0.0)) {
    fail("placement errors: expected a tip's error and a screw's length above 0, found ", tip_mm.mean, " mm and ",
         screw_length_mm, " mm");
  }
  constexpr std::uint32_t kDraws = 4096;
  constexpr std::uint64_t kSeed = 1;
  PlacementErrors errors;
  errors.entry_mm = entry_mm;
  errors.direction_deg = direction_deg;
  std::vector<std::array<double, 6>> draws;
  for (std::uint32_t n = 0; n < kDraws; ++n) draws.push_back(normals_of(kSeed, n));
  const auto mean_square = [&](double correlation) {
    errors.correlation = correlation;
    double sum = 0.0;
    for (const std::array<double, 6>& normals : draws) {
      const PlacementError one = error_of(errors, normals);
      const double turn = std::hypot(one.medial_deg, one.cranial_deg) * kDegree;
      const double per_degree_mm = turn > 0.0 ? screw_length_mm * std::sin(turn) / turn * kDegree : 0.0;
      const double medial_mm = one.medial_mm + per_degree_mm * one.medial_deg;
      const double cranial_mm = one.cranial_mm + per_degree_mm * one.cranial_deg;
      sum += medial_mm * medial_mm + cranial_mm * cranial_mm;
    }
    return sum / kDraws;
  };
  const double wanted = tip_mm.mean * tip_mm.mean + tip_mm.deviation * tip_mm.deviation;
  double low = -1.0, high = 1.0;
  if (!(wanted >= mean_square(low) && wanted <= mean_square(high))) {
    fail("placement errors: expected a tip that errs by ", std::sqrt(mean_square(low)), " to ",
         std::sqrt(mean_square(high)), " mm (root mean square) for such entries and directions, found ",
         std::sqrt(wanted), " mm");
  }
  for (int round = 0; round < 30; ++round) {
    const double middle = 0.5 * (low + high);
    (mean_square(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

PlacementError error_of(const PlacementErrors& errors, const std::array<double, 6>& normals) {
  if (!errors.measured.empty()) return measured_error(errors.measured, normals[0]);
  if (errors.joint) return joint_error(*errors.joint, normals);
  const double alone = std::sqrt(std::max(0.0, 1.0 - errors.correlation * errors.correlation));
  const Pair entry = reshaped({normals[0], normals[1]}, errors.entry_mm.shape);
  const Pair turn = reshaped(
      {errors.correlation * normals[0] + alone * normals[2], errors.correlation * normals[1] + alone * normals[3]},
      errors.direction_deg.shape);
  PlacementError error;
  error.medial_mm = errors.entry_mm.medial_bias + errors.entry_mm.medial * entry.medial;
  error.cranial_mm = errors.entry_mm.cranial_bias + errors.entry_mm.cranial * entry.cranial;
  error.along_mm = errors.along_bias_mm + errors.along_mm * normals[4];
  error.medial_deg = errors.direction_deg.medial_bias + errors.direction_deg.medial * turn.medial;
  error.cranial_deg = errors.direction_deg.cranial_bias + errors.direction_deg.cranial * turn.cranial;
  return error;
}

PlacementError scaled(const PlacementError& error, double entry, double direction) {
  return {entry * error.medial_mm, entry * error.cranial_mm, error.along_mm, direction * error.medial_deg,
          direction * error.cranial_deg};
}

PlacementError draw_error(const PlacementErrors& errors, std::uint64_t seed, std::uint32_t index) {
  return error_of(errors, normals_of(seed, index));
}

ErrorFrame error_frame(const Landmarks& landmarks, const DrillPath& path) {
  check_straight(path, "errors of placement");
  check_turns(path.bit, "errors of placement");
  ErrorFrame frame;
  frame.along = path.direction();
  const Vec3 inward = SideNames(landmarks, path).is_left() ? Vec3(-landmarks.left()) : landmarks.left();
  Vec3 medial = inward - inward.dot(frame.along) * frame.along;
  frame.medial = medial.norm() > 1e-6 ? Vec3(medial.normalized()) : any_perpendicular(frame.along);
  frame.cranial = frame.along.cross(frame.medial);
  if (frame.cranial.dot(landmarks.superior()) < 0.0) frame.cranial = -frame.cranial;
  return frame;
}

DrillPath erred_path(const DrillPath& path, const ErrorFrame& frame, const PlacementError& error) {
  const double turn = std::hypot(error.medial_deg, error.cranial_deg);
  Vec3 direction = frame.along;
  if (turn > 0.0) {
    const Vec3 to = (error.medial_deg * frame.medial + error.cranial_deg * frame.cranial) / turn;
    direction = std::cos(turn * kDegree) * frame.along + std::sin(turn * kDegree) * to;
  }
  DrillPath erred = path;
  erred.entry_mm += error.medial_mm * frame.medial + error.cranial_mm * frame.cranial + error.along_mm * frame.along;
  erred.target_mm = erred.entry_mm + path.length_mm() * direction;
  return erred;
}

PlacementError error_between(const DrillPath& path, const ErrorFrame& frame, const DrillPath& erred) {
  const Vec3 shift_mm = erred.entry_mm - path.entry_mm;
  const Vec3 direction = erred.direction();
  const double medial = direction.dot(frame.medial), cranial = direction.dot(frame.cranial);
  const double across = std::hypot(medial, cranial);
  const double turn_deg = std::atan2(across, direction.dot(frame.along)) / kDegree;
  const double per_part = across > 0.0 ? turn_deg / across : 0.0;
  return {shift_mm.dot(frame.medial), shift_mm.dot(frame.cranial), shift_mm.dot(frame.along), per_part * medial,
          per_part * cranial};
}

}  // namespace spinaltap
