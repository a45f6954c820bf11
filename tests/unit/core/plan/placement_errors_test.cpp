#include "core/plan/placement_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/base/quasi_random.h"
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

}  // namespace
}  // namespace spinaltap
