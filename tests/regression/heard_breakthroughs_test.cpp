// What a listener to the drill's sound finds, on the phantoms that it was set on and on others: docs/sound.md.

#include <gtest/gtest.h>

#include "tests/support/heard_drilling.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

test::HeardFigures heard_figures(std::uint64_t first, std::uint64_t last, const char* what,
                                 const test::HeardConditions& conditions = {}) {
  test::HeardFigures figures;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    for (const bool is_left : {true, false}) {
      const test::HeardDrilling drilling = test::hear_pedicle(seed, is_left, conditions);
      if (std::isnan(drilling.late_s()) || drilling.false_alarms() > 0) {
        std::printf("seed %d %s, through at %.3f s:", static_cast<int>(seed), is_left ? "left" : "right",
                    drilling.through_s);
        for (const HeardBreakthrough& one : drilling.heard)
          std::printf(" heard %+.3f", one.time_s - drilling.through_s);
        std::printf("\n");
      }
      figures.add(drilling);
    }
  }
  figures.print(what);
  return figures;
}

WHOLE_RUNS("HeardBreakthroughsOfManyPhantoms.*");

TEST(HeardBreakthroughsOfManyPhantoms, AreFoundOnThoseThatTheListenerWasSetOn) {
  const test::HeardFigures figures = heard_figures(1, 12, "seeds 1 to 12");
  EXPECT_EQ(figures.found, figures.drillings);
  EXPECT_EQ(figures.false_alarms, 0U);
}

TEST(HeardBreakthroughsOfManyPhantoms, AreFoundOnUnseenOnes) {
  const test::HeardFigures figures = heard_figures(101, 150, "seeds 101 to 150");
  EXPECT_GE(figures.found, 95 * figures.drillings / 100);
  EXPECT_LE(figures.false_alarms, 5 * figures.drillings / 100);
}

TEST(HeardBreakthroughsOfManyPhantoms, AreFoundUnderOtherConditions) {
  const auto found_at_least = [](int percent, const char* what, const test::HeardConditions& conditions) {
    const test::HeardFigures figures = heard_figures(201, 210, what, conditions);
    EXPECT_GE(figures.found * 100, static_cast<std::size_t>(percent) * figures.drillings) << what;
  };
  found_at_least(90, "other noise", {.sound_seed = 77});
  found_at_least(90, "a cycle each ms", {.rate_hz = 1000.0});
  found_at_least(90, "2 mm/s", {.feed_mm_s = 2.0, .rate_hz = 200.0});
  found_at_least(90, "3000 rpm", {.rpm = 3000.0});
  found_at_least(90, "a drill of 2.5 mm", {.bit = twist_drill(2.5, 70.0, 118.0, 0.4)});
  // At half the feed the tip takes twice the time for the last tenths of the bone: told, not asked.
  found_at_least(0, "0.5 mm/s", {.feed_mm_s = 0.5});
}

}  // namespace
}  // namespace spinaltap
