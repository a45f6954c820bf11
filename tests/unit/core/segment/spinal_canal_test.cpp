#include "core/segment/spinal_canal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/release_only.h"
#include "tests/support/spine_scan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

/// The points of a canal lie in the true one, and go past each level's body. In the soft tissue the aorta, with
/// contrast as bright as thin bone, lies in front of the column.
void expect_true_canal(const SpinalCanal& canal, const Spine& spine) {
  ASSERT_FALSE(canal.points_mm.empty());
  ASSERT_EQ(canal.points_mm.size(), canal.support.size());
  for (const PlacedLevel& placed : spine.placed()) {
    const Vertebra& vertebra = test::vertebra_of(spine, placed.level);
    const VertebraAnatomy& anatomy = vertebra.anatomy();
    int beside = 0;
    for (const Vec3& p_mm : canal.points_mm) {
      const Vec3 p = vertebra.to_own(p_mm);
      if (std::abs(p.z()) > 0.5 * anatomy.body.height_mm) continue;
      ++beside;
      // Between the pedicles, behind the body, in front of the arch.
      EXPECT_LT(std::abs(p.x()), 0.5 * anatomy.canal.width_mm) << level_name(placed.level);
      EXPECT_GT(p.y(), anatomy.canal.front_mm) << level_name(placed.level);
      EXPECT_LT(p.y(), anatomy.canal.back_mm) << level_name(placed.level);
      EXPECT_EQ(spine.label_at(p_mm), 0) << level_name(placed.level);
    }
    const bool is_end = placed.level == spine.placed().front().level || placed.level == spine.placed().back().level;
    if (!is_end) {
      EXPECT_GE(beside, 0.7 * anatomy.body.height_mm / SpinalCanal::kStepMm) << level_name(placed.level);
    }
  }
  for (std::size_t n = 1; n < canal.points_mm.size(); ++n) {
    EXPECT_GT(canal.points_mm[n].z(), canal.points_mm[n - 1].z());
  }
}

SLOW_TESTS("SpinalCanalOfAScan.LiesInTheTrueOneBehindABrightAorta");

TEST(SpinalCanalOfAScan, LiesInTheTrueOneBehindABrightAorta) {
  SpineOptions options;
  options.first = Level{17};  // T10
  options.last = Level{22};   // L3
  const Spine spine(options);
  const CtVolume ct = test::scan_spine(spine);
  const BoneLevels levels = choose_bone_levels(ct);
  expect_true_canal(CanalFinder(ct, levels).find(), spine);
  expect_true_canal(
      CanalFinder(ct, levels).find({.near_mm = test::vertebra_of(spine, Level::kL1).to_patient(Vec3::Zero())}), spine);
}

TEST(SpinalCanalOfAScan, FollowsAScoliosisOf30Degrees) {
  RELEASE_ONLY();
  SpineOptions options;
  options.first = Level{15};  // T8
  options.last = Level{22};
  options.scoliosis_deg = 30.0;
  const Spine spine(options);
  const CtVolume ct = test::scan_spine(spine);
  expect_true_canal(CanalFinder(ct, choose_bone_levels(ct)).find(), spine);
}

}  // namespace
}  // namespace spinaltap
