#include "core/session/drill_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using Begin = std::pair<DrillState, double>;

/// Goes to `to_mm` in steps of `step_mm` through densities by depth; the states and where they began. `end_mm`: where
/// the bone ends, if that is known.
std::vector<Begin> states_along(const std::function<double(double)>& density_g_cm3, double to_mm = 20.0,
                                double step_mm = 0.01, const StateRules& rules = {}, double end_mm = test::kNan) {
  StateRecogniser recogniser(rules);
  std::vector<Begin> begins;
  DrillState state = recogniser.state();
  for (int n = 0; n * step_mm <= to_mm; ++n) {
    const double depth_mm = -2.0 + n * step_mm;
    const TipMeets tip{depth_mm, density_g_cm3(depth_mm), end_mm - depth_mm};
    if (recogniser.update(tip) == state) continue;
    state = recogniser.state();
    begins.emplace_back(state, recogniser.begin_mm());
  }
  return begins;
}

void expect_begins(const std::vector<Begin>& found, const std::vector<Begin>& expected, double tolerance_mm = 0.011) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) {
    EXPECT_EQ(found[n].first, expected[n].first) << n;
    EXPECT_NEAR(found[n].second, expected[n].second, tolerance_mm) << name_of(expected[n].first);
  }
}

/// A pedicle: cortex for 1 mm, cancellous bone, a rise over 0.5 mm, the far cortex, air.
double pedicle(double depth_mm) {
  if (depth_mm < 0.0 || depth_mm > 11.5) return 0.0;
  if (depth_mm < 1.0) return 1.4;
  if (depth_mm < 10.0) return 0.3;
  return depth_mm < 10.5 ? 0.3 + (depth_mm - 10.0) / 0.5 * 1.1 : 1.4;
}

TEST(StateRecogniser, TellsTheFiveStatesOfAPedicle) {
  // Without a surface 0.65 g/cm3 is cortex, which the rise passes at 10.159 mm, and half of the way there at 10.08 mm.
  expect_begins(states_along(pedicle), {{DrillState::outer_cortical, 0.0},
                                        {DrillState::cancellous, 1.0},
                                        {DrillState::transitional, 10.08},
                                        {DrillState::inner_cortical, 10.159}});
}

TEST(StateRecogniser, SaysWhereAStateBeganWhateverTheSteps) {
  for (const double step_mm : {0.001, 0.01, 0.05}) {
    const std::vector<Begin> begins = states_along(pedicle, 15.0, step_mm);
    ASSERT_EQ(begins.size(), 4U) << step_mm;
    EXPECT_NEAR(begins[1].second, 1.0, step_mm + 1e-6);
    EXPECT_NEAR(begins[3].second, 10.159, step_mm + 1e-6);
  }
}

TEST(StateRecogniser, TakesAStrutForNoCortex) {
  const auto with_strut = [](double depth_mm) {
    if (depth_mm > 4.0 && depth_mm < 4.05) return 1.2;  // thinner than hold_mm
    return depth_mm > 6.0 && depth_mm < 6.4 ? 0.6 : pedicle(depth_mm);
  };
  expect_begins(states_along(with_strut),
                {{DrillState::outer_cortical, 0.0},
                 {DrillState::cancellous, 1.0},
                 {DrillState::transitional, 6.0},
                 {DrillState::cancellous, 6.4},
                 {DrillState::transitional, 10.08},
                 {DrillState::inner_cortical, 10.159}},
                0.02);  // the strut is cancellous bone, and raises its mean
}

TEST(StateRecogniser, TakesNothingForTheFarCortexThatIsFarFromTheFarSide) {
  // A pedicle as dense as cortex for 4 mm; and bone that goes on behind it.
  const auto narrow = [](double depth_mm) { return depth_mm > 4.0 && depth_mm < 8.0 ? 1.2 : pedicle(depth_mm); };
  EXPECT_EQ(states_along(narrow).back().first, DrillState::inner_cortical);
  expect_begins(states_along(narrow, 9.0, 0.01, {}, 40.0),
                {{DrillState::outer_cortical, 0.0}, {DrillState::cancellous, 1.0}});
}

TEST(StateRecogniser, MeasuresTheFarCortexByItsOwnDensity) {
  // An old woman's: 0.8 g/cm3 at the entry, marrow as light as nothing, a far cortex blurred to 0.3 over 1.5 mm.
  const auto soft = [](double depth_mm) {
    if (depth_mm < 0.0 || depth_mm > 20.0) return 0.0;
    if (depth_mm < 1.5) return 0.8;
    return depth_mm < 18.5 ? 0.02 : std::min(0.3, 0.02 + (depth_mm - 18.5) / 1.0 * 0.28);
  };
  // Half way from 0.02 to 0.3 is passed at 19 mm.
  const std::vector<Begin> begins = states_along(soft, 25.0, 0.01, {}, 20.0);
  ASSERT_GE(begins.size(), 3U);
  EXPECT_NEAR(begins[1].second, 1.5, 0.011);
  EXPECT_EQ(begins.back().first, DrillState::inner_cortical);
  EXPECT_NEAR(begins.back().second, 19.0, 0.05);
  // By the entry's cortex it has none.
  EXPECT_EQ(states_along(soft, 25.0).back().first, DrillState::cancellous);
}

TEST(StateRecogniser, TellsNoFarCortexWhereThereIsNone) {
  const auto even = [](double depth_mm) {
    return depth_mm < 0.0 || depth_mm > 12.0 ? 0.0 : depth_mm < 1.0 ? 1.2 : 0.2;
  };
  expect_begins(states_along(even, 15.0, 0.01, {}, 12.0),
                {{DrillState::outer_cortical, 0.0}, {DrillState::cancellous, 1.0}});
}

TEST(StateRecogniser, WaitsForTheCortexUnderABlurredSurface) {
  // A CT's edge: 0.3 mm from soft tissue's density to cortex. And the cortex's inner edge lingers above `rising`.
  const auto blurred = [](double depth_mm) {
    if (depth_mm < 0.0) return 0.0;
    if (depth_mm < 0.3) return 0.15 + depth_mm / 0.3;
    if (depth_mm < 1.0) return 1.15;
    return depth_mm < 1.5 ? 0.5 : 0.3;
  };
  expect_begins(states_along(blurred, 8.0), {{DrillState::outer_cortical, 0.0}, {DrillState::cancellous, 1.0}});
}

TEST(StateRecogniser, GoesOnWithoutACortexAtTheEntry) {
  const auto bare = [](double depth_mm) { return depth_mm < 0.0 ? 0.0 : 0.3; };
  StateRules rules;
  rules.no_cortex_mm = 0.7;
  const std::vector<Begin> begins = states_along(bare, 5.0, 0.01, rules);
  expect_begins(begins, {{DrillState::outer_cortical, 0.0}, {DrillState::cancellous, 0.0}});
}

TEST(StateRecogniser, LearnsNothingOnTheWayBackAndInTheHole) {
  StateRecogniser recogniser;
  for (int n = 0; n <= 500; ++n) recogniser.update({0.01 * n, pedicle(0.01 * n)});
  EXPECT_EQ(recogniser.state(), DrillState::cancellous);
  for (int n = 500; n >= 0; --n) recogniser.update({0.01 * n, 1.4});
  for (int n = 0; n <= 500; ++n) recogniser.update({0.01 * n, 1.4});
  EXPECT_EQ(recogniser.state(), DrillState::cancellous);
  EXPECT_NEAR(recogniser.begin_mm(), 1.0, 0.011);
}

TEST(StateRecogniser, TakesDensitiesThatAreNoNumberForNone) {
  StateRecogniser recogniser;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int n = 0; n < 100; ++n) recogniser.update({0.01 * n, nan});
  EXPECT_EQ(recogniser.state(), DrillState::initial);
  recogniser.update({nan, 1.4});
  EXPECT_EQ(recogniser.state(), DrillState::initial);
}

TEST(StateRecogniser, RejectsRulesWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const StateRules& rules :
       {StateRules{.contact_g_cm3 = 0.0}, StateRules{.contact_g_cm3 = 0.5}, StateRules{.cortical_g_cm3 = 0.1},
        StateRules{.cortical_g_cm3 = nan}, StateRules{.cancellous_g_cm3 = nan}, StateRules{.hold_mm = -0.1},
        StateRules{.hold_mm = nan}, StateRules{.no_cortex_mm = nan}, StateRules{.near_mm = nan},
        StateRules{.rise = 0.9}}) {
    EXPECT_THROW(StateRecogniser{rules}, Error);
  }
}

TEST(DrillState, HasNames) {
  EXPECT_EQ(name_of(DrillState::initial), "initial");
  EXPECT_EQ(name_of(DrillState::outer_cortical), "outer cortical");
  EXPECT_EQ(name_of(DrillState::cancellous), "cancellous");
  EXPECT_EQ(name_of(DrillState::transitional), "transitional");
  EXPECT_EQ(name_of(DrillState::inner_cortical), "inner cortical");
}

}  // namespace
}  // namespace spinaltap
