#include "vdb/grid/bone_model.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

TEST(BoneDensity, IsTheLawsOfTheCtNumber) {
  const test::Ball ball{Vec3(3.1, -2.3, 105.7), 6.0};
  const BoneModel bone = test::bake_ball(ball, 0.5, 300);
  const DensityLaw law{0.1, 0.002};
  // In the middle, near the surface, and where there is air.
  const std::vector<Vec3> points_mm{ball.centre_mm, ball.centre_mm + Vec3(5.9, 0.0, 0.0),
                                    ball.centre_mm + Vec3(0.0, 40.0, 0.0)};
  std::vector<float> density_g_cm3(3, -1.0F);
  bone_density(bone, law, points_mm, density_g_cm3);
  EXPECT_FLOAT_EQ(density_g_cm3[0], 0.7F);
  EXPECT_FLOAT_EQ(density_g_cm3[1], 0.7F);
  EXPECT_EQ(density_g_cm3[2], 0.0F);
}

}  // namespace
}  // namespace spinaltap
