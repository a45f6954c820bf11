// Compiled with optimisation: long loops of its own.

#include "core/registration/registered_probabilities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/beside_a_wall.h"
#include "tests/support/nan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using test::normal_share;

using RegisteredProbabilities = test::BesideAWall;

void expect_holds(const Probability& found, double expected) { test::expect_share(found, expected, 0.015); }

SLOW_TESTS("RegisteredProbabilities.OfATurnThatGoesWithAShiftAreThoseOfASimulation");

TEST_F(RegisteredProbabilities, OfAShiftAddVariances) {
  constexpr double kBesideMm = 1.5, kScrewMm = 0.8, kRegistrationMm = 1.1;
  PoseCovariance registration;
  registration.shift_mm2(0, 0) = kRegistrationMm * kRegistrationMm;
  const double both_mm = std::hypot(kScrewMm, kRegistrationMm);
  const auto within = [&](double breach_mm) { return normal_share((kBesideMm + breach_mm) / both_mm); };
  const GradeProbabilities probabilities =
      registered_probabilities(walls(), path(kBesideMm), plain_errors(kScrewMm, 0.0), registration);
  expect_holds(probabilities.grades[0], within(0.0));
  expect_holds(probabilities.grades[1], within(2.0) - within(0.0));
  expect_holds(probabilities.acceptable, within(2.0));
  // The same errors of a screw alone, of the whole size.
  const GradeProbabilities of_screw = grade_probabilities(walls(), path(kBesideMm), plain_errors(both_mm, 0.0));
  EXPECT_NEAR(probabilities.mean_breach_mm, of_screw.mean_breach_mm, 0.02);
}

TEST_F(RegisteredProbabilities, OfATurnGrowWithTheDistanceFromItsCentre) {
  // The centre lies on the path's line, behind it: the last full section, 4 mm before the target, swings to the wall.
  constexpr double kBesideMm = 1.0, kSpreadDeg = 1.0;
  for (const double behind_mm : {0.0, 30.0}) {
    const DrillPath plan = path(kBesideMm);
    PoseCovariance registration;
    registration.centre_mm = plan.entry_mm + Vec3(0.0, behind_mm, 0.0);
    registration.turn_rad2(2, 2) = kSpreadDeg * kDegree * kSpreadDeg * kDegree;
    const double depth_mm = behind_mm + 28.0;
    double low = 0.0, high = 10.0;
    for (int round = 0; round < 60; ++round) {
      const double middle = 0.5 * (low + high) * kDegree;
      const double out_mm = depth_mm * std::sin(middle) + kRadiusMm * (std::cos(middle) - 1.0);
      (out_mm < kBesideMm ? low : high) = middle / kDegree;
    }
    expect_holds(registered_probabilities(walls(), plan, plain_errors(0.0, 0.0), registration).grades[0],
                 normal_share(low / kSpreadDeg));
  }
}

/// Turn and shift that go together, and a screw's own errors: simulated with other random numbers, another root of the
/// covariance, another way to turn, and the breach that grading takes.
TEST_F(RegisteredProbabilities, OfATurnThatGoesWithAShiftAreThoseOfASimulation) {
  constexpr int kDraws = 2000;
  constexpr double kEntryMm = 0.6;
  const DrillPath plan = path(1.2);
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Zero();
  root.diagonal() << 0.02, 0.015, 0.03, 0.7, 0.4, 0.5;
  root(3, 2) = -0.6;  // turned to the wall, shifted away from it
  root(4, 0) = 0.3;
  const Eigen::Matrix<double, 6, 6> whole = root * root.transpose();
  PoseCovariance registration{plan.entry_mm + Vec3(5.0, 20.0, -3.0), whole.topLeftCorner<3, 3>(),
                              whole.topRightCorner<3, 3>(), whole.bottomRightCorner<3, 3>()};
  int met = 0;
  for (int n = 0; n < kDraws; ++n) {
    Eigen::Matrix<double, 6, 1> normals;
    const auto draw = [n](int k) { return random_normal(4711, static_cast<std::uint64_t>(10 * n + k)); };
    for (int k = 0; k < 6; ++k) normals[k] = draw(k);
    const Eigen::Matrix<double, 6, 1> error = root * normals;
    const Vec3 turn = error.head<3>(), screw(kEntryMm * draw(6), 0.0, kEntryMm * draw(7));
    const Eigen::AngleAxisd rotation(turn.norm(), turn.normalized());
    const auto move = [&](const Vec3& p) -> Vec3 {
      return registration.centre_mm + rotation * (p + screw - registration.centre_mm) + error.tail<3>();
    };
    DrillPath erred = plan;
    erred.entry_mm = move(plan.entry_mm);
    erred.target_mm = move(plan.target_mm);
    met += breach_mm(walls(), erred) > 0.0 ? 0 : 1;
  }
  const double share = static_cast<double>(met) / kDraws;
  EXPECT_GT(share, 0.3);
  EXPECT_LT(share, 0.95);
  const GradeProbabilities probabilities =
      registered_probabilities(walls(), plan, plain_errors(kEntryMm, 0.0), registration, {.draws = 4096});
  // Three deviations of the simulation, and half as much of the draws'.
  EXPECT_NEAR(probabilities.grades[0].share, share, 4.5 * std::sqrt(share * (1.0 - share) / kDraws));
  // Without what goes together it is another number: the test would see it.
  registration.turn_shift.setZero();
  const GradeProbabilities apart =
      registered_probabilities(walls(), plan, plain_errors(kEntryMm, 0.0), registration, {.draws = 4096});
  EXPECT_GT(std::abs(apart.grades[0].share - share), 0.05);
}

TEST_F(RegisteredProbabilities, OfARegistrationWithoutErrorAreThoseWithoutOne) {
  const PlacementErrors errors = plain_errors(1.2, 2.0);
  const GradeProbabilities with = registered_probabilities(walls(), path(1.0), errors, {}),
                           without = grade_probabilities(walls(), path(1.0), errors);
  for (std::size_t n = 0; n < with.grades.size(); ++n) EXPECT_EQ(with.grades[n].share, without.grades[n].share);
}

TEST_F(RegisteredProbabilities, AreTheSameAtAnyNumberOfThreads) {
  PoseCovariance registration;
  registration.shift_mm2 = Mat3::Identity();
  registration.turn_rad2 = 4e-4 * Mat3::Identity();
  const auto at = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return registered_probabilities(walls(), path(1.0), plain_errors(1.0, 1.0), registration, {.draws = 256});
  };
  const GradeProbabilities one = at(1), four = at(4);
  for (std::size_t n = 0; n < one.grades.size(); ++n) EXPECT_EQ(one.grades[n].share, four.grades[n].share);
  EXPECT_EQ(one.mean_breach_mm, four.mean_breach_mm);
}

TEST_F(RegisteredProbabilities, RejectCovariancesWithoutSense) {
  PoseCovariance bad;
  bad.shift_mm2(1, 1) = test::kNan;
  EXPECT_THROW(registered_probabilities(walls(), path(1.0), plain_errors(1.0, 1.0), bad), Error);
  bad.shift_mm2 = -Mat3::Identity();
  EXPECT_THROW(registered_probabilities(walls(), path(1.0), plain_errors(1.0, 1.0), bad), Error);
  bad.shift_mm2 = 1e6 * Mat3::Identity();
  EXPECT_THAT([&] { registered_probabilities(walls(), path(1.0), plain_errors(1.0, 1.0), bad); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("errs by up to 100 mm")));
  EXPECT_THROW(registered_probabilities(walls(), path(1.0), plain_errors(1.0, 1.0), {}, {.draws = 0}), Error);
}

}  // namespace
}  // namespace spinaltap
