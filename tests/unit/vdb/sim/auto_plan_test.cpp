#include "vdb/sim/auto_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(AutoPlan, SuggestsAScrewOfTheShippedTableForEachPedicleOfABakedVertebra) {
  const Vertebra vertebra;
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  const Bone bone(bake_solid(vertebra, {.voxel_mm = 0.5}, 40.0));
  EXPECT_TRUE(bone.landmarks().warnings.empty()) << bone.landmarks().warnings.front();
  AutoPlanOptions options;
  options.bit.diameter_mm = 2.7;
  const std::vector<DrillPath> paths = paths_of(auto_plan(bone.walls(), bone.hu_sampler(), options));
  ASSERT_EQ(paths.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {
    const PedicleGroundTruth& pedicle = n == 0 ? ground_truth.left : ground_truth.right;
    EXPECT_EQ(paths[n].name, n == 0 ? "left" : "right");
    EXPECT_EQ(paths[n].bit.diameter_mm, 2.7);
    ASSERT_TRUE(paths[n].screw);
    EXPECT_GE(paths[n].screw->diameter_mm, 6.5);
    EXPECT_LE(paths[n].screw->diameter_mm, 7.0) << "of 9.0 mm 80 % are 7.2, and 1 mm on each side is kept";
    const double way_mm =
        (pedicle.isthmus_mm - paths[n].entry_mm).dot(pedicle.axis) / paths[n].direction().dot(pedicle.axis);
    const Vec3 off_mm = paths[n].entry_mm + way_mm * paths[n].direction() - pedicle.isthmus_mm;
    EXPECT_LT(std::abs(off_mm.dot(pedicle.width_axis)), 0.5);
  }
  options.margin_mm = 4.0;
  EXPECT_THAT([&] { paths_of(auto_plan(bone.walls(), bone.hu_sampler(), options)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("left"), HasSubstr("right"), HasSubstr("4 mm of bone"))));
}

TEST(AutoPlan, SaysThatABallIsNoVertebra) {
  const Bone ball(test::bake_ball({Vec3::Zero(), 12.0}, 0.5));
  EXPECT_THAT([&ball] { ball.suggest(); }, ThrowsMessage<Error>(HasSubstr("canal")));
}

}  // namespace
}  // namespace spinaltap
