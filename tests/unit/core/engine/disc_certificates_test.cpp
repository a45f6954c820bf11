#include "core/engine/detail/disc_certificates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/every_engine.h"

namespace spinaltap {
namespace {

using Motion = DiscCertificates::Motion;
using test::Draw;

constexpr std::uint64_t kCertificateSeed = 378;
constexpr double kDiscsApartMm = 0.1;
constexpr std::size_t kDiscs = 100;

AxisLine random_line(Draw& draw, double off_mm) {
  return {off_mm * draw(-1, 1),        off_mm * draw(-1, 1),        0.05 * off_mm * draw(-1, 1),
          0.05 * off_mm * draw(-1, 1), 10.0 * off_mm * draw(-1, 1), draw(-1.01, -0.99)};
}

Motion random_motion(Draw& draw, double off_mm) {
  Motion motion;
  motion.line = random_line(draw, off_mm);
  motion.across_share = draw(1.0, 1.4);
  motion.turn_mm = draw(0.0, 5.0);
  motion.slack_mm = draw(0.0, 1e-3);
  motion.counts_backward = draw(0.0, 1.0) < 0.5;
  return motion;
}

TEST(DiscCertificates, AreDueToTheLastByteWithAnyInstructions) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCertificateSeed);
  const auto& kernels = detail::disc_kernels();
  ASSERT_FALSE(kernels.empty());
  Draw draw(kCertificateSeed);
  std::size_t due = 0;
  std::size_t held = 0;
  for (int run = 0; run < 50; ++run) {
    // Lengths that fill vectors, and that do not.
    const std::size_t discs = 1 + draw.bits() % 130;
    std::vector<DiscCertificates> sets;
    for (const detail::DiscKernels& kernel : kernels) sets.emplace_back(discs, kDiscsApartMm, kernel);
    AxisLine line = random_line(draw, 0.5);
    for (int step = 0; step < 60; ++step) {
      for (std::size_t disc = 0; disc < discs; ++disc) {
        if (draw(0.0, 1.0) < 0.4) continue;
        const double free_mm = draw(-0.05, 0.5);
        const double back_share = draw(0.0, 1.0) < 0.3 ? 0.0 : draw(0.0, 1.0);
        for (DiscCertificates& set : sets) set.renew(static_cast<int>(disc), line, free_mm, back_share);
      }
      const double off_mm = std::pow(10.0, draw(-4.0, -0.5));
      Motion motion = random_motion(draw, off_mm);
      motion.line.x_mm += line.x_mm;
      motion.line.y_mm += line.y_mm;
      motion.line.x_slope += line.x_slope;
      motion.line.y_slope += line.y_slope;
      motion.line.back_mm = line.back_mm + draw(-1.0, 1.0) * off_mm;
      motion.line.back_slope = line.back_slope;
      for (DiscCertificates& set : sets) set.check(motion);
      line = motion.line;
      const std::vector<std::uint8_t> first(sets[0].due().begin(), sets[0].due().end());
      for (std::size_t n = 1; n < sets.size(); ++n) {
        ASSERT_TRUE(std::ranges::equal(sets[n].due(), first)) << kernels[n].name << " run " << run << " step " << step;
      }
      for (std::size_t disc = 0; disc < discs; ++disc) (first[disc] != 0 ? due : held) += 1;
    }
  }
  EXPECT_GT(due, 20'000U);
  EXPECT_GT(held, 20'000U);
}

class DiscCertificate : public ::testing::TestWithParam<detail::DiscKernels> {
 protected:
  /// Whether a certificate that was made at `from` for disc 42 holds after the motion.
  bool holds(const AxisLine& from, double free_mm, double back_share, const Motion& motion) const {
    DiscCertificates set(kDiscs, kDiscsApartMm, GetParam());
    set.renew(kDisc, from, free_mm, back_share);
    set.check(motion);
    return set.due()[kDisc] == 0;
  }
  static constexpr int kDisc = 42;
};

INSTANTIATE_TEST_SUITE_P(Instructions, DiscCertificate, ::testing::ValuesIn(detail::disc_kernels()),
                         [](const auto& kernels) { return test::plain_name(kernels.param); });

TEST_P(DiscCertificate, HoldsForAShorterMoveThanIsFreeAndFailsForALonger) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCertificateSeed);
  Draw draw(kCertificateSeed + 1);
  for (int n = 0; n < 5'000; ++n) {
    const AxisLine from = random_line(draw, 1.0);
    Motion motion = random_motion(draw, 0.1);
    motion.line.x_mm += from.x_mm;
    motion.line.y_mm += from.y_mm;
    motion.line.x_slope += from.x_slope;
    motion.line.y_slope += from.y_slope;
    motion.line.back_mm += from.back_mm;
    const double back_share = draw(0.0, 1.0);
    // The formula that the header states, in double.
    const double z_mm = kDisc * kDiscsApartMm;
    const AxisLine& to = motion.line;
    const double dx = to.x_mm - from.x_mm + z_mm * (to.x_slope - from.x_slope);
    const double dy = to.y_mm - from.y_mm + z_mm * (to.y_slope - from.y_slope);
    const double turned = std::abs(to.x_slope - from.x_slope) + std::abs(to.y_slope - from.y_slope);
    const double db = to.back_mm - from.back_mm + z_mm * (to.back_slope - from.back_slope);
    const double counted = motion.counts_backward ? std::abs(db) : std::max(0.0, db);
    const double needed_mm =
        motion.across_share * std::hypot(dx, dy) + motion.turn_mm * turned + back_share * counted + motion.slack_mm;
    // Float: coordinates of some millimetres to 5e-7.
    ASSERT_TRUE(holds(from, needed_mm + 1e-5, back_share, motion)) << n << " of " << needed_mm;
    ASSERT_FALSE(holds(from, needed_mm - 1e-5, back_share, motion)) << n << " of " << needed_mm;
  }
}

TEST_P(DiscCertificate, CountsAdvanceOnlyForBitsThatWidenBackwards) {
  const AxisLine at{0.1, 0.2, 0.0, 0.0, 3.0, -1.0};
  for (const double way_mm : {-0.3, 0.3}) {
    Motion motion;
    motion.line = at;
    motion.line.back_mm += way_mm;
    motion.counts_backward = false;
    EXPECT_EQ(holds(at, 0.1, 1.0, motion), way_mm < 0.0);
    EXPECT_TRUE(holds(at, 0.1, 0.0, motion));
    motion.counts_backward = true;
    EXPECT_FALSE(holds(at, 0.1, 1.0, motion));
  }
}

TEST_P(DiscCertificate, StaysFailedUntilItIsRenewed) {
  DiscCertificates set(kDiscs, kDiscsApartMm, GetParam());
  const AxisLine at{0.1, 0.2, 0.0, 0.0, 3.0, -1.0};
  Motion still;
  still.line = at;
  Motion away = still;
  away.line.x_mm += 0.2;
  // None holds before it was made.
  set.check(still);
  for (std::size_t disc = 0; disc < kDiscs; ++disc) ASSERT_EQ(set.due()[disc], 1);
  for (std::size_t disc = 0; disc < kDiscs; ++disc) set.renew(static_cast<int>(disc), at, disc % 2 == 0 ? 0.1 : 0.3, 0);
  set.check(still);
  for (std::size_t disc = 0; disc < kDiscs; ++disc) ASSERT_EQ(set.due()[disc], 0);
  set.check(away);
  set.check(still);  // back again: what was missed between is not made good
  for (std::size_t disc = 0; disc < kDiscs; ++disc) ASSERT_EQ(set.due()[disc], disc % 2 == 0 ? 1 : 0);
  set.renew(10, at, 0.1, 0);
  set.check(still);
  EXPECT_EQ(set.due()[10], 0);
  EXPECT_EQ(set.due()[12], 1);
  set.fail_all();
  set.check(still);
  for (std::size_t disc = 0; disc < kDiscs; ++disc) ASSERT_EQ(set.due()[disc], 1);
}

TEST_P(DiscCertificate, HoldsNowhereWithoutRoom) {
  const AxisLine at{0.1, 0.2, 0.0, 0.0, 3.0, -1.0};
  Motion still;
  still.line = at;
  EXPECT_TRUE(holds(at, 1e-6, 0.5, still));
  for (const double none_mm : {0.0, -1e-6, -0.5, std::nan("")}) EXPECT_FALSE(holds(at, none_mm, 0.5, still)) << none_mm;
  still.slack_mm = 2e-6;
  EXPECT_FALSE(holds(at, 1e-6, 0.5, still));
}

}  // namespace
}  // namespace spinaltap
