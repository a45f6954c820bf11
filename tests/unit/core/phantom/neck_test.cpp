#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/phantom/spine.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

SpineOptions whole_neck() {
  SpineOptions options;
  options.first = Level::kC1;
  options.last = Level::kT1;
  options.skull = true;
  return options;
}

TEST(Neck, HasEachPedicleExactlyAsWideAndHighAsItsLevelsMeasures) {
  const Spine spine(whole_neck());
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  ASSERT_EQ(ground_truth.levels.size(), 6U);  // C3 to T1: C1 and C2 are simple solids
  for (std::size_t n = 0; n < ground_truth.levels.size(); ++n) {
    const LevelGroundTruth& level = ground_truth.levels[n];
    const LevelMeasures& m = level_measures(level.level);
    SCOPED_TRACE(level_name(level.level));
    EXPECT_EQ(level.level, static_cast<Level>(n + 3));
    for (const PedicleGroundTruth& side : {level.pedicles.left, level.pedicles.right}) {
      EXPECT_EQ(side.width_mm, m.pedicle_width_mm);
      for (const auto& [axis, size_mm] :
           {std::pair(side.width_axis, side.width_mm), {side.height_axis, side.height_mm}}) {
        EXPECT_NEAR(spine.part_value_mm(n + 2, side.isthmus_mm + 0.5 * size_mm * axis), 0.0, 1e-6);
      }
    }
  }
}

TEST(Neck, HasBodiesDiscsAndTipsOfTheirMeasures) {
  const Spine spine(whole_neck());
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  ASSERT_EQ(ground_truth.discs.size(), 6U);  // none around the dens
  for (const DiscGroundTruth& disc : ground_truth.discs) EXPECT_NEAR(disc.height_mm, 5.0, 0.5);
  for (std::size_t n = 0; n + 1 < ground_truth.levels.size(); ++n) {
    const LevelGroundTruth& level = ground_truth.levels[n];
    const LevelMeasures& m = level_measures(level.level);
    SCOPED_TRACE(level_name(level.level));
    // Across the tips within 2 mm; the body's front and side where the measures have them, but for the waist (a tenth).
    EXPECT_NEAR((level.left_transverse_tip_mm - level.right_transverse_tip_mm).norm(), m.transverse_span_mm, 2.0);
    const PlacedLevel& placed = spine.placed()[n + 2];
    const Vec3 front = placed.position_mm - 0.5 * m.body_depth_mm * placed.rotation.col(1);
    EXPECT_NEAR(spine.part_value_mm(n + 2, front), 0.0, 0.1 * m.body_depth_mm);
    EXPECT_LT(spine.part_value_mm(n + 2, placed.position_mm), -4.0);
  }
  // 25 degrees from C3 to C7, 3 more to T1.
  const auto lean_deg = [&](std::size_t n) {
    const Vec3 up = spine.placed()[n].rotation.col(2);
    return std::atan2(-up.y(), up.z()) / kDegree;
  };
  EXPECT_NEAR(lean_deg(6) - lean_deg(2), 25.0, 0.1);
}

TEST(Neck, HasLabelsOfItsUpperLevelsAndNoneOfALevelForTheSkull) {
  const Spine spine(whole_neck());
  GridGeometry geometry;
  geometry.spacing_mm = Vec3::Constant(3.0);
  const Box3 box = spine.bounds_mm();
  for (int axis = 0; axis < 3; ++axis) {
    geometry.size[static_cast<std::size_t>(axis)] = static_cast<int>(box.sizes()[axis] / 3.0) + 1;
  }
  geometry.origin_mm = box.min();
  const LabelVolume labels = true_labels(spine, geometry);
  EXPECT_EQ(labels.names.at(1).name, "C1");
  EXPECT_EQ(labels.names.at(2).name, "C2");
  EXPECT_EQ(labels.names.at(kOtherBoneLabel).name, "other bone");
  EXPECT_EQ(labels.names.at(kOtherBoneLabel).level, Level::kNone);
  // The top of the skull, and the middle of C2's dens.
  EXPECT_EQ(spine.label_at(spine.placed()[0].position_mm + Vec3(0.0, -24.0, 77.0 + 66.0)), kOtherBoneLabel);
  EXPECT_EQ(spine.label_at(spine.placed()[0].position_mm), 2);
}

TEST(Neck, RejectsOptionsWithoutSense) {
  const auto rejection = [](const SpineOptions& options) {
    return test::error_of([&] { const Spine spine(options); });
  };
  SpineOptions options;
  options.skull = true;
  EXPECT_NE(rejection(options).find("a skull needs C1"), std::string::npos) << rejection(options);
  options = {};
  options.first = Level::kC1;
  options.last = Level{2};
  EXPECT_NE(rejection(options).find("from C3 to L5"), std::string::npos) << rejection(options);
  options = {};
  options.cervical_lordosis_deg = 90.0;
  EXPECT_NE(rejection(options).find("cervical_lordosis_deg"), std::string::npos) << rejection(options);
}

}  // namespace
}  // namespace spinaltap
