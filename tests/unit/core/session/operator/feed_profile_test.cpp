#include "core/session/operator/path_motion.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(FeedProfile, GoesAtItsFeedsByDepth) {
  FeedProfileOptions options;
  options.steps = {{0.0, 1.0}, {5.0, 0.5}, {8.0, 2.0}};
  const FeedProfile profile(-2.0, 10.0, options);
  EXPECT_DOUBLE_EQ(profile.duration_s(), 7.0 + 6.0 + 1.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(-1.0), -2.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(0.0), -2.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(7.0), 5.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(9.0), 6.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(13.5), 9.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(14.0), 10.0);
  EXPECT_DOUBLE_EQ(profile.depth_mm(99.0), 10.0);
}

TEST(FeedProfile, PecksAndWithdraws) {
  FeedProfileOptions options;
  options.pecking = {.every_mm = 4.0, .back_mm = 3.0, .mm_s = 10.0};
  options.withdraw_mm_s = 20.0;
  const FeedProfile profile(0.0, 10.0, options);
  // 10 mm at 1 mm/s, two pecks of 3 mm back and forth at 10 mm/s, whose last 0.2 mm are gone at 1 mm/s, and 10 mm back
  // at 20 mm/s.
  EXPECT_NEAR(profile.duration_s(), 10.0 + 2.0 * 0.78 + 0.5, 1e-12);
  EXPECT_NEAR(profile.depth_mm(4.0), 4.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(4.3), 1.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(4.58), 3.8, 1e-12);
  EXPECT_NEAR(profile.depth_mm(4.78), 4.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(8.78), 8.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(9.08), 5.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(11.56), 10.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(12.06), 0.0, 1e-12);
  // A peck at the very end would lead nowhere; one that goes back further than the begin ends there.
  options.pecking = {.every_mm = 5.0, .back_mm = 50.0, .mm_s = 10.0};
  options.withdraw_mm_s = 0.0;
  EXPECT_NEAR(FeedProfile(0.0, 10.0, options).duration_s(), 10.0 + 1.18, 1e-12);
}

TEST(FeedProfile, WaitsWhereAPeckHasGoneBackTo) {
  FeedProfileOptions options;
  options.pecking = {.every_mm = 4.0, .back_mm = 3.0, .mm_s = 10.0, .pause_s = 2.5};
  const FeedProfile profile(0.0, 10.0, options);
  EXPECT_NEAR(profile.duration_s(), 10.0 + 2.0 * (0.78 + 2.5), 1e-12);
  for (const double time_s : {4.3, 5.0, 6.8}) EXPECT_NEAR(profile.depth_mm(time_s), 1.0, 1e-12) << time_s;
  EXPECT_NEAR(profile.depth_mm(7.28), 4.0, 1e-12);
  EXPECT_NEAR(profile.depth_mm(8.28), 5.0, 1e-12);
}

TEST(FeedProfile, RejectsWhatLeadsNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto rejected = [&](double begin_mm, double end_mm, const FeedProfileOptions& options) {
    EXPECT_THROW(FeedProfile(begin_mm, end_mm, options), Error);
  };
  rejected(1.0, 0.0, {});
  rejected(0.0, nan, {});
  rejected(0.0, std::numeric_limits<double>::infinity(), {});
  rejected(0.0, 1.0, {.steps = {}});
  for (const double bad : {0.0, -1.0, nan, 1e9}) rejected(0.0, 1.0, {.steps = {{0.0, bad}}});
  rejected(0.0, 1.0, {.steps = {{0.0, 1.0}, {0.0, 2.0}}});
  rejected(0.0, 1.0, {.steps = {{0.0, 1.0}, {nan, 2.0}}});
  for (const double bad : {-1.0, nan, 1e-9}) rejected(0.0, 1.0, {.pecking = {.every_mm = bad}});
  rejected(0.0, 1.0, {.pecking = {.every_mm = 0.5, .back_mm = 0.0}});
  rejected(0.0, 1.0, {.pecking = {.every_mm = 0.5, .mm_s = nan}});
  for (const double bad : {-1.0, nan, 1e4}) rejected(0.0, 1.0, {.pecking = {.every_mm = 0.5, .pause_s = bad}});
  rejected(0.0, 1.0, {.withdraw_mm_s = nan});
}

}  // namespace
}  // namespace spinaltap
