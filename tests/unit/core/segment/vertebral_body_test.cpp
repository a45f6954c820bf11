#include "core/segment/vertebral_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace spinaltap {
namespace {

/// A hollow elliptic cylinder of bone, 44 x 32 x 26 mm with a wall of 1.5 mm at 500 HU, cancellous bone as dark as the
/// soft tissue around it, between two plates of bone 7 mm above and below; with normal noise.
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

/// Where a search begins: off the true cylinder by a shift along its own axes (mm) and turns about the patient's.
struct Start {
  Vec3 shift_mm, turn_deg;
};

class SeedInBody : public ::testing::TestWithParam<Start> {};

TEST_P(SeedInBody, FindsTheCylinderThroughNoise) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const BodyCylinder ground_truth = true_body();
  const FloatGrid hu = body_ct(ground_truth, 80.0, kSeed);
  BodyCylinder start = ground_truth;
  start.centre_mm += ground_truth.axes() * GetParam().shift_mm;
  start.turn_rad += GetParam().turn_deg * kDegree;
  const BodyCylinder found = refine_body_cylinder(WallProbe(hu, {115.0}), start);
  EXPECT_GT(found.fit, 0.25);
  // Within a voxel and a half; the edge is taken up to 0.8 mm outside the wall's crest.
  EXPECT_LT((found.centre_mm - ground_truth.centre_mm).norm(), 1.5);
  EXPECT_LT((found.half_mm - ground_truth.half_mm).cwiseAbs().maxCoeff(), 1.5) << found.half_mm.transpose();
  EXPECT_LT((found.axes().col(2) - ground_truth.axes().col(2)).norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Places, SeedInBody,
                         ::testing::Values(Start{Vec3(0.0, 0.0, 0.0), Vec3(8.0, 0.0, 0.0)},
                                           Start{Vec3(2.5, 0.0, 0.0), Vec3(0.0, -8.0, 0.0)},
                                           Start{Vec3(-2.0, 1.5, -1.0), Vec3(-8.0, 0.0, 0.0)},
                                           Start{Vec3(0.0, -2.5, 1.0), Vec3(0.0, 8.0, 0.0)},
                                           Start{Vec3(1.5, 1.5, 2.0), Vec3(5.5, 5.5, 0.0)}));

TEST(RefineBodyCylinder, FindsTheCylinderFromANarrowStartThatTouchesOneSide) {
  constexpr std::uint64_t kSeed = 11;
  const BodyCylinder ground_truth = true_body();
  const FloatGrid hu = body_ct(ground_truth, 80.0, kSeed);
  BodyCylinder start = ground_truth;
  start.centre_mm += ground_truth.axes() * Vec3(2.5, 0.0, 0.0);
  start.half_mm.x() -= 2.0;
  const BodyCylinder found = refine_body_cylinder(WallProbe(hu, {115.0}), start);
  EXPECT_LT((found.centre_mm - ground_truth.centre_mm).norm(), 1.5);
  EXPECT_LT((found.half_mm - ground_truth.half_mm).cwiseAbs().maxCoeff(), 1.5) << found.half_mm.transpose();
}

TEST(FindVertebralBody, FollowsTheWallOnAllSides) {
  constexpr std::uint64_t kSeed = 12;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const BodyCylinder ground_truth = true_body();
  const Vec3 up = ground_truth.axes().col(2);
  BodySpan span;  // off by up to 1.5 mm at its ends and 1 mm at its sides
  span.lower.centre_mm = ground_truth.centre_mm - (ground_truth.half_mm.z() - 1.5) * up;
  span.upper.centre_mm = ground_truth.centre_mm + (ground_truth.half_mm.z() + 0.5) * up;
  span.lower.up = span.upper.up = up;
  span.lower.s_mm = 0.0;
  span.upper.s_mm = 2.0 * ground_truth.half_mm.z() - 1.0;
  span.middle.centre_mm = ground_truth.centre_mm;
  span.middle.axes = ground_truth.axes();
  span.middle.half_width_mm = ground_truth.half_mm.x() - 1.0;
  span.middle.half_depth_mm = ground_truth.half_mm.y() + 1.0;
  const FloatGrid hu = body_ct(ground_truth, 40.0, kSeed);
  const WallProbe probe(hu, {115.0});
  const VertebralBody found = find_vertebral_body(probe, find_body_cylinders(probe, {span}).front());
  int far = 0;
  for (std::size_t i = 0; i < found.surface.directions().size(); ++i) {
    const Vec3 p_mm = found.surface.centre_mm() + found.surface.radii_mm()[i] * found.surface.directions()[i];
    // How much larger the true cylinder would have to be, in mm along the ray.
    const double off_mm = (1.0 - 1.0 / ground_truth.scale_to(p_mm)) * (p_mm - ground_truth.centre_mm).norm();
    if (std::abs(off_mm) > 2.0) ++far;
  }
  EXPECT_LT(far, 40);  // 2% of the rays, at the sharp rims
}

TEST(RefineBodyCylinder, SeesNoWallInSoftTissue) {
  constexpr std::uint64_t kSeed = 13;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  FloatGrid grid;
  grid.geometry.size = {60, 60, 60};
  for (std::size_t v = 0; v < grid.geometry.voxel_count(); ++v) {
    grid.values.push_back(static_cast<float>(40.0 + 80.0 * random_normal(kSeed, v)));
  }
  const FloatGrid hu = gaussian_blur(grid, 0.9);
  BodyCylinder start;
  start.centre_mm = Vec3::Constant(30.0);
  // Bodies have 0.36 and more, also where the wall is as thin as the noise.
  EXPECT_LT(refine_body_cylinder(WallProbe(hu, {115.0}), start).fit, 0.25);
}

}  // namespace
}  // namespace spinaltap
