// Breakthroughs are heard on phantoms that the listener was not set on; many more: tests/regression.

#include <gtest/gtest.h>

#include "tests/support/heard_drilling.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

SLOW_TESTS("HeardBreakthroughs.AreHeardWithin140MsOnUnseenPhantoms");

TEST(HeardBreakthroughs, AreHeardWithin140MsOnUnseenPhantoms) {
  // ListenerOptions was set on the seeds 1 to 12.
  test::HeardFigures figures;
  for (std::uint64_t seed = 101; seed <= 104; ++seed) {
    for (const bool is_left : {true, false}) {
      const test::HeardDrilling drilling = test::hear_pedicle(seed, is_left);
      figures.add(drilling);
      EXPECT_FALSE(std::isnan(drilling.late_s())) << "seed " << seed << (is_left ? " left" : " right");
    }
  }
  figures.print("seeds 101 to 104");
  EXPECT_EQ(figures.false_alarms, 0U);
}

}  // namespace
}  // namespace spinaltap
