// Drilling through the pedicles of a phantom that came through the whole chain: its CT, segmented, fitted and baked.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/phantom/scanner.h"
#include "tests/support/pedicle_drilling.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/bake_ct.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("PedicleChain.*");

TEST(PedicleChain, TellsStatesAtThePhantomsTrueBoundaries) {
  constexpr double kAskedMm = 0.5;
  const Vertebra vertebra;
  const BakedCt baked = bake_ct(scan(vertebra));
  const BoneSampler bone = [&](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    baked.bone.sample(points_mm, distance_mm, hu);
  };
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  for (const PedicleGroundTruth& pedicle : {ground_truth.left, ground_truth.right}) {
    for (const DrillBit& bit : {twist_drill(3.0, 70.0, 118.0, 0.48), DrillBit{3.0, 70.0, 5.0}}) {
      const DrillPath path = test::path_through(pedicle, bit);
      const test::TrueBoundaries is = test::true_boundaries(vertebra, path);
      const test::PedicleRun run = test::drill_pedicle(path, bone);
      const auto found = [&](DrillState state) { return run.begin_mm(state).value_or(std::nan("")); };
      const double end_mm = run.depth_mm(EventKind::breakthrough).value_or(std::nan(""));
      std::printf(
          "surface %.3f mm (true %.3f), cortex ends %.3f (%.3f), rising from %.3f, far cortex %.3f (%.3f), "
          "end %.3f (%.3f)\n",
          found(DrillState::outer_cortical), is.outer_mm, found(DrillState::cancellous), is.cortex_end_mm,
          found(DrillState::transitional), found(DrillState::inner_cortical), is.far_cortex_mm, end_mm, is.end_mm);
      EXPECT_NEAR(found(DrillState::outer_cortical), is.outer_mm, kAskedMm);
      EXPECT_NEAR(found(DrillState::cancellous), is.cortex_end_mm, kAskedMm);
      EXPECT_NEAR(found(DrillState::inner_cortical), is.far_cortex_mm, kAskedMm);
      EXPECT_NEAR(end_mm, is.end_mm, kAskedMm);
    }
  }
}

}  // namespace
}  // namespace spinaltap
