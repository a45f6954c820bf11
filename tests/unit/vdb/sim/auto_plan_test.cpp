#include "vdb/sim/auto_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

SLOW_TESTS("AutoPlan.PredictsThrustsWithTheGivenDensityAndCuttingModel");

TEST(AutoPlan, SuggestsAScrewOfTheShippedTableForEachPedicleOfABakedVertebra) {
  RELEASE_ONLY();
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

TEST(AutoPlan, PredictsThrustsWithTheGivenDensityAndCuttingModel) {
  const Bone bone(bake_solid(Vertebra(), {.voxel_mm = 0.5}, 40.0));
  const test::TemporaryFolder folder;
  const auto thrust_n = [&](double density_g_cm3, double cutting) {
    const AutoPlanOptions options{.density = folder.path() / "density.json", .material = folder.path() / "model.json"};
    Json density = read_json(data_file("densities/vertebra.json"));
    density["density_at_0_hu_g_cm3"] = density_g_cm3;
    density["density_per_hu_g_cm3"] = 1e-6;  // the least that is taken
    write_json(density, options.density);
    Json model = read_json(data_file("materials/vertebra.json"));
    for (const char* key : {"specific_cutting_energy_mpa", "chisel_mpa"})
      model[key] = cutting * model[key].get<double>();
    write_json(model, options.material);
    return bone.suggest(options).front().best.value().grade.max_thrust_n;
  };
  const double reference_n = thrust_n(0.5, 1.0);
  ASSERT_GT(reference_n, 1.0);
  EXPECT_NEAR(thrust_n(1.0, 1.0) / reference_n, 4.0, 0.05) << "both exponents of density are 2";
  EXPECT_NEAR(thrust_n(0.5, 3.0) / reference_n, 3.0, 0.05) << "the model is linear in both";
}

TEST(AutoPlan, SaysThatABallIsNoVertebra) {
  const Bone ball(test::bake_ball({Vec3::Zero(), 12.0}, 0.5));
  EXPECT_THAT([&ball] { ball.suggest(); }, ThrowsMessage<Error>(HasSubstr("canal")));
}

}  // namespace
}  // namespace spinaltap
