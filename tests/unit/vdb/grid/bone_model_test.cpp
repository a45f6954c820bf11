#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/analytic_bodies.h"
#include "tests/support/made_bone.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

using test::grown;
using test::kSmallBall;
using test::Torus;

constexpr double kExactVoxelMm = 0.25;
const Torus kSmallTorus{Vec3(-4.2, 1.7, -60.3), 7.0, 2.5};

/// The body's own distances, without what baking adds.
template <class Body>
BoneModel exact_bone(const Body& body) {
  initialize_openvdb();
  return test::made_bone([&](const Vec3& p) { return body.distance_mm(p); }, grown(body.bounds_mm(), 1.5),
                         kExactVoxelMm);
}

const BoneModel& exact_ball() {
  static const BoneModel bone = exact_bone(kSmallBall);
  return bone;
}

/// Random points in the body's box that are at most `reach_mm` from its surface.
template <class Body>
std::vector<Vec3> points_near(const Body& body, double reach_mm, std::size_t count) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Box3 box = grown(body.bounds_mm(), 2.0);
  std::vector<Vec3> points_mm;
  while (points_mm.size() < count) {
    const Vec3 p = box.min() + Vec3(share(random), share(random), share(random)).cwiseProduct(box.sizes());
    if (std::abs(body.distance_mm(p)) <= reach_mm) points_mm.push_back(p);
  }
  return points_mm;
}

/// The largest errors of distance (mm) and gradient near the ball's surface.
struct Errors {
  double distance_mm = 0.0;
  double gradient = 0.0;
};

Errors errors_near_ball(double reach_mm, Interpolation interpolation) {
  const std::vector<Vec3> points_mm = points_near(kSmallBall, reach_mm, 20000);
  std::vector<float> distance_mm(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  exact_ball().distance(points_mm, distance_mm, gradients, interpolation);
  Errors max;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const double found_mm = static_cast<double>(distance_mm[i]);
    max.distance_mm = std::max(max.distance_mm, std::abs(found_mm - kSmallBall.distance_mm(points_mm[i])));
    const Vec3 ground_truth = (points_mm[i] - kSmallBall.centre_mm).normalized();
    max.gradient = std::max(max.gradient, (gradients[i] - ground_truth).norm());
  }
  return max;
}

TEST(BoneDistance, OfABallIsLinearToWithinItsCurvature) {
  const Errors errors = errors_near_ball(1.2 * kExactVoxelMm, Interpolation::linear);
  // A line through f(0) and f(h) is off by up to h²/8 f''; the f'' of the three axes sum to the ball's 2/r. Slopes are
  // off by h/2 f'' along the axis, and by h²/8 times third derivatives across.
  const double r_mm = kSmallBall.radius_mm - 3.0 * kExactVoxelMm;
  EXPECT_LT(errors.distance_mm, kExactVoxelMm * kExactVoxelMm / 8.0 * 2.0 / r_mm + 1e-6);
  EXPECT_LT(errors.gradient, kExactVoxelMm / r_mm);
  // The same without room to spare.
  EXPECT_GT(errors.distance_mm, 0.5 * kExactVoxelMm * kExactVoxelMm / 8.0 * 2.0 / r_mm);
}

TEST(BoneDistance, OfABallIsQuadraticToWithinItsThirdDerivative) {
  // 0.4 voxels: all values of the stencil are true distances.
  const Errors errors = errors_near_ball(0.4 * kExactVoxelMm, Interpolation::quadratic);
  // A parabola is off by up to h³/16 f''' at half a voxel. The f''' of the three axes sum to at most 2 sqrt(3) / r²;
  // what one axis errs, the parabolas of the others enlarge by at most 1.25 each. Slopes: h²/6 f''' along the axis.
  const double r_mm = kSmallBall.radius_mm - 3.0 * kExactVoxelMm;
  EXPECT_LT(errors.distance_mm,
            1.25 * 1.25 * 2.0 * std::sqrt(3.0) / 16.0 * std::pow(kExactVoxelMm, 3) / (r_mm * r_mm) + 1e-6);
  EXPECT_LT(errors.gradient, 0.6 * kExactVoxelMm * kExactVoxelMm / (r_mm * r_mm));
}

TEST(BoneDistance, KnowsItsGradientToADifferenceOfItsOwnValues) {
  const BoneField field(exact_ball());
  std::vector<Vec3> points_mm;
  for (const Vec3& p : points_near(kSmallBall, 4.0 * kExactVoxelMm, 5000)) {
    // Away from half-way between voxels, where the value jumps.
    const Vec3 p_index = p / kExactVoxelMm;
    if ((p_index - p_index.array().round().matrix()).cwiseAbs().maxCoeff() < 0.45) points_mm.push_back(p);
  }
  ASSERT_GT(points_mm.size(), 1000U);
  std::vector<double> unused(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  field.evaluate(points_mm, unused, gradients);
  const double step_mm = 0.02 * kExactVoxelMm;
  double worst = 0.0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<Vec3> ends_mm{points_mm[i] - step_mm * Vec3::Unit(axis),
                                      points_mm[i] + step_mm * Vec3::Unit(axis)};
      std::vector<double> values_mm(2);
      field.evaluate(ends_mm, values_mm, {});
      worst = std::max(worst, std::abs((values_mm[1] - values_mm[0]) / (2.0 * step_mm) - gradients[i][axis]));
    }
  }
  // The central difference of a parabola is its slope; what is left is rounding, 1e-13 mm of position and so on.
  EXPECT_LT(worst, 1e-9);
}

TEST(BoneDistance, FadesTowardsTheEdgeOfTheBandAsTheDocsSay) {
  // A plane has no curvature: all that differs comes from clamped values. Along a cell's diagonal they are nearest.
  initialize_openvdb();
  for (const Vec3& normal : {Vec3(1.0, 1.0, 1.0), Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 1.0), Vec3(0.8, -0.5, 0.2)}) {
    const Vec3 n = normal.normalized();
    const BoneModel plane = test::made_bone([&](const Vec3& p) { return n.dot(p); },
                                            {Vec3::Constant(-4.0), Vec3::Constant(4.0)}, kExactVoxelMm);
    std::mt19937_64 random(22);
    std::uniform_real_distribution<double> place(-1.5, 1.5);
    std::vector<Vec3> points_mm(200000);
    for (Vec3& p : points_mm) p = {place(random), place(random), place(random)};
    std::vector<float> linear_mm(points_mm.size());
    std::vector<float> quadratic_mm(points_mm.size());
    std::vector<Vec3> slopes(points_mm.size());
    plane.distance(points_mm, linear_mm, {}, Interpolation::linear);
    plane.distance(points_mm, quadratic_mm, slopes, Interpolation::quadratic);
    // The largest errors of points at most so many voxels from the surface, in voxels.
    const auto max = [&](double voxels, const auto& error) {
      double worst = 0.0;
      for (std::size_t i = 0; i < points_mm.size(); ++i) {
        if (std::abs(n.dot(points_mm[i])) <= voxels * kExactVoxelMm) worst = std::max(worst, error(i));
      }
      return worst;
    };
    const auto linear = [&](std::size_t i) {
      return std::abs(static_cast<double>(linear_mm[i]) - n.dot(points_mm[i])) / kExactVoxelMm;
    };
    const auto quadratic = [&](std::size_t i) {
      return std::abs(static_cast<double>(quadratic_mm[i]) - n.dot(points_mm[i])) / kExactVoxelMm;
    };
    const auto slope = [&](std::size_t i) { return (slopes[i] - n).norm(); };
    EXPECT_LT(max(1.2, linear), 1e-5) << n.transpose();
    EXPECT_LT(max(0.4, quadratic), 1e-5) << n.transpose();
    EXPECT_LT(max(0.4, slope), 1e-5) << n.transpose();
    EXPECT_LT(max(1.0, quadratic), 0.01) << n.transpose();
    EXPECT_LT(max(1.0, slope), 0.01) << n.transpose();
    EXPECT_LT(max(1.5, quadratic), 0.03) << n.transpose();
    EXPECT_LT(max(1.5, slope), 0.03) << n.transpose();
    EXPECT_LT(max(2.0, linear), 0.01) << n.transpose();
    EXPECT_LT(max(2.0, quadratic), 0.1) << n.transpose();
    EXPECT_LT(max(2.0, slope), 0.15) << n.transpose();
    std::size_t not_zero = 0;
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      not_zero += std::abs(n.dot(points_mm[i])) > 5.6 * kExactVoxelMm && slopes[i] != Vec3::Zero() ? 1U : 0U;
    }
    EXPECT_EQ(not_zero, 0U);
  }
}

TEST(BoneNormals, AreUnitAndPointAwayFromTheBone) {
  const std::vector<Vec3> points_mm = points_near(kSmallBall, kExactVoxelMm, 20000);
  std::vector<Vec3> normals(points_mm.size());
  exact_ball().normals(points_mm, normals);
  double worst = 0.0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    ASSERT_NEAR(normals[i].norm(), 1.0, 1e-12);
    worst = std::max(worst, (normals[i] - (points_mm[i] - kSmallBall.centre_mm).normalized()).norm());
  }
  EXPECT_LT(worst, 0.01);
  const std::vector<Vec3> beyond_mm{kSmallBall.centre_mm, kSmallBall.centre_mm + Vec3(0.0, 9.0, 0.0)};
  normals.resize(2);
  exact_ball().normals(beyond_mm, normals);
  EXPECT_EQ(normals[0], Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(normals[1], Vec3(0.0, 0.0, 0.0));
}

/// The largest distance from the true surface at which a point is put on its wrong side, mm.
template <class Body>
double worst_wrong_side_mm(const BoneModel& bone, const Body& body) {
  const std::vector<Vec3> points_mm = points_near(body, 4.0 * kExactVoxelMm, 400000);
  std::vector<std::uint8_t> inside(points_mm.size());
  bone.inside(points_mm, inside);
  double worst_mm = 0.0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const double ground_truth_mm = body.distance_mm(points_mm[i]);
    if ((inside[i] != 0) != (ground_truth_mm < 0.0)) worst_mm = std::max(worst_mm, std::abs(ground_truth_mm));
  }
  return worst_mm;
}

TEST(BoneInside, AgreesWithTheSurfaceBeyondItsMargin) {
  // |k1| + |k2| of a ball is 2 / R; of a ring, on the inside of its tube, 1 / tube + 1 / (ring - tube). Cells near the
  // surface see a little more on their inner side.
  const auto margin_mm = [](double curvatures_per_mm) {
    return kExactVoxelMm * kExactVoxelMm / 8.0 * curvatures_per_mm;
  };
  const double ball_mm = margin_mm(2.0 / (kSmallBall.radius_mm - 2.0 * kExactVoxelMm));
  EXPECT_LT(worst_wrong_side_mm(exact_ball(), kSmallBall), ball_mm);
  EXPECT_GT(worst_wrong_side_mm(exact_ball(), kSmallBall), 0.5 * ball_mm);
  const double tube_mm = kSmallTorus.tube_mm - 2.0 * kExactVoxelMm;
  EXPECT_LT(worst_wrong_side_mm(exact_bone(kSmallTorus), kSmallTorus),
            margin_mm(1.0 / tube_mm + 1.0 / (kSmallTorus.ring_mm - kSmallTorus.tube_mm)));
}

TEST(BoneInside, IsTheSignOfTheLinearDistance) {
  const BoneModel bone = test::bake_torus(kSmallTorus);
  std::vector<Vec3> points_mm = points_near(kSmallTorus, 100.0, 100000);
  const std::vector<Vec3> more_mm = points_near(kSmallTorus, 0.1, 100000);
  points_mm.insert(points_mm.end(), more_mm.begin(), more_mm.end());
  std::vector<std::uint8_t> inside(points_mm.size());
  std::vector<float> distance_mm(points_mm.size());
  bone.inside(points_mm, inside);
  bone.distance(points_mm, distance_mm, {});
  std::size_t different = 0;
  std::size_t within = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    different += (inside[i] != 0) == (distance_mm[i] < 0.0F) ? 0U : 1U;
    within += inside[i];
  }
  EXPECT_EQ(different, 0U);
  EXPECT_GT(within, 50000U);
}

TEST(BoneSamplers, GiveManyThreadsWhatTheyGiveOne) {
  const BoneModel bone = exact_ball();
  const std::vector<Vec3> points_mm = points_near(kSmallBall, 2.0, 100000);
  const auto all = [&](std::size_t batch) {
    std::vector<float> distance_mm(points_mm.size());
    std::vector<Vec3> gradients(points_mm.size());
    std::vector<std::uint8_t> inside(points_mm.size());
    tbb::parallel_for(std::size_t{0}, (points_mm.size() + batch - 1) / batch, [&](std::size_t i) {
      const std::size_t begin = i * batch;
      const std::size_t size = std::min(batch, points_mm.size() - begin);
      const std::span<const Vec3> some_mm(&points_mm[begin], size);
      bone.distance(some_mm, {&distance_mm[begin], size}, {&gradients[begin], size}, Interpolation::quadratic);
      bone.inside(some_mm, {&inside[begin], size});
    });
    return std::tuple(distance_mm, gradients, inside);
  };
  EXPECT_EQ(all(points_mm.size()), all(100));
}

TEST(BoneSamplers, OutliveTheModelTheyWereCopiedFrom) {
  const auto make = [] {
    const BoneModel first = test::bake_ball(kSmallBall);
    return BoneField(first);
  };
  const BoneField field = make();
  const Vec3 p_mm = kSmallBall.centre_mm + Vec3(kSmallBall.radius_mm, 0.0, 0.0);
  double value_mm = 1.0;
  Vec3 gradient;
  field.evaluate({&p_mm, 1}, {&value_mm, 1}, {&gradient, 1});
  EXPECT_NEAR(value_mm, 0.0, 0.01);
  EXPECT_NEAR((gradient - Vec3::UnitX()).norm(), 0.0, 0.05);
}

TEST(BoneDensity, IsTheModelsOfTheCtNumber) {
  const test::Ball ball{Vec3(3.1, -2.3, 105.7), 6.0};
  const BoneModel bone = test::bake_ball(ball, 0.5, 300);
  const HuToDensity line{0.1, 0.002};
  // In the middle, near the surface, and where there is air.
  const std::vector<Vec3> points_mm{ball.centre_mm, ball.centre_mm + Vec3(5.9, 0.0, 0.0),
                                    ball.centre_mm + Vec3(0.0, 40.0, 0.0)};
  std::vector<float> density_g_cm3(3, -1.0F);
  bone_density(bone, line, points_mm, density_g_cm3);
  EXPECT_FLOAT_EQ(density_g_cm3[0], 0.7F);
  EXPECT_FLOAT_EQ(density_g_cm3[1], 0.7F);
  EXPECT_EQ(density_g_cm3[2], 0.0F);
}

}  // namespace

}  // namespace spinaltap
