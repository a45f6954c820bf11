#include "core/uncertainty/placement_errors.h"
#include "core/anatomy/landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/base/quasi_random.h"
#include "core/base/random.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

constexpr std::uint32_t kDraws = 16384;

struct Moments {
  double mean = 0.0, deviation = 0.0;
};

template <class Value>
Moments moments_of(const PlacementErrors& errors, const Value& value) {
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    const double one = value(draw_error(errors, 3, n));
    sum += one;
    squares += one * one;
  }
  const double mean = sum / kDraws;
  return {mean, std::sqrt(squares / kDraws - mean * mean)};
}

TEST(PlacementErrors, HaveTheSpreadsAndBiasesThatTheySay) {
  PlacementErrors errors = plain_errors(1.5, 2.0);
  errors.entry_mm.medial_bias = 0.5;
  errors.direction_deg.cranial_bias = -1.0;
  errors.direction_deg.cranial = 3.0;
  errors.along_bias_mm = 0.25;
  errors.along_mm = 0.75;
  const auto expect = [&](const Moments& found, double mean, double deviation) {
    EXPECT_NEAR(found.mean, mean, 0.01);
    EXPECT_NEAR(found.deviation, deviation, 0.01);
  };
  for (const double shape : {1.2, 2.0, 5.0}) {
    errors.entry_mm.shape = errors.direction_deg.shape = shape;
    expect(moments_of(errors, [](const PlacementError& e) { return e.medial_mm; }), 0.5, 1.5);
    expect(moments_of(errors, [](const PlacementError& e) { return e.cranial_mm; }), 0.0, 1.5);
    expect(moments_of(errors, [](const PlacementError& e) { return e.medial_deg; }), 0.0, 2.0);
    expect(moments_of(errors, [](const PlacementError& e) { return e.cranial_deg; }), -1.0, 3.0);
    expect(moments_of(errors, [](const PlacementError& e) { return e.along_mm; }), 0.25, 0.75);
  }
}

TEST(PlacementErrors, TakeMeanAndDeviationOfPublishedLengths) {
  for (const MeanAndDeviation& length : {MeanAndDeviation{2.2, 1.4}, {2.9, 2.3}, {2.88, 0.58}, {1.0, 0.5227232}}) {
    PlacementErrors errors;
    errors.entry_mm = errors_of_length(length);
    const Moments found =
        moments_of(errors, [](const PlacementError& e) { return std::hypot(e.medial_mm, e.cranial_mm); });
    EXPECT_NEAR(found.mean, length.mean, 0.01);
    EXPECT_NEAR(found.deviation, length.deviation, 0.01);
  }
  // A normal pair's length has the Rayleigh law: mean over deviation is sqrt(pi / (4 - pi)).
  EXPECT_NEAR(errors_of_length({1.0, std::sqrt((4.0 - std::acos(-1.0)) / std::acos(-1.0))}).shape, 2.0, 1e-6);
}

TEST(PlacementErrors, TakeMedianAndPercentileOfASide) {
  // A normal law's: 0.6745 and 1.96 deviations.
  const CrossErrors normal = errors_of_sides({0.67449, 1.95996}, {2.0 * 0.67449, 2.0 * 1.95996});
  EXPECT_NEAR(normal.shape, 2.0, 0.01);
  EXPECT_NEAR(normal.medial, 1.0, 0.005);
  EXPECT_NEAR(normal.cranial, 2.0, 0.01);
  const CrossErrors heavy = errors_of_sides({1.0, 3.7}, {1.0, 3.7});
  PlacementErrors errors;
  errors.entry_mm = heavy;
  EXPECT_NEAR(moments_of(errors, [](const PlacementError& e) { return std::abs(e.medial_mm) < 1.0 ? 1.0 : 0.0; }).mean,
              0.5, 0.01);
  EXPECT_NEAR(moments_of(errors, [](const PlacementError& e) { return std::abs(e.medial_mm) < 3.7 ? 1.0 : 0.0; }).mean,
              0.95, 0.005);
}

TEST(PlacementErrors, CorrelateAsTheTipAsksFor) {
  PlacementErrors errors;
  errors.entry_mm = errors_of_length({2.2, 1.4});
  errors.direction_deg = errors_of_length({2.9, 2.3});
  errors.correlation = correlation_by_tip(errors.entry_mm, errors.direction_deg, {1.9, 1.5}, 45.0);
  EXPECT_LT(errors.correlation, -0.3);
  EXPECT_GT(errors.correlation, -1.0);
  // The tip of a path of that length.
  DrillPath path{"", Vec3::Zero(), Vec3(0.0, -45.0, 0.0), {}};
  const ErrorFrame frame;
  double squares = 0.0;
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    const Vec3 off_mm = erred_path(path, frame, draw_error(errors, 3, n)).target_mm - path.target_mm;
    squares += off_mm.x() * off_mm.x() + off_mm.z() * off_mm.z();
  }
  EXPECT_NEAR(std::sqrt(squares / kDraws), std::hypot(1.9, 1.5), 0.03);
  EXPECT_THROW(correlation_by_tip(errors.entry_mm, errors.direction_deg, {20.0, 1.0}, 45.0), Error);
  EXPECT_THROW(correlation_by_tip(errors.entry_mm, errors.direction_deg, {1.9, 1.5}, kNan), Error);
}

TEST(PlacementErrors, ShiftAndTurnAPathInItsFrame) {
  DrillPath path{"", Vec3(20.0, 30.0, 5.0), Vec3(20.0, -15.0, 5.0), {}};
  for (const double side : {1.0, -1.0}) {
    Landmarks landmarks;
    landmarks.left_pedicle.isthmus_mm = Vec3(18.0, 0.0, 0.0);
    landmarks.right_pedicle.isthmus_mm = Vec3(-18.0, 0.0, 0.0);
    path.entry_mm.x() = path.target_mm.x() = side * 20.0;
    const ErrorFrame frame = error_frame(landmarks, path);
    EXPECT_TRUE(frame.medial.isApprox(Vec3(-side, 0.0, 0.0), 1e-12));
    EXPECT_TRUE(frame.cranial.isApprox(Vec3::UnitZ(), 1e-12));
    const DrillPath shifted = erred_path(path, frame, {1.0, 2.0, 3.0, 0.0, 0.0});
    EXPECT_TRUE((shifted.entry_mm - path.entry_mm).isApprox(Vec3(-side, -3.0, 2.0), 1e-12));
    EXPECT_TRUE((shifted.target_mm - path.target_mm).isApprox(Vec3(-side, -3.0, 2.0), 1e-12));
    const DrillPath turned = erred_path(path, frame, {0.0, 0.0, 0.0, 3.0, 4.0});
    EXPECT_TRUE(turned.entry_mm.isApprox(path.entry_mm, 1e-12));
    EXPECT_NEAR(turned.length_mm(), path.length_mm(), 1e-9);
    EXPECT_NEAR(std::acos(turned.direction().dot(path.direction())) / kDegree, 5.0, 1e-9);
    EXPECT_NEAR((turned.target_mm - path.target_mm).x(), -side * 0.6 * 45.0 * std::sin(5.0 * kDegree), 1e-9);
    const DrillPath same = erred_path(path, frame, {});
    EXPECT_EQ(same.entry_mm, path.entry_mm);
    EXPECT_TRUE(same.target_mm.isApprox(path.target_mm, 1e-12));
  }
}

TEST(PlacementErrors, AreRejectedWithoutSense) {
  for (const double bad : {-1.0, kNan, std::numeric_limits<double>::infinity(), 1e6}) {
    EXPECT_THROW(plain_errors(bad, 1.0), Error) << bad;
    EXPECT_THROW(plain_errors(1.0, bad), Error) << bad;
  }
  PlacementErrors errors;
  errors.correlation = 1.5;
  EXPECT_THROW(check_errors(errors), Error);
  errors.correlation = kNan;
  EXPECT_THROW(check_errors(errors), Error);
  errors = {};
  errors.direction_deg.shape = 0.1;
  EXPECT_THROW(check_errors(errors), Error);
  errors = {};
  errors.along_mm = -0.1;
  EXPECT_THROW(check_errors(errors), Error);
  EXPECT_THROW(errors_of_length({0.0, 1.0}), Error);
  EXPECT_THROW(errors_of_length({1.0, 0.0}), Error);
  EXPECT_THROW(errors_of_length({1.0, 5.0}), Error);
  EXPECT_THROW(errors_of_length({kNan, 1.0}), Error);
  EXPECT_THROW(errors_of_sides({1.0, 1.5}, {1.0, 3.0}), Error);
  EXPECT_THROW(errors_of_sides({1.0, 3.0}, {kNan, 3.0}), Error);
}

TEST(SobolNumbers, FillEachAxisEvenlyAndPairsToo) {
  constexpr std::uint32_t kCount = 256;
  for (const std::uint64_t seed : {1U, 2U, 99U}) {
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
      std::vector<int> met(kCount, 0);
      for (std::uint32_t n = 0; n < kCount; ++n)
        ++met[static_cast<std::size_t>(sobol_uniform(seed, n, dimension) * kCount)];
      for (const int times : met) EXPECT_EQ(times, 1) << dimension;  // a net of base 2
    }
    // The first two dimensions are a (0, 8, 2)-net: each box of 16 by 16 has one.
    std::vector<int> met(kCount, 0);
    for (std::uint32_t n = 0; n < kCount; ++n) {
      const auto across = static_cast<std::size_t>(sobol_uniform(seed, n, 0) * 16.0);
      const auto up = static_cast<std::size_t>(sobol_uniform(seed, n, 1) * 16.0);
      ++met[across * 16 + up];
    }
    for (const int times : met) EXPECT_EQ(times, 1);
  }
  EXPECT_NE(sobol_uniform(1, 5, 0), sobol_uniform(2, 5, 0));
  EXPECT_THROW(sobol_uniform(1, 0, -1), Error);
  EXPECT_THROW(sobol_uniform(1, 0, kSobolDimensions), Error);
}

TEST(SobolNumbers, AreUncorrelatedBetweenDimensions) {
  for (int a = 0; a < kSobolDimensions; ++a) {
    for (int b = 0; b < a; ++b) {
      double sum = 0.0;
      for (std::uint32_t n = 0; n < 4096; ++n) sum += sobol_normal(1, n, a) * sobol_normal(1, n, b);
      EXPECT_NEAR(sum / 4096.0, 0.0, 0.02) << a << " " << b;
    }
  }
}

/// A covariance with all its numbers at work: a root times its transpose.
JointErrors made_joint() {
  constexpr std::array<std::array<double, 5>, 5> kRoot{{{1.2, 0, 0, 0, 0},
                                                        {0.3, 0.9, 0, 0, 0},
                                                        {0.1, -0.2, 0.5, 0, 0},
                                                        {-0.8, 0.2, 0.1, 1.5, 0},
                                                        {0.2, -0.6, 0, 0.4, 1.1}}};
  JointErrors joint;
  joint.mean = {0.5, -0.25, 0.1, 1.0, -0.5};
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j < 5; ++j) {
      for (std::size_t k = 0; k < 5; ++k) joint.covariance[i][j] += kRoot[i][k] * kRoot[j][k];
    }
  }
  return joint;
}

std::array<double, 5> numbers_of(const PlacementError& error) {
  return {error.medial_mm, error.cranial_mm, error.along_mm, error.medial_deg, error.cranial_deg};
}

TEST(PlacementErrors, OfAJointLawHaveItsMeanAndCovariance) {
  PlacementErrors errors;
  errors.joint = made_joint();
  check_errors(errors);
  std::array<double, 5> sums{};
  std::array<std::array<double, 5>, 5> products{};
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    const std::array<double, 5> drawn = numbers_of(draw_error(errors, 3, n));
    for (std::size_t i = 0; i < 5; ++i) {
      sums[i] += drawn[i] / kDraws;
      for (std::size_t j = 0; j < 5; ++j) {
        products[i][j] += (drawn[i] - errors.joint->mean[i]) * (drawn[j] - errors.joint->mean[j]) / kDraws;
      }
    }
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(sums[i], errors.joint->mean[i], 0.01) << i;
    for (std::size_t j = 0; j < 5; ++j) {
      EXPECT_NEAR(products[i][j], errors.joint->covariance[i][j], 0.02) << i << ", " << j;
    }
  }
}

TEST(PlacementErrors, OfAJointLawAreTruncatedAsDrawingAgainWouldDo) {
  PlacementErrors errors;
  errors.joint = JointErrors{};
  for (std::size_t n = 0; n < 5; ++n) errors.joint->covariance[n][n] = 1.0;
  errors.joint->most_deviations = 2.0;
  double squares = 0.0, longest = 0.0;
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    double square = 0.0;
    for (const double number : numbers_of(draw_error(errors, 3, n))) square += number * number;
    squares += square / kDraws;
    longest = std::max(longest, square);
  }
  EXPECT_LE(std::sqrt(longest), 2.0 + 1e-9);
  // The other way: numbers of another generator, thrown away where they lie further.
  double again = 0.0;
  int kept = 0;
  for (std::uint64_t n = 0; kept < 100'000; ++n) {
    double square = 0.0;
    for (std::uint64_t k = 0; k < 5; ++k) square += std::pow(random_normal(77, 8 * n + k), 2);
    if (square > 4.0) continue;
    again += square;
    ++kept;
  }
  EXPECT_NEAR(squares, again / kept, 0.02);
}

TEST(PlacementErrors, OfAJointLawHaveOutliersAsOftenAndAsFarAsItSays) {
  PlacementErrors errors;
  errors.joint = JointErrors{};
  errors.joint->covariance[0][0] = 1.0;
  errors.joint->outlier_share = 0.05;
  errors.joint->outlier_times = 5.0;
  int beyond = 0;
  double squares = 0.0;
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    const double drawn = draw_error(errors, 3, n).medial_mm;
    squares += drawn * drawn / kDraws;
    if (std::abs(drawn) > 4.0) ++beyond;
  }
  EXPECT_NEAR(squares, 0.95 + 0.05 * 25.0, 0.1);
  // 0.05 times what lies beyond 4/5 of a deviation, 0.4237, and 0.95 times 6.3e-5.
  EXPECT_NEAR(static_cast<double>(beyond) / kDraws, 0.05 * 0.4237 + 0.95 * 6.3e-5, 0.003);
}

TEST(PlacementErrors, OfATableAreItsRowsEachAsOften) {
  PlacementErrors errors;
  errors.measured = {{1.0, 0.0, 0.0, 0.0, 0.0}, {2.0, -1.0, 0.5, 3.0, 1.0}, {3.0, 0.0, 0.0, -2.0, 0.0}};
  std::array<int, 3> met{};
  for (std::uint32_t n = 0; n < kDraws; ++n) {
    const PlacementError drawn = draw_error(errors, 3, n);
    const auto row = static_cast<std::size_t>(std::lround(drawn.medial_mm)) - 1;
    ASSERT_EQ(numbers_of(drawn), numbers_of(errors.measured.at(row)));
    ++met[row];
  }
  for (const int count : met) EXPECT_NEAR(count, kDraws / 3.0, 5.0);
}

TEST(PlacementErrors, OfTheEntryComeFromItsOwnNumbersAlone) {
  PlacementErrors separate = plain_errors(1.5, 2.0);
  separate.correlation = -0.6;
  PlacementErrors joint;
  joint.joint = made_joint();
  for (const PlacementErrors& errors : {separate, joint}) {
    const PlacementError one = error_of(errors, {0.3, -0.7, 0.2, 1.1, 0.4, 0.0});
    const PlacementError other = error_of(errors, {0.3, -0.7, -1.2, 0.1, -0.4, 0.0});
    EXPECT_EQ(one.medial_mm, other.medial_mm);
    EXPECT_EQ(one.cranial_mm, other.cranial_mm);
    EXPECT_NE(one.medial_deg, other.medial_deg);
    const PlacementError deeper = error_of(errors, {0.3, -0.7, 0.2, 1.1, -0.4, 0.0});
    EXPECT_EQ(one.medial_deg, deeper.medial_deg);
    EXPECT_EQ(one.cranial_deg, deeper.cranial_deg);
  }
}

TEST(PlacementErrors, AreFoundBetweenAPathAndWhatTheyMadeOfIt) {
  DrillPath path{"", Vec3(1.0, 2.0, 3.0), Vec3(-7.0, -30.0, 12.0), {3.0, 60.0, 1.0}};
  ErrorFrame frame;
  frame.along = path.direction();
  frame.medial = any_perpendicular(frame.along);
  frame.cranial = frame.along.cross(frame.medial);
  for (const PlacementError& error :
       {PlacementError{1.5, -2.0, 0.7, 3.0, -4.0}, PlacementError{0.0, 0.0, 0.0, 0.0, 0.0},
        PlacementError{-1.0, 0.0, 2.0, -50.0, 20.0}, PlacementError{0, 0, 0, 0, 120.0}}) {
    const PlacementError found = error_between(path, frame, erred_path(path, frame, error));
    EXPECT_NEAR(found.medial_mm, error.medial_mm, 1e-12);
    EXPECT_NEAR(found.cranial_mm, error.cranial_mm, 1e-12);
    EXPECT_NEAR(found.along_mm, error.along_mm, 1e-12);
    EXPECT_NEAR(found.medial_deg, error.medial_deg, 1e-10);
    EXPECT_NEAR(found.cranial_deg, error.cranial_deg, 1e-10);
  }
}

TEST(PlacementErrors, RejectWhatIsNoCovariance) {
  const auto rejects = [](const auto& change) {
    PlacementErrors errors;
    errors.joint = made_joint();
    change(*errors.joint);
    EXPECT_THROW(check_errors(errors), Error);
  };
  rejects([](JointErrors& j) { j.covariance[0][1] = 0.5; });  // not symmetric
  rejects([](JointErrors& j) { j.covariance[3][3] = -1.0; });
  rejects([](JointErrors& j) { j.covariance[0][1] = j.covariance[1][0] = 9.0; });  // more than 1
  rejects([](JointErrors& j) { j.mean[2] = kNan; });
  rejects([](JointErrors& j) { j.most_deviations = 0.0; });
  rejects([](JointErrors& j) { j.outlier_share = 0.9; });
  rejects([](JointErrors& j) { j.outlier_times = 0.5; });
}

}  // namespace
}  // namespace spinaltap
