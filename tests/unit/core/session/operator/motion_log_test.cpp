// Compiled with optimisation: looks at hundreds of thousands of poses.
#include "core/session/operator/motion_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/session/operator/path_motion.h"
#include "tests/support/count_allocations.h"

namespace spinaltap {
namespace {

constexpr double kLoggedJumpMm = 50.0;
const DrillBit kLoggedBurr{4.0, 60.0, 2.0, BitShape::round_burr, 0.0, 2.5};

/// A hand that goes about in bone at some mm/s, and trembles. It turns for half of each second.
std::vector<ToolMove> trembling_hand(std::size_t count, std::uint64_t seed = 1) {
  const Tremor tremor(0.1, seed);
  std::vector<ToolMove> moves(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double time_s = 0.001 * static_cast<double>(n);
    const Vec3 slow_mm(8.0 * std::sin(0.31 * time_s), 6.0 * std::cos(0.17 * time_s), 3.0 * std::sin(0.05 * time_s));
    const double turned_s = 0.001 * static_cast<double>(n / 1000 * 500 + std::min<std::size_t>(n % 1000, 500));
    const Vec3 axis = Vec3(0.1 * std::sin(0.7 * turned_s), 0.2 * std::cos(0.4 * turned_s), 1.0).normalized();
    moves[n] = {{Vec3(40.0, 200.0, -600.0) + slow_mm + tremor.at_mm(time_s), axis}, true};
  }
  return moves;
}

double segment_off_mm(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 way = b - a;
  const double t = way.squaredNorm() > 0.0 ? std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
  return (a + t * way - p).norm();
}

/// How far poses of `moves` are, at tip and base, from the kept way at most. Kept poses are some of them, in order;
/// infinite where they are not.
double greatest_off_mm(std::span<const ToolMove> moves, const std::vector<Pose>& kept) {
  const auto base_mm = [](const Pose& pose) -> Vec3 { return pose.tip_mm - kLoggedBurr.length_mm * pose.axis; };
  double greatest_mm = 0.0;
  std::size_t at = 0;
  for (std::size_t n = 0; n + 1 < kept.size(); ++n) {
    for (; at < moves.size() && moves[at].pose.tip_mm != kept[n + 1].tip_mm; ++at) {
      const Pose& pose = moves[at].pose;
      greatest_mm = std::max({greatest_mm, segment_off_mm(kept[n].tip_mm, kept[n + 1].tip_mm, pose.tip_mm),
                              segment_off_mm(base_mm(kept[n]), base_mm(kept[n + 1]), base_mm(pose))});
    }
    if (at < moves.size() && moves[at].pose.axis != kept[n + 1].axis) return std::numeric_limits<double>::infinity();
  }
  return at < moves.size() ? greatest_mm : std::numeric_limits<double>::infinity();
}

TEST(MotionLog, KeepsWhatDrilledHoleHasToTheBit) {
  std::vector<ToolMove> moves = trembling_hand(4000);
  for (std::size_t n = 1000; n < 1100; ++n) moves[n].spindle_on = false;
  for (std::size_t n = 2000; n < 2100; ++n) moves[n].pose.tip_mm.x() += 70.0;  // a jump there and back
  moves[3000].pose.tip_mm.y() = std::numeric_limits<double>::quiet_NaN();
  MotionLog log(1);
  log.begin(kLoggedBurr, kLoggedJumpMm);
  std::vector<std::vector<Pose>> read;
  std::optional<Pose> last;
  for (std::size_t n = 0; n < moves.size(); ++n) {
    log.add(moves[n]);
    if (n % 700 != 0 && n + 1 != moves.size()) continue;
    for (std::vector<Pose>& way : cutting_ways(log.read(0, 100'000).moves, kLoggedBurr, kLoggedJumpMm, last)) {
      read.push_back(std::move(way));
    }
  }
  std::optional<Pose> from_nowhere;
  const auto expected = cutting_ways(moves, kLoggedBurr, kLoggedJumpMm, from_nowhere);
  const std::vector<DrilledHole> holes = log.holes();
  ASSERT_EQ(holes.size(), 1U);
  ASSERT_EQ(holes[0].ways.size(), expected.size());
  for (std::size_t way = 0; way < expected.size(); ++way) {
    ASSERT_EQ(holes[0].ways[way].size(), expected[way].size());
    for (std::size_t n = 0; n < expected[way].size(); ++n) {
      ASSERT_EQ(holes[0].ways[way][n].tip_mm, expected[way][n].tip_mm);
      ASSERT_EQ(holes[0].ways[way][n].axis, expected[way][n].axis);
    }
  }
  // Read in pieces, ways go on where the last piece ended.
  std::size_t poses = 0;
  for (const std::vector<Pose>& way : read) poses += way.size();
  std::size_t all = 0;
  for (const std::vector<Pose>& way : expected) all += way.size();
  EXPECT_EQ(poses - (read.size() - expected.size()), all);
  EXPECT_EQ(log.max_off_mm(), 0.0);
}

TEST(MotionLog, AllocatesNothingAndStaysAsNearAsItSaysAtAnyLength) {
  const std::vector<ToolMove> moves = trembling_hand(400'000);
  for (const std::size_t most : {std::size_t{16'384}, std::size_t{43'690}}) {
    MotionLog log(1, most);
    log.begin(kLoggedBurr, kLoggedJumpMm);
    const std::size_t before = test::allocation_count();
    std::size_t greatest = 0;
    for (const ToolMove& move : moves) {
      log.add(move);
      greatest = std::max(greatest, log.pose_count());
    }
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_LE(greatest, most);
    const std::vector<DrilledHole> holes = log.holes();
    ASSERT_EQ(holes.size(), 1U);
    EXPECT_EQ(holes[0].ways.size(), 1U);
    EXPECT_LT(log.max_off_mm(), most == 16'384 ? 1.5 : 0.15);
    EXPECT_LE(greatest_off_mm(moves, holes[0].ways[0]), log.max_off_mm() + 1e-9);
    EXPECT_EQ(holes[0].ways[0].front().tip_mm, moves.front().pose.tip_mm);
    EXPECT_EQ(holes[0].ways[0].back().tip_mm, moves.back().pose.tip_mm);
  }
}

TEST(MotionLog, LeavesAFewPosesOfAToolThatStandsOrGoesStraight) {
  MotionLog log(0, 4096);
  log.begin(kLoggedBurr, kLoggedJumpMm);
  for (int n = 0; n < 50'000; ++n) log.add({{Vec3(0.001 * std::min(n, 30'000), 0.0, 0.0), Vec3::UnitX()}, true});
  EXPECT_LT(log.max_off_mm(), 1e-9);
  EXPECT_LE(log.pose_count(), 4096U);
}

// Whoever reads along has the exact way up to there, whatever is left out of it later.
TEST(MotionLog, GivesReadersTheWayAsItWasWhenTheyReadIt) {
  const std::vector<ToolMove> moves = trembling_hand(60'000, 7);
  MotionLog log(2, 8192);
  log.begin(kLoggedBurr, kLoggedJumpMm);
  std::vector<Pose> often, seldom;
  const auto read = [&](std::size_t reader, std::vector<Pose>& into) {
    for (;;) {
      const MotionLog::Run run = log.read(reader, 1000);
      if (run.moves.empty()) return;
      for (const ToolMove& move : run.moves) {
        if (move.spindle_on) into.push_back(move.pose);
      }
    }
  };
  for (std::size_t n = 0; n < moves.size(); ++n) {
    log.add(moves[n]);
    if (n % 33 == 0) read(0, often);
    if (n == 20'011) read(1, seldom);
  }
  read(0, often);
  read(1, seldom);
  ASSERT_EQ(often.size(), moves.size());
  for (std::size_t n = 0; n < moves.size(); ++n) ASSERT_EQ(often[n].tip_mm, moves[n].pose.tip_mm) << n;
  EXPECT_LT(seldom.size(), 2 * std::size_t{8192});
  EXPECT_LE(greatest_off_mm(moves, seldom), log.max_off_mm() + 1e-9);
  EXPECT_EQ(seldom.back().tip_mm, moves.back().pose.tip_mm);
}

TEST(MotionLog, ParesDownToItsMemoryWhereNothingCanBeLeftOut) {
  MotionLog log(1, 1024);
  log.begin(kLoggedBurr, kLoggedJumpMm);
  // The spindle on and off from cycle to cycle: each pose is a way of its own.
  for (int n = 0; n < 20'000; ++n) log.add({{Vec3(0.01 * n, 0.0, 0.0), Vec3::UnitX()}, n % 2 == 0});
  EXPECT_LE(log.pose_count(), 1024U);
  EXPECT_TRUE(std::isinf(log.max_off_mm()));
  EXPECT_EQ(log.holes()[0].ways.size(), 1024U);
  // A tool that is thrown about at random: no pose lies on the way of two others.
  log.begin(kLoggedBurr, kLoggedJumpMm);
  std::uint64_t state = 1;
  const auto random_mm = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return 20.0 * static_cast<double>(state >> 40U) / static_cast<double>(1U << 24U);
  };
  for (int n = 0; n < 20'000; ++n) log.add({{Vec3(random_mm(), random_mm(), random_mm()), Vec3::UnitX()}, true});
  EXPECT_LE(log.pose_count(), 1024U);
}

TEST(MotionLog, KeepsAHoleOfEachTool) {
  MotionLog log(1, 1024);
  log.begin(kLoggedBurr, kLoggedJumpMm);
  const DrillBit drill{3.0, 50.0, 5.0};
  const std::vector<ToolMove> moves = trembling_hand(3000);
  for (std::size_t n = 0; n < moves.size(); ++n) {
    if (n == 1000) log.take_tool(drill);
    if (n == 2000) log.take_tool(kLoggedBurr);
    log.add(moves[n]);
  }
  const std::vector<DrilledHole> holes = log.holes();
  ASSERT_EQ(holes.size(), 3U);
  EXPECT_EQ(holes[0].bit, kLoggedBurr);
  EXPECT_EQ(holes[1].bit, drill);
  EXPECT_EQ(holes[2].bit, kLoggedBurr);
  for (std::size_t n = 0; n < 3; ++n) {
    ASSERT_EQ(holes[n].ways.size(), 1U);
    EXPECT_EQ(holes[n].ways[0].front().tip_mm, moves[1000 * n].pose.tip_mm);
    EXPECT_EQ(holes[n].ways[0].back().tip_mm, moves[1000 * n + 999].pose.tip_mm);
  }
  EXPECT_EQ(log.read(0, 10'000).tool, 0U);
  EXPECT_EQ(log.read(0, 10'000).tool, 1U);
  EXPECT_EQ(log.read(0, 10'000).tool, 2U);
  EXPECT_TRUE(log.read(0, 10'000).moves.empty());
}

TEST(MotionLog, RejectsTooLittleMemory) { EXPECT_THROW(MotionLog(0, 10), Error); }

}  // namespace
}  // namespace spinaltap
