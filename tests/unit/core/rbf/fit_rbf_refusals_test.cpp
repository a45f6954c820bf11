#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/rbf/fit_rbf.h"
#include "tests/support/error_of.h"
#include "tests/support/nan.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::kNan;
using testing::HasSubstr;

constexpr std::uint64_t kRejectedSeed = 7;
constexpr double kInf = std::numeric_limits<double>::infinity();

RbfValues good_values(std::size_t count = 50) {
  return {test::random_points(count, kRejectedSeed), test::random_weights(count, kRejectedSeed + 1), {}};
}

std::string fit_error(const RbfValues& data, const FitOptions& options = {}) {
  return error_of([&] { fit_rbf(data, options); });
}

TEST(FitRbfRejections, TakesWhatIsRight) { EXPECT_EQ(fit_error(good_values()), ""); }

TEST(FitRbfRejections, RejectsFewerPointsThanThePolynomialHasTerms) {
  EXPECT_THAT(fit_error({}), HasSubstr("expected 4 to 50000000 points, found 0"));
  EXPECT_THAT(fit_error(good_values(3)), HasSubstr("found 3"));
  EXPECT_EQ(fit_error(good_values(4)), "");
  EXPECT_THAT(fit_error(good_values(9), {.kernel = RadialKernel::triharmonic}), HasSubstr("expected 10 to"));
  // Four are left of ten when they are merged, which is too few for a quadric.
  RbfValues same = good_values(10);
  for (std::size_t i = 4; i < 10; ++i) same.points_mm[i] = same.points_mm[0];
  EXPECT_THAT(fit_error(same, {.kernel = RadialKernel::triharmonic}),
              HasSubstr("expected 10 points or more that differ"));
}

TEST(FitRbfRejections, RejectsPointsInAPlaneOrOnAQuadric) {
  RbfValues plane = good_values();
  for (Vec3& p : plane.points_mm) p = Vec3(500, 600, 700) + p.x() * Vec3(1, 2, 3) + p.y() * Vec3(3, 0, -1);
  EXPECT_THAT(fit_error(plane), HasSubstr("the points lie in a plane"));
  RbfValues heap = good_values();
  for (Vec3& p : heap.points_mm) p = Vec3(500, 600, 700);
  EXPECT_THAT(fit_error(heap), HasSubstr("that differ, found 1"));
  RbfValues ball = good_values();
  for (Vec3& p : ball.points_mm) p = Vec3(500, 600, 700) + 10.0 * p.normalized();
  EXPECT_EQ(fit_error(ball), "");
  EXPECT_THAT(fit_error(ball, {.kernel = RadialKernel::triharmonic}), HasSubstr("on a quadric"));
}

TEST(FitRbfRejections, RejectsNumbersThatAreNone) {
  for (const double bad : {kNan, kInf, -kInf, 1e8}) {
    RbfValues data = good_values();
    data.points_mm[11].y() = bad;
    EXPECT_THAT(fit_error(data), HasSubstr("point 12")) << bad;
    data = good_values();
    data.values_mm[11] = bad;
    EXPECT_THAT(fit_error(data), HasSubstr("point 12")) << bad;
    data = good_values();
    data.error_bars_mm.assign(50, 0.1);
    EXPECT_EQ(fit_error(data), "");
    data.error_bars_mm[11] = bad;
    EXPECT_THAT(fit_error(data), HasSubstr("error bar of 0 mm or more at point 12")) << bad;
  }
  RbfValues data = good_values();
  data.error_bars_mm.assign(50, -0.1);
  EXPECT_THAT(fit_error(data), HasSubstr("found -0.1"));
}

TEST(FitRbfRejections, RejectsSizesThatDoNotFit) {
  RbfValues data = good_values();
  data.values_mm.pop_back();
  EXPECT_THAT(fit_error(data), HasSubstr("a value for each of 50 points, found 49"));
  data = good_values();
  data.error_bars_mm.assign(51, 0.1);
  EXPECT_THAT(fit_error(data), HasSubstr("an error bar for each of 50 points or none, found 51"));
}

TEST(FitRbfRejections, RejectsOptionsOutOfRange) {
  for (const double bad : {kNan, kInf, -1.0}) {
    EXPECT_THAT(fit_error(good_values(), {.smoothing_mm = bad}), HasSubstr("smoothing of 0 mm or more")) << bad;
    EXPECT_THAT(fit_error(good_values(), {.reduction_mm = bad}), HasSubstr("reduction of 0 mm or more")) << bad;
    EXPECT_THAT(fit_error(good_values(), {.merge_mm = bad}), HasSubstr("merging distance of 0 mm or more")) << bad;
    EXPECT_THAT(fit_error(good_values(), {.accuracy_mm = bad}), HasSubstr("accuracy")) << bad;
  }
  EXPECT_THAT(fit_error(good_values(), {.accuracy_mm = 0.0}), HasSubstr("accuracy above 0 mm"));
  EXPECT_THAT(fit_error(good_values(), {.reduction_mm = 0.1, .slabs = 0}), HasSubstr("1 slab or more"));
  EXPECT_THAT(fit_error(good_values(), {.slabs = 2}), HasSubstr("slabs are for reduction"));
  EXPECT_THAT(fit_error(good_values(), {.reduction_mm = 0.1, .slabs = 20}), HasSubstr("found 2 (in slab 1 of 20)"));
  RbfValues bars = good_values();
  bars.error_bars_mm.assign(50, 0.1);
  EXPECT_THAT(fit_error(bars, {.smoothing_mm = 0.1}), HasSubstr("not both"));
  EXPECT_THAT(fit_error(bars, {.reduction_mm = 0.1}), HasSubstr("not both"));
}

TEST(FitRbfRejections, StopsWhenItIsCancelled) {
  RbfValues bars = good_values();
  bars.error_bars_mm.assign(50, 0.1);
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(fit_rbf(good_values(), {}, progress), Cancelled);
  EXPECT_THROW(fit_rbf(good_values(), {.reduction_mm = 0.1}, progress), Cancelled);
  EXPECT_THROW(fit_rbf(good_values(), {.reduction_mm = 0.1, .slabs = 2}, progress), Cancelled);
  EXPECT_THROW(fit_rbf(bars, {}, progress), Cancelled);
}

TEST(FitRbfRejections, TellsHowFarItIs) {
  std::vector<double> fractions;
  fit_rbf(good_values(400), {.accuracy_mm = 1e-6},
          Progress([&](std::string_view, double f) { fractions.push_back(f); }));
  ASSERT_FALSE(fractions.empty());
  for (const double fraction : fractions) EXPECT_TRUE(fraction >= 0.0 && fraction <= 1.0) << fraction;
}

}  // namespace
}  // namespace spinaltap
