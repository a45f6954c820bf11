// What a plan says where it leans on bone that the segmentation was not sure of: the real L3, with its label map and
// without. See tests/support/test_data.h for where it lies.

#include <gtest/gtest.h>

#include <cstdio>

#include "core/anatomy/bone_shape.h"
#include "core/ct/read_ct.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("DoubtfulPaths.*");

TEST(DoubtfulPaths, OfARealL3SayWhereItsSegmentationIsUnsure) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  const CtVolume ct = read_ct(folder / "sub-ct_label-22_ct.nii.gz");
  BakeCtOptions with_map;
  with_map.labels = LabelChoice{folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22};
  const Bone drawn(bake_ct(ct, with_map).bone), found(bake_ct(ct).bone);
  const std::vector<Suggestion> by_map = drawn.suggest(), alone = found.suggest();
  int plain = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const SuggestedPath& best = alone[side].best.value();
    const double off_mm = (best.path.entry_mm - by_map[side].best.value().path.entry_mm).norm();
    std::printf("%s: %s, entry %.1f mm from the map's, %.2f mm out of its bone\n", alone[side].side.c_str(),
                grade_in_words(best.grade).c_str(), off_mm, drawn.shape().distance_mm(best.path.entry_mm));
    EXPECT_EQ(grade_in_words(by_map[side].best->grade), "A") << "nothing is known against a map";
    // A trajectory is one of many as good, but all enter where there is bone.
    EXPECT_LT(off_mm, 4.0);
    EXPECT_LT(drawn.shape().distance_mm(best.path.entry_mm), 0.5);
    plain += grade_in_words(best.grade) == "A" ? 1 : 0;
  }
  EXPECT_GE(plain, 1) << "a word for all is none";
  // As it was suggested once: its entry lies 9.2 mm from the map's, where the map has no bone.
  DrillPath led_astray{"left", Vec3(43.66, 207.6, -56.55), Vec3(42.5, 162.9, -61.24), {}};
  led_astray.screw = PedicleScrew{"", 5.0, 45.0, 4.0};
  const PathGrade graded = grade(found, led_astray);
  std::printf("as it was: %s\n", grade_in_words(graded).c_str());
  ASSERT_EQ(graded.doubts.size(), 1U);
  EXPECT_LT(graded.doubts[0].without_mm, -1.0) << "as far as the map's bone lies from it";
  EXPECT_LT(graded.doubts[0].depth_mm, 1.0);
}

}  // namespace
}  // namespace spinaltap
