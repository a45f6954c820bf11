#include "core/segment/vertebral_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace spinaltap {
namespace {

/// A hollow elliptic cylinder of bone, 44 x 32 x 26 mm with a wall of 1.5 mm at 500 HU, marrow as dark as the soft
/// tissue around it, between two plates of bone 7 mm above and below; with normal noise.
FloatGrid body_ct(const BodyCylinder& body, double noise_hu, std::uint64_t seed) {
  FloatGrid grid;
  grid.geometry.size = {80, 80, 80};
  grid.geometry.origin_mm = Vec3::Constant(-39.5);
  const Mat3 to_body = body.axes().transpose();
  for (int k = 0; k < 80; ++k) {
    for (int j = 0; j < 80; ++j) {
      for (int i = 0; i < 80; ++i) {
        const Vec3 p_mm = grid.geometry.to_patient(Vec3(i, j, k));
        const Vec3 p = to_body * (p_mm - body.centre_mm);
        BodyCylinder hollow = body;
        hollow.half_mm -= Vec3::Constant(1.5);
        const bool in_wall = body.scale_to(p_mm) < 1.0 && hollow.scale_to(p_mm) > 1.0;
        const bool in_plate =
            std::abs(std::abs(p.z()) - body.half_mm.z() - 7.75) < 0.75 && std::hypot(p.x(), p.y()) < 20;
        const double hu = (in_wall || in_plate ? 500.0 : 40.0) + noise_hu * random_normal(seed, grid.values.size());
        grid.values.push_back(static_cast<float>(hu));
      }
    }
  }
  return gaussian_blur(grid, 0.9);
}

BodyCylinder true_body() {
  BodyCylinder body;
  body.centre_mm = Vec3(2.0, -3.0, 1.0);
  body.half_mm = Vec3(22.0, 16.0, 13.0);
  body.turn_rad = Vec3(-0.25, 0.1, 0.0);
  return body;
}

class SeedInBody : public ::testing::TestWithParam<Vec3> {};

TEST_P(SeedInBody, FindsTheCylinderThroughNoise) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const BodyCylinder truth = true_body();
  const FloatGrid hu = body_ct(truth, 80.0, kSeed);
  const Vec3 seed_mm = truth.centre_mm + truth.axes() * GetParam();
  const BodyCylinder found = fit_body_cylinder(hu, seed_mm, {115.0});
  EXPECT_TRUE(found.is_body());
  // Within a voxel and a half; the edge is taken up to 0.8 mm outside the wall's crest.
  EXPECT_LT((found.centre_mm - truth.centre_mm).norm(), 1.5);
  EXPECT_LT((found.half_mm - truth.half_mm).cwiseAbs().maxCoeff(), 1.5) << found.half_mm.transpose();
  EXPECT_LT((found.axes().col(2) - truth.axes().col(2)).norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Places, SeedInBody,
                         ::testing::Values(Vec3(0, 0, 0), Vec3(17, 0, 0), Vec3(-10, 9, -6), Vec3(0, -13, 4),
                                           Vec3(5, 5, 10)));

TEST(FindVertebralBody, FollowsTheWallOnAllSides) {
  constexpr std::uint64_t kSeed = 12;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const BodyCylinder truth = true_body();
  const VertebralBody found = find_vertebral_body(body_ct(truth, 40.0, kSeed), truth.centre_mm, {115.0});
  int far = 0;
  for (std::size_t i = 0; i < found.surface.directions().size(); ++i) {
    const Vec3 p_mm = found.surface.centre_mm() + found.surface.radii_mm()[i] * found.surface.directions()[i];
    // How much larger the true cylinder would have to be, in mm along the ray.
    const double off_mm = (1.0 - 1.0 / truth.scale_to(p_mm)) * (p_mm - truth.centre_mm).norm();
    if (std::abs(off_mm) > 2.0) ++far;
  }
  EXPECT_LT(far, 40);  // 2% of the rays, at the sharp rims
}

TEST(FitBodyCylinder, SeesNoBodyInSoftTissue) {
  constexpr std::uint64_t kSeed = 13;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  FloatGrid grid;
  grid.geometry.size = {60, 60, 60};
  for (std::size_t v = 0; v < grid.geometry.voxel_count(); ++v) {
    grid.values.push_back(static_cast<float>(40.0 + 80.0 * random_normal(kSeed, v)));
  }
  EXPECT_FALSE(fit_body_cylinder(gaussian_blur(grid, 0.9), Vec3::Constant(30.0), {115.0}).is_body());
}

}  // namespace
}  // namespace spinaltap
