// A coupled tool in 10,000 hands (docs/coupling.md): seeds 0 to 10,999 are for whoever changes the coupling, these are
// others.

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "tests/support/coupled_hand.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

class CoupledHands : public testing::Test {
 protected:
  static constexpr std::uint64_t kFirst = 11'000;
  static constexpr std::size_t kHands = 10'000;

  static void SetUpTestSuite() {
    outcomes_.resize(kHands);
    tbb::parallel_for(std::size_t{0}, kHands,
                      [](std::size_t n) { outcomes_[n] = test::CoupledHand(kFirst + n).run(); });
  }
  static std::uint64_t seed(std::size_t n) { return kFirst + n; }

  static inline std::vector<test::CoupledHand::Outcome> outcomes_;
};

WHOLE_RUNS("CoupledHands.*");

TEST_F(CoupledHands, GetNoMoreEnergyThanTheyPutInButAMillijoule) {
  double most = 0.0;
  for (std::size_t n = 0; n < kHands; ++n) {
    EXPECT_LE(outcomes_[n].max_given_n_mm, 1.0) << "seed " << seed(n);
    most = std::max(most, outcomes_[n].max_given_n_mm);
  }
  RecordProperty("max_given_mj", std::to_string(most));
}

TEST_F(CoupledHands, FeelNoLimitCycleInAirOrAtRestOnBone) {
  double most = 0.0;
  for (std::size_t n = 0; n < kHands; ++n) {
    if (seed(n) % 3 == static_cast<std::uint64_t>(test::HandTask::drills)) continue;
    EXPECT_LE(outcomes_[n].still_n, 0.05) << "seed " << seed(n);
    most = std::max(most, outcomes_[n].still_n);
  }
  RecordProperty("max_still_n", std::to_string(most));
}

TEST_F(CoupledHands, FeelTheThrustOfTheLaw) {
  for (std::size_t n = 0; n < kHands; ++n) {
    if (seed(n) % 3 != static_cast<std::uint64_t>(test::HandTask::drills)) continue;
    EXPECT_GT(outcomes_[n].feed_mm_s, 0.05) << "seed " << seed(n);
    EXPECT_NEAR(outcomes_[n].thrust_error, 0.0, 0.03) << "seed " << seed(n);
  }
}

TEST_F(CoupledHands, NeverFeelAJumpOrMoreThanTheDeviceGives) {
  for (std::size_t n = 0; n < kHands; ++n) {
    EXPECT_LE(outcomes_[n].max_n, 1.0 + 1e-9) << "seed " << seed(n);
    EXPECT_LE(outcomes_[n].max_change, 1.0 + 1e-9) << "seed " << seed(n);
  }
}

}  // namespace
}  // namespace spinaltap
