#include "core/phantom/surroundings.h"

#include <gtest/gtest.h>

#include "core/phantom/scanner.h"
#include "core/phantom/spine_ground_truth.h"

namespace spinaltap {
namespace {

Level soft_level(const char* name) { return level_from_name(name).value(); }

TEST(SoftTissue, LiesAroundTheSpineWithTheNumbersOfEachTissue) {
  SpineOptions options;
  options.first = soft_level("T7");
  options.last = soft_level("L3");
  options.ribs = false;
  const Spine spine(options);
  const SoftTissue tissue(spine);
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  for (const DiscGroundTruth& disc : ground_truth.discs) EXPECT_NEAR(tissue.hu(disc.centre_mm), 90.0, 1.0);
  // Beside T8, well to the side and in front.
  EXPECT_LT(tissue.hu(ground_truth.levels[1].body_centre_mm + Vec3(55.0, -30.0, 0.0)), -800.0);
  EXPECT_GT(tissue.hu(ground_truth.levels.back().body_centre_mm + Vec3(50.0, 0.0, 0.0)), -150.0);
  // Left in front.
  const double front = 0.5 * level_measures(soft_level("T8")).body_depth_mm;
  EXPECT_NEAR(tissue.hu(ground_truth.levels[1].body_centre_mm + Vec3(11.0, -front - 13.0, 0.0)), 220.0, 1.0);
}

TEST(SoftTissue, TakesThePlaceOfEvenSurroundingsInAScan) {
  SpineOptions options;
  options.first = options.last = soft_level("L3");
  options.ribs = false;
  const Spine spine(options);
  const SoftTissue tissue(spine);
  const ScanOptions scanning = scan_of_box(
      Box3(Vec3(-50.0, -60.0, -6.0), Vec3(50.0, 60.0, 6.0)),
      {.pixel_mm = 1.0, .slice_step_mm = 2.0, .noise_hu = 0.0, .samples_per_pixel = 1, .samples_per_step = 1});
  const CtVolume ct = scan(spine, tissue, scanning), even = scan(spine, scanning);
  ASSERT_EQ(ct.geometry.size[0], 101);
  // In the aorta, and in the body as without.
  const Vec3 aorta(11.0, -0.5 * level_measures(soft_level("L3")).body_depth_mm - 13.0, 0.0);
  EXPECT_NEAR(sample_hu(ct, aorta), 220.0, 3.0);
  EXPECT_NEAR(sample_hu(even, aorta), 40.0, 1.0);
  EXPECT_NEAR(sample_hu(ct, Vec3(0.0, 0.0, 0.0)), sample_hu(even, Vec3(0.0, 0.0, 0.0)), 1.0);
}

}  // namespace
}  // namespace spinaltap
