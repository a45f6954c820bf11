#include "core/surface/detail/edge_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/surface/detail/edge_model.h"

namespace spinaltap {
namespace {

/// What a scanner of Gaussian blur makes of a flat shell: cancellous bone up to edge - thickness, cortex up to edge,
/// tissue.
struct Shell {
  double edge_mm = 0.0;
  double thickness_mm = 0.6;
  double cortex_hu = 1250.0;
  double cancellous_hu = 200.0;
  double tissue_hu = 40.0;
  double blur_mm = 0.45;

  double hu(double way_mm) const {
    const auto share_beyond = [&](double place_mm) {
      return 0.5 * std::erfc((place_mm - way_mm) / (std::sqrt(2.0) * blur_mm));
    };
    return cancellous_hu + (cortex_hu - cancellous_hu) * share_beyond(edge_mm - thickness_mm) -
           (cortex_hu - tissue_hu) * share_beyond(edge_mm);
  }
};

EdgeProfile profile_of(const Shell& shell, const Vec3& normal = Vec3::UnitX()) {
  EdgeProfile profile;
  profile.normal = normal;
  for (int i = 0; i < EdgeProfile::kCount; ++i) {
    profile.hu[static_cast<std::size_t>(i)] = shell.hu(profile.way_mm(i));
  }
  return profile;
}

constexpr double kReachMm = 1.8;

TEST(EdgeFit, FindsTheTrueEdgeOfAThinCortex) {
  const EdgeModel model{.blur_in_slice_mm = 0.45, .blur_across_mm = 0.45, .cortex_hu = 1250.0};
  for (const double thickness_mm : {0.4, 0.6, 1.0, 1.5}) {
    for (const double edge_mm : {-1.0, -0.3, 0.0, 0.62}) {
      const auto fit =
          fit_edge(profile_of({.edge_mm = edge_mm, .thickness_mm = thickness_mm}), model, GridGeometry(), kReachMm);
      ASSERT_TRUE(fit) << thickness_mm << " " << edge_mm;
      // The profile is the model's own: what is left is where the search stops.
      EXPECT_NEAR(fit->offset_mm, edge_mm, 0.01) << thickness_mm;
      EXPECT_NEAR(fit->thickness_mm, thickness_mm, 0.02) << edge_mm;
      EXPECT_LT(fit->rms_hu, 3.0);
    }
  }
}

TEST(EdgeFit, FindsTheEdgeOfABodyWithoutACortex) {
  const EdgeModel model{.blur_in_slice_mm = 0.45, .blur_across_mm = 0.45, .cortex_hu = 1250.0};
  const auto fit = fit_edge(profile_of({.edge_mm = 0.31, .cortex_hu = 600.0, .cancellous_hu = 600.0}), model,
                            GridGeometry(), kReachMm);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_mm, 0.31, 0.01);
  EXPECT_EQ(fit->thickness_mm, 0.0);
}

TEST(EdgeFit, StopsAtTheNextBone) {
  // A neighbour's cortex begins 1.6 mm beyond the edge, as in a facet joint.
  const EdgeModel model{.blur_in_slice_mm = 0.4, .blur_across_mm = 0.4, .cortex_hu = 1250.0};
  const Shell own{.edge_mm = -0.4, .blur_mm = 0.4};
  EdgeProfile profile = profile_of(own);
  for (int i = 0; i < EdgeProfile::kCount; ++i) {
    const double beyond = profile.way_mm(i) - (own.edge_mm + 1.6);
    profile.hu[static_cast<std::size_t>(i)] += 1200.0 * 0.5 * std::erfc(-beyond / (std::sqrt(2.0) * own.blur_mm));
  }
  const auto fit = fit_edge(profile, model, GridGeometry(), kReachMm);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_mm, own.edge_mm, 0.06);
}

TEST(EdgeFit, FindsNoneWhereThereIsNone) {
  EdgeProfile profile;
  profile.hu.fill(60.0);
  EXPECT_FALSE(fit_edge(profile, {}, GridGeometry(), kReachMm));
  // Rising outwards all along: the way into a bone, not out of it.
  for (int i = 0; i < EdgeProfile::kCount; ++i) profile.hu[static_cast<std::size_t>(i)] = 40.0 * i;
  EXPECT_FALSE(fit_edge(profile, {}, GridGeometry(), kReachMm));
  // Beyond reach.
  EXPECT_FALSE(fit_edge(profile_of({.edge_mm = -2.6}), {}, GridGeometry(), 0.5));
}

TEST(EdgeModel, BlursBetweenItsTwoWidthsByDirection) {
  GridGeometry geometry;
  geometry.directions = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const EdgeModel model{.blur_in_slice_mm = 0.3, .blur_across_mm = 0.8, .cortex_hu = 1250.0};
  EXPECT_NEAR(model.blur_mm(geometry.directions.col(0), geometry), 0.3, 1e-12);
  EXPECT_NEAR(model.blur_mm(geometry.directions.col(2), geometry), 0.8, 1e-12);
  const Vec3 between = (geometry.directions.col(1) + geometry.directions.col(2)).normalized();
  EXPECT_NEAR(model.blur_mm(between, geometry), std::sqrt(0.5 * (0.09 + 0.64)), 1e-12);
}

TEST(EdgeModel, IsFoundFromManyProfiles) {
  // Shells of 0.5 to 1.6 mm seen from all directions by a scanner that blurs more along z, with noise.
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> noise_hu(0.0, 10.0);
  GridGeometry geometry;
  geometry.spacing_mm = Vec3(0.35, 0.35, 0.5);
  const EdgeModel ground_truth{.blur_in_slice_mm = 0.38, .blur_across_mm = 0.55, .cortex_hu = 1400.0};
  std::vector<EdgeProfile> profiles;
  for (int n = 0; n < 600; ++n) {
    const Vec3 normal = Vec3(share(random) - 0.5, share(random) - 0.5, share(random) - 0.5).normalized();
    EdgeProfile profile = profile_of({.edge_mm = share(random) - 0.8,
                                      .thickness_mm = 0.5 + 1.1 * share(random),
                                      .cortex_hu = ground_truth.cortex_hu,
                                      .blur_mm = ground_truth.blur_mm(normal, geometry)},
                                     normal);
    for (double& hu : profile.hu) hu += noise_hu(random);
    profiles.push_back(profile);
  }
  const EdgeModel found = estimate_edge_model(profiles, geometry, kReachMm);
  EXPECT_NEAR(found.blur_in_slice_mm, ground_truth.blur_in_slice_mm, 0.05 * ground_truth.blur_in_slice_mm);
  EXPECT_NEAR(found.blur_across_mm, ground_truth.blur_across_mm, 0.05 * ground_truth.blur_across_mm);
  EXPECT_NEAR(found.cortex_hu, ground_truth.cortex_hu, 0.05 * ground_truth.cortex_hu);
}

TEST(EdgeModel, IsTheVoxelsWithoutAnyEdge) {
  GridGeometry geometry;
  geometry.spacing_mm = Vec3(0.4, 0.4, 0.7);
  EdgeProfile flat;
  flat.hu.fill(50.0);
  const EdgeModel model = estimate_edge_model({&flat, 1}, geometry, kReachMm);
  EXPECT_EQ(model.blur_in_slice_mm, 0.4);
  EXPECT_EQ(model.blur_across_mm, 0.7);
}

}  // namespace
}  // namespace spinaltap
