// Compiled with optimisation: long loops of its own.

#include "core/uncertainty/placement_probabilities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/quasi_random.h"
#include "core/grading/fast_breach.h"
#include "tests/support/beside_a_wall.h"
#include "tests/support/nan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using test::kNan;

using test::normal_share;

using PlacementProbabilities = test::BesideAWall;

void expect_about(const Probability& found, double expected) { test::expect_share(found, expected, 0.006); }

TEST_F(PlacementProbabilities, OfAFlatWallAreTheNormalDistributions) {
  constexpr double kBesideMm = 1.5, kSpreadMm = 1.2;
  for (const double side : {1.0, -1.0}) {
    const GradeProbabilities probabilities =
        grade_probabilities(walls(), path(kBesideMm, side), plain_errors(kSpreadMm, 0.0));
    const auto share_within = [&](double breach_mm) { return normal_share((kBesideMm + breach_mm) / kSpreadMm); };
    expect_about(probabilities.grades[0], share_within(0.0));
    expect_about(probabilities.grades[1], share_within(2.0) - share_within(0.0));
    expect_about(probabilities.grades[2], share_within(4.0) - share_within(2.0));
    expect_about(probabilities.acceptable, share_within(2.0));
    EXPECT_EQ(probabilities.canal.share, 0.0);
    double sum = 0.0;
    for (const Probability& one : probabilities.grades) sum += one.share;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST_F(PlacementProbabilities, OfAPlaneTurnFollowTheAngle) {
  // The tip's last full section, 4 mm before the target, swings to the wall; the wall is reached by a larger turn to
  // its side only. Its place furthest out lies radius * cos(turn) + depth * sin(turn) to the side.
  constexpr double kBesideMm = 1.0, kSpreadDeg = 2.0, kDepthMm = 28.0;
  double low = 0.0, high = 10.0;
  for (int round = 0; round < 60; ++round) {
    const double middle = 0.5 * (low + high) * kDegree;
    const double out_mm = kDepthMm * std::sin(middle) + kRadiusMm * std::cos(middle) - kRadiusMm;
    (out_mm < kBesideMm ? low : high) = middle / kDegree;
  }
  PlacementErrors errors = plain_errors(0.0, 0.0);
  errors.direction_deg.medial = kSpreadDeg;
  const GradeProbabilities probabilities = grade_probabilities(walls(), path(kBesideMm), errors);
  expect_about(probabilities.grades[0], normal_share(low / kSpreadDeg));
}

TEST_F(PlacementProbabilities, KnowTheCanal) {
  // 1 mm from the hole's wall, which is met where it comes nearest, and the side's wall far away.
  const double x_mm = test::Block::kHoleMm + kRadiusMm + 1.0;
  DrillPath near = path(0.0);
  near.entry_mm.x() = near.target_mm.x() = x_mm;
  PlacementErrors errors = plain_errors(0.0, 0.0);
  errors.entry_mm.medial = 1.0;
  const GradeProbabilities probabilities = grade_probabilities(walls(), near, errors);
  expect_about(probabilities.canal, 1.0 - normal_share(1.0));
  expect_about(probabilities.grades[0], normal_share(1.0));
}

TEST_F(PlacementProbabilities, WithABiasBehaveAsAPathBesideTheirOwn) {
  PlacementErrors errors = plain_errors(1.0, 0.0);
  errors.entry_mm.medial_bias = -0.7;
  expect_about(grade_probabilities(walls(), path(1.5), errors).grades[0], normal_share(0.8));
}

TEST_F(PlacementProbabilities, WithoutErrorsAreTheGrade) {
  for (const double beside_mm : {0.5, -0.5, -2.5}) {
    const GradeProbabilities probabilities =
        grade_probabilities(walls(), path(beside_mm), plain_errors(0.0, 0.0), {.draws = 16});
    const Grade grade = gertzbein_robbins(breach_mm(walls(), path(beside_mm)));
    EXPECT_EQ(probabilities.grades[static_cast<std::size_t>(grade)].share, 1.0);
    EXPECT_NEAR(probabilities.mean_breach_mm, std::max(0.0, -beside_mm), 0.02);
  }
}

TEST_F(PlacementProbabilities, AreTheSameAtAnyNumberOfThreads) {
  const PlacementErrors errors = plain_errors(1.5, 2.0);
  const auto at = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return grade_probabilities(walls(), path(1.0), errors, {.draws = 256});
  };
  const GradeProbabilities one = at(1), four = at(4);
  for (std::size_t n = 0; n < one.grades.size(); ++n) EXPECT_EQ(one.grades[n].share, four.grades[n].share);
  EXPECT_EQ(one.mean_breach_mm, four.mean_breach_mm);
  EXPECT_EQ(one.p95_breach_mm, four.p95_breach_mm);
}

TEST_F(PlacementProbabilities, RejectOptionsWithoutSense) {
  const PlacementErrors errors = plain_errors(1.0, 1.0);
  EXPECT_THROW(grade_probabilities(walls(), path(1.0), errors, {.draws = 0}), Error);
  EXPECT_THROW(grade_probabilities(walls(), path(1.0), errors, {.grade = {.step_mm = kNan}}), Error);
  EXPECT_THROW(grade_probabilities(walls(), path(1.0), errors, {.grade = {.ring_points = 1}}), Error);
  PlacementErrors bad = errors;
  bad.entry_mm.medial = kNan;
  EXPECT_THROW(grade_probabilities(walls(), path(1.0), bad), Error);
  for (const double step : {0.0, -1.0, kNan, 1e-6}) {
    EXPECT_THROW(breach_map(walls(), path(1.0), {.shift_step_mm = step}), Error);
    EXPECT_THROW(breach_map(walls(), path(1.0), {.turn_step_deg = step}), Error);
  }
  EXPECT_THROW(breach_map(walls(), path(1.0), {.max_shift_mm = kNan}), Error);
  DrillPath cut = path(1.0);
  cut.bit = plate_bit(10.0, 1.0, 40.0);
  const auto is_named = testing::ThrowsMessage<Error>(testing::HasSubstr("errors of placement, found a plate"));
  EXPECT_THAT([&] { grade_probabilities(walls(), cut, errors); }, is_named);
  EXPECT_THAT([&] { breach_map(walls(), cut); }, is_named);
}

TEST_F(PlacementProbabilities, MapsTheWallsBesideAPath) {
  for (const double side : {1.0, -1.0}) {
    const BreachMap map = breach_map(walls(), path(2.0, side), {.max_shift_mm = 5.0, .shift_step_mm = 1.0});
    ASSERT_EQ(map.shift_mm.errors.size(), 11U);
    EXPECT_EQ(map.shift_mm.errors[5], 0.0);
    for (std::size_t cranial = 0; cranial < 11; ++cranial) {
      for (std::size_t medial = 0; medial < 11; ++medial) {
        const double beyond_mm = -map.shift_mm.errors[medial] - 2.0;
        // Bone of 10 mm and more beside it is told by its nearest surface; the front is 8 mm from the tip's centre.
        EXPECT_NEAR(map.shift_mm.at(medial, cranial), beyond_mm, beyond_mm > 0.0 ? 0.02 : 0.1)
            << medial << " " << cranial;
      }
    }
    const std::size_t middle = map.turn_deg.errors.size() / 2;
    EXPECT_NEAR(map.turn_deg.at(middle, middle), map.shift_mm.at(5, 5), 1e-9);
    EXPECT_GT(map.turn_deg.at(0, middle), 1.0);
    EXPECT_LT(map.turn_deg.at(middle + 2, middle), 0.0);
  }
}

/// Paths of all kinds: through pedicles, off them, into the canal, and away from bone.
void expect_fast_as_slow(const WallDistance& walls, const DrillPath& plan, int count) {
  const PlacementErrors errors = plain_errors(2.5, 5.0);
  const ErrorFrame frame = error_frame(walls.landmarks(), plan);
  const BreachField field(walls, {});
  int breaches = 0;
  for (int n = 0; n < count; ++n) {
    const DrillPath path = erred_path(plan, frame, draw_error(errors, 7, static_cast<std::uint32_t>(n)));
    const double slow_mm = breach_mm(walls, path);
    EXPECT_NEAR(FastBreach(field, path).find().larger().breach_mm, slow_mm, 1e-9) << n;
    breaches += slow_mm > 0.0 ? 1 : 0;
  }
  EXPECT_GT(breaches, count / 8);
  EXPECT_LT(breaches, count);
}

TEST_F(PlacementProbabilities, TakeBreachesThatAreThoseOfGrading) {
  expect_fast_as_slow(walls(), path(1.0), 60);
  expect_fast_as_slow(walls(), path(-2.0), 60);
}

SLOW_TESTS("PlacementProbabilitiesPhantom.*");

TEST(PlacementProbabilitiesPhantom, TakesBreachesThatAreThoseOfGrading) {
  const test::PhantomBone phantom;
  const WallDistance walls(phantom.bone, phantom.landmarks);
  for (const PedicleLandmarks& pedicle : {phantom.landmarks.left_pedicle, phantom.landmarks.right_pedicle}) {
    DrillPath plan{"", pedicle.isthmus_mm - 18.0 * pedicle.axis, pedicle.isthmus_mm + 27.0 * pedicle.axis, {}};
    expect_fast_as_slow(walls, plan, 100);
    plan.screw = PedicleScrew();
    expect_fast_as_slow(walls, plan, 200);
  }
}

}  // namespace
}  // namespace spinaltap
