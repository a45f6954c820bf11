#include "core/tool/drill_path.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(DrillPath, KnowsItsLengthAndDirection) {
  const DrillPath path{"test", Vec3(1, 1, 1), Vec3(1, 4, 5), {}};
  EXPECT_DOUBLE_EQ(path.length_mm(), 5.0);
  EXPECT_LT((path.direction() - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
}

TEST(DrillPath, RefusesEndsThatMakeNoPath) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto check_to = [](const Vec3& target_mm) { check_path({"test", Vec3::Zero(), target_mm, {}}); };
  check_to(Vec3(0, 0, 0.1));
  check_to(Vec3(0, 0, 500));
  EXPECT_THROW(check_to(Vec3(0, 0, 0.09)), Error);
  EXPECT_THROW(check_to(Vec3(0, 0, 500.1)), Error);
  EXPECT_THROW(check_to(Vec3(nan, 0, 1)), Error);
  EXPECT_THROW(check_to(Vec3(std::numeric_limits<double>::infinity(), 0, 1)), Error);
  EXPECT_THROW(check_path({"test", Vec3::Zero(), Vec3(0, 0, 10), {-3.0, 50.0, 5.0}}), Error);
}

}  // namespace
}  // namespace spinaltap
