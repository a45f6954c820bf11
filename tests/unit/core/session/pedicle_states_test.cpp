// The states of drilling through the phantom's pedicle, against its known layers.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/phantom/scanner.h"
#include "tests/support/gridded_field.h"
#include "tests/support/pedicle_drilling.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

constexpr double kStateMm = 0.5;

class PedicleStates : public ::testing::Test {
 protected:
  static const Vertebra& vertebra() {
    static const Vertebra vertebra;
    return vertebra;
  }
  static const CtVolume& ct() {
    // The phantom alone, at the paper's resolution, blur and noise.
    static const CtVolume ct = scan(vertebra(), {.columns = 260, .rows = 260, .slices = 120});
    return ct;
  }
  /// The phantom's own layers, sharp.
  static BoneSampler formulas() {
    return [](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
      std::vector<double> values_mm(points_mm.size());
      vertebra().evaluate(points_mm, values_mm, {});
      for (std::size_t n = 0; n < points_mm.size(); ++n) {
        distance_mm[n] = static_cast<float>(values_mm[n]);
        hu[n] = static_cast<float>(vertebra().hu(points_mm[n], values_mm[n], 0.0));
      }
    };
  }
  /// What a CT shows of them.
  static BoneSampler scanned() {
    return [](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
      std::vector<double> values_mm(points_mm.size());
      vertebra().evaluate(points_mm, values_mm, {});
      for (std::size_t n = 0; n < points_mm.size(); ++n) {
        distance_mm[n] = static_cast<float>(values_mm[n]);
        hu[n] = static_cast<float>(sample_hu(ct(), points_mm[n]));
      }
    };
  }

  static void expect_states_at_true_boundaries(const BoneSampler& bone, const char* name) {
    const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra());
    for (const PedicleGroundTruth& pedicle : {ground_truth.left, ground_truth.right}) {
      for (const DrillBit& bit : {twist_drill(3.0, 70.0, 118.0, 0.48), DrillBit{3.0, 70.0, 5.0}}) {
        const DrillPath path = test::path_through(pedicle, bit);
        const test::TrueBoundaries is = test::true_boundaries(vertebra(), path);
        const test::PedicleRun run = test::drill_pedicle(path, bone);
        const auto found = [&](DrillState state) { return run.begin_mm(state).value_or(std::nan("")); };
        const double end_mm = run.depth_mm(EventKind::breakthrough).value_or(std::nan(""));
        std::printf(
            "%s, tip %.1f mm: surface %.3f (true %.3f), cortex ends %.3f (%.3f), rising from %.3f, far cortex "
            "%.3f (%.3f), end %.3f (%.3f)\n",
            name, bit.tip_length_mm, found(DrillState::outer_cortical), is.outer_mm, found(DrillState::cancellous),
            is.cortex_end_mm, found(DrillState::transitional), found(DrillState::inner_cortical), is.far_cortex_mm,
            end_mm, is.end_mm);
        EXPECT_NEAR(found(DrillState::outer_cortical), is.outer_mm, kStateMm);
        EXPECT_NEAR(found(DrillState::cancellous), is.cortex_end_mm, kStateMm);
        EXPECT_NEAR(found(DrillState::inner_cortical), is.far_cortex_mm, kStateMm);
        EXPECT_NEAR(end_mm, is.end_mm, kStateMm);
        // The way between is told as well: never back to the entry's states, and dense just before the far cortex.
        EXPECT_LT(found(DrillState::transitional), found(DrillState::inner_cortical));
        EXPECT_GT(found(DrillState::transitional), found(DrillState::cancellous));
        EXPECT_NEAR(run.depth_mm(EventKind::contact).value_or(std::nan("")), is.outer_mm, kStateMm);
        EXPECT_EQ(run.cycles.back().state, DrillState::inner_cortical);
      }
    }
  }
};

SLOW_TESTS("PedicleStates.*");

TEST_F(PedicleStates, BeginAtTheSharpLayersBoundaries) { expect_states_at_true_boundaries(formulas(), "formulas"); }

TEST_F(PedicleStates, BeginAtTheTrueBoundariesInACtToo) { expect_states_at_true_boundaries(scanned(), "scanned"); }

}  // namespace
}  // namespace spinaltap
