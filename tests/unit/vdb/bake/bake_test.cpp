#include "vdb/bake/bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "core/base/error.h"
#include "core/phantom/solid.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

using test::Ball;
using test::FormulaField;
using test::grown;
using test::kBall;
using test::kTorus;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// The voxel centres of a bone within a box, and its distances there.
struct VoxelSamples {
  std::vector<Vec3> points_mm;
  std::vector<float> distance_mm;

  VoxelSamples(const BoneModel& bone, const Box3& box_mm) {
    const double voxel_mm = bone.voxel_mm();
    const auto low = (box_mm.min() / voxel_mm).array().floor().cast<int>().eval();
    const auto high = (box_mm.max() / voxel_mm).array().ceil().cast<int>().eval();
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) points_mm.push_back(voxel_mm * Vec3(i, j, k));
      }
    }
    distance_mm.resize(points_mm.size());
    bone.sample(points_mm, distance_mm, {});
  }
};

template <class Body>
void expect_distance_of(const BoneModel& bone, const Body& body) {
  // The search takes distances that differ by less than 0.004 voxels for one; half floats of up to 0.75 mm round by
  // 0.00025 mm.
  const double tolerance_mm = 0.004 * bone.voxel_mm() + 0.00025;
  std::size_t in_band = 0;
  std::size_t wrong_beyond = 0;
  double worst_mm = 0.0;
  const VoxelSamples voxels(bone, grown(body.bounds_mm(), 2.0));
  for (std::size_t i = 0; i < voxels.points_mm.size(); ++i) {
    const double ground_truth_mm = body.distance_mm(voxels.points_mm[i]);
    const double found_mm = static_cast<double>(voxels.distance_mm[i]);
    if (std::abs(ground_truth_mm) < bone.band_mm() - tolerance_mm) {
      ++in_band;
      worst_mm = std::max(worst_mm, std::abs(found_mm - ground_truth_mm));
    } else if (std::abs(ground_truth_mm) > bone.band_mm() + tolerance_mm) {
      wrong_beyond += found_mm == std::copysign(bone.band_mm(), ground_truth_mm) ? 0U : 1U;
    }
  }
  EXPECT_LE(worst_mm, tolerance_mm);
  EXPECT_EQ(wrong_beyond, 0U);
  // The band is as thick as area times width, to second order in its width; voxels within rounding of its edge may be
  // on either side.
  const double expected = body.area_mm2() * 2.0 * bone.band_mm() / std::pow(bone.voxel_mm(), 3);
  EXPECT_NEAR(static_cast<double>(bone.active_voxels()), expected, 0.02 * expected);
  EXPECT_GT(static_cast<double>(in_band), 0.9 * expected);
}

TEST(BakeBone, GivesASpheresDistanceFromAFieldThatIsNone) {
  const BoneModel bone = test::bake_ball(kBall);
  EXPECT_DOUBLE_EQ(bone.voxel_mm(), 0.25);
  EXPECT_DOUBLE_EQ(bone.band_mm(), 0.75);
  expect_distance_of(bone, kBall);
}

TEST(BakeBone, GivesATorussDistanceFollowingItsSurfaceFromOneSeed) {
  expect_distance_of(test::bake_torus(kTorus), kTorus);
}

TEST(BakeBone, HasSlopeOneInTheBand) {
  const BoneModel bone = test::bake_ball(kBall);
  const double h = bone.voxel_mm();
  const VoxelSamples voxels(bone, grown(kBall.bounds_mm(), 1.0));
  double worst = 0.0;
  std::vector<Vec3> steps_mm(6);
  std::vector<float> values_mm(6);
  for (std::size_t i = 0; i < voxels.points_mm.size(); i += 7) {
    // Far enough from the band's edge that the neighbours lie in it.
    if (std::abs(kBall.distance_mm(voxels.points_mm[i])) > bone.band_mm() - 1.2 * h) continue;
    for (std::size_t n = 0; n < 6; ++n) {
      const double sign = n % 2 == 0 ? 1.0 : -1.0;
      steps_mm[n] = voxels.points_mm[i] + sign * h * Vec3::Unit(static_cast<Eigen::Index>(n / 2));
    }
    bone.sample(steps_mm, values_mm, {});
    const Vec3 slope(values_mm[0] - values_mm[1], values_mm[2] - values_mm[3], values_mm[4] - values_mm[5]);
    worst = std::max(worst, std::abs(slope.norm() / (2.0 * h) - 1.0));
  }
  // The rounding of distances to half floats, 0.00025 mm at most, over a step of 0.25 mm.
  EXPECT_LE(worst, 0.002);
}

TEST(BakeBone, GivesTrueDistancesWhateverTheFieldsSlope) {
  // Steep here, flat there, and not along the same normals but on the surface.
  const auto factor = [](const Vec3& p) { return 2.0 + std::sin(0.9 * p.x()) + 0.7 * std::cos(0.6 * p.y() + p.z()); };
  const auto slope = [](const Vec3& p) {
    const double turn = std::sin(0.6 * p.y() + p.z());
    return Vec3(0.9 * std::cos(0.9 * p.x()), -0.42 * turn, -0.7 * turn);
  };
  const FormulaField field([&](const Vec3& p) { return factor(p) * kTorus.distance_mm(p); },
                           [&](const Vec3& p) -> Vec3 {
                             Vec3 normal;
                             double value = 0.0;
                             kTorus.field().evaluate({&p, 1}, {&value, 1}, {&normal, 1});
                             return factor(p) * normal.normalized() + kTorus.distance_mm(p) * slope(p);
                           });
  const std::vector<Vec3> seeds{kTorus.surface_point()};
  expect_distance_of(bake_bone(field, seeds, test::even_ct(kTorus.bounds_mm(), 1.0, 300), {}, {}), kTorus);
}

/// Two balls that overlap in a ring-shaped groove.
struct TwoBalls {
  Ball left{Vec3(-4.0, 0.3, 0.0), 6.0};
  Ball right{Vec3(4.1, 0.0, 0.2), 5.5};

  /// Outside it is the distance; inside, near the groove, the groove itself may be nearer than either sphere.
  double distance_mm(const Vec3& p) const { return std::min(left.distance_mm(p), right.distance_mm(p)); }
  Vec3 gradient(const Vec3& p) const {
    const Ball& nearer = left.distance_mm(p) < right.distance_mm(p) ? left : right;
    return (p - nearer.centre_mm).normalized();
  }
};

TEST(BakeBone, GivesTheDistanceToTheNearerOfTwoSheets) {
  const TwoBalls balls;
  const FormulaField field([&](const Vec3& p) { return balls.distance_mm(p); },
                           [&](const Vec3& p) -> Vec3 { return balls.gradient(p); });
  Box3 box = balls.left.bounds_mm();
  box.extend(balls.right.bounds_mm());
  const std::vector<Vec3> seeds{Vec3(-10.0, 0.3, 0.0)};
  const BoneModel bone = bake_bone(field, seeds, test::even_ct(box, 1.0, 300), {}, {});
  const VoxelSamples voxels(bone, grown(box, 1.0));
  double worst_mm = 0.0;
  for (std::size_t i = 0; i < voxels.points_mm.size(); ++i) {
    const double ground_truth_mm = balls.distance_mm(voxels.points_mm[i]);
    if (ground_truth_mm < 0.0 || ground_truth_mm > bone.band_mm() - 0.01) continue;
    worst_mm = std::max(worst_mm, std::abs(static_cast<double>(voxels.distance_mm[i]) - ground_truth_mm));
  }
  EXPECT_LE(worst_mm, 0.004 * bone.voxel_mm() + 0.00025);  // as above
}

TEST(BakeBone, BoundsHoldTheSurfaceAndItsBandOnly) {
  const BoneModel bone = test::bake_ball(kBall);
  EXPECT_TRUE(bone.bounds_mm().contains(kBall.bounds_mm()));
  EXPECT_TRUE(grown(kBall.bounds_mm(), bone.band_mm() + bone.voxel_mm()).contains(bone.bounds_mm()));
}

TEST(BakeBone, FollowsALongWayRoundFromOneSeed) {
  RELEASE_ONLY();
  // Half way round is 63 mm: 250 voxels along an axis.
  const Ball ball{Vec3(0.0, 0.0, 0.0), 20.0};
  const std::vector<Vec3> seed{Vec3(20.0, 0.0, 0.0)};
  const CtVolume ct = test::even_ct(ball.bounds_mm(), 2.0, 300);
  const BoneModel from_one = bake_bone(ball.field(), seed, ct, {}, {});
  const BoneModel from_many = bake_bone(ball.field(), ball.surface_points(0.5), ct, {}, {});
  EXPECT_EQ(from_one.active_voxels(), from_many.active_voxels());
  EXPECT_LT(test::distance_at(from_one, Vec3(-19.5, 0.0, 0.0)), -0.4);
  EXPECT_GT(test::distance_at(from_one, Vec3(-20.5, 0.0, 0.0)), 0.4);
}

TEST(BakeBone, EvaluatesTheFieldNearTheSurfaceOnly) {
  std::mutex mutex;
  double furthest_mm = 0.0;
  const FormulaField ball = kBall.field();
  const FormulaField field(
      [&](const Vec3& p) {
        const std::lock_guard lock(mutex);
        furthest_mm = std::max(furthest_mm, std::abs(kBall.distance_mm(p)));
        double value = 0.0;
        ball.evaluate({&p, 1}, {&value, 1}, {});
        return value;
      },
      [&](const Vec3& p) -> Vec3 { return 2.0 * (p - kBall.centre_mm); });
  BakeReport report;
  const BoneModel bone =
      bake_bone(field, kBall.surface_points(1.0), test::even_ct(kBall.bounds_mm(), 1.0, 300), {}, {}, &report);
  // The neighbours of voxels at most 1.75 voxels from the surface.
  EXPECT_LE(furthest_mm, (1.75 + std::sqrt(3.0)) * 0.25 * 1.1);
  // Each voxel of the band once where it is, and near its closest point once to get there and once to see that it has.
  EXPECT_LT(report.evaluations, 4 * bone.active_voxels());
  EXPECT_GT(report.evaluations, bone.active_voxels());
  EXPECT_EQ(report.dropped_pieces, 0U);
}

/// Apart, and so near that their bands of 0.75 mm touch.
class TwoSpheres : public testing::TestWithParam<double> {};

TEST_P(TwoSpheres, BecomeTheLargerOne) {
  const Ball large{Vec3(0.0, 0.0, 0.0), 8.0};
  const Ball small{Vec3(large.radius_mm + GetParam() + 5.0, 0.0, 0.0), 5.0};
  const auto nearer = [=](const Vec3& p) { return large.distance_mm(p) < small.distance_mm(p) ? large : small; };
  const FormulaField both([=](const Vec3& p) { return nearer(p).distance_mm(p); },
                          [=](const Vec3& p) -> Vec3 { return (p - nearer(p).centre_mm).normalized(); });
  std::vector<Vec3> seeds = small.surface_points(1.0);
  const std::vector<Vec3> more = large.surface_points(1.0);
  seeds.insert(seeds.end(), more.begin(), more.end());
  Box3 box = large.bounds_mm();
  box.extend(small.bounds_mm());
  BakeReport report;
  const BoneModel bone = bake_bone(both, seeds, test::even_ct(box, 1.0, 300), {}, {}, &report);
  EXPECT_EQ(report.dropped_pieces, 1U);
  expect_distance_of(bone, large);
  EXPECT_EQ(test::distance_at(bone, small.centre_mm), bone.band_mm());
  EXPECT_EQ(test::distance_at(bone, small.centre_mm + Vec3(0.0, 0.0, 5.0)), bone.band_mm());
}

INSTANTIATE_TEST_SUITE_P(Gap, TwoSpheres, testing::Values(7.0, 0.8));

/// Under a thick wall, and under one so thin that the bands of its two sides touch.
class Cavity : public testing::TestWithParam<double> {};

TEST_P(Cavity, IsFilledAndCounted) {
  const Ball outer{Vec3::Zero(), 9.0};
  const Ball inner{Vec3(outer.radius_mm - GetParam() - 4.0, 0.0, 0.0), 4.0};
  const FormulaField shell([=](const Vec3& p) { return std::max(outer.distance_mm(p), -inner.distance_mm(p)); },
                           [=](const Vec3& p) -> Vec3 {
                             return outer.distance_mm(p) > -inner.distance_mm(p)
                                        ? Vec3(p.normalized())
                                        : Vec3((inner.centre_mm - p).normalized());
                           });
  std::vector<Vec3> seeds = inner.surface_points(1.0);
  const std::vector<Vec3> more = outer.surface_points(1.0);
  seeds.insert(seeds.end(), more.begin(), more.end());
  BakeReport report;
  const BoneModel bone = bake_bone(shell, seeds, test::even_ct(outer.bounds_mm(), 1.0, 300), {}, {}, &report);
  EXPECT_EQ(report.dropped_pieces, 1U);
  expect_distance_of(bone, outer);
  EXPECT_EQ(test::distance_at(bone, inner.centre_mm), -bone.band_mm());
}

INSTANTIATE_TEST_SUITE_P(Wall, Cavity, testing::Values(5.0, 0.8));

TEST(BakeBone, RejectsAFieldWithoutAZeroSetNearTheSeeds) {
  const CtVolume ct = test::even_ct(kBall.bounds_mm(), 1.0, 300);
  const std::vector<Vec3> centre{kBall.centre_mm};
  EXPECT_THAT([&] { bake_bone(kBall.field(), centre, ct, {}, {}); }, ThrowsMessage<Error>(HasSubstr("no zero set")));
  EXPECT_THAT([&] { bake_bone(kBall.field(), {}, ct, {}, {}); }, ThrowsMessage<Error>(HasSubstr("no zero set")));
}

TEST(BakeBone, RejectsASurfaceThatNeverCloses) {
  const FormulaField plane([](const Vec3& p) { return p.z(); }, [](const Vec3&) { return Vec3::UnitZ(); });
  const std::vector<Vec3> seeds{Vec3::Zero()};
  const CtVolume ct = test::even_ct(kBall.bounds_mm(), 1.0, 300);
  EXPECT_THAT([&] { bake_bone(plane, seeds, ct, {.voxel_mm = 2.0}, {}); },
              ThrowsMessage<Error>(HasSubstr("does not close")));
}

TEST(BakeBone, RejectsNumbersThatAreNone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const CtVolume ct = test::even_ct(kBall.bounds_mm(), 1.0, 300);
  const std::vector<Vec3> seeds = kBall.surface_points(1.0);
  for (const double voxel_mm : {0.0, -0.25, 0.01, 6.0, kNan}) {
    EXPECT_THROW(bake_bone(kBall.field(), seeds, ct, {.voxel_mm = voxel_mm}, {}), Error) << voxel_mm;
  }
  for (const double margin_mm : {-1.0, 101.0, kNan}) {
    EXPECT_THROW(bake_bone(kBall.field(), seeds, ct, {.hu_margin_mm = margin_mm}, {}), Error) << margin_mm;
  }
  const FormulaField none([](const Vec3&) { return kNan; }, [](const Vec3&) { return Vec3::UnitZ(); });
  EXPECT_THAT([&] { bake_bone(none, seeds, ct, {}, {}); }, ThrowsMessage<Error>(HasSubstr("not a number")));
  const std::vector<Vec3> nowhere{Vec3(kNan, 0.0, 0.0)};
  EXPECT_THROW(bake_bone(kBall.field(), nowhere, ct, {}, {}), Error);
  const std::vector<Vec3> too_far{Vec3(1e12, 0.0, 0.0)};
  EXPECT_THROW(bake_bone(kBall.field(), too_far, ct, {}, {}), Error);
}

TEST(BakeBone, StopsWhenCancelled) {
  Progress progress([&](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(bake_bone(kBall.field(), kBall.surface_points(1.0), test::even_ct(kBall.bounds_mm(), 1.0, 300), {}, {},
                         nullptr, progress),
               Cancelled);
}

/// A CT whose number differs from voxel to voxel, on any axes.
CtVolume varied_ct(const GridGeometry& geometry) {
  std::vector<std::int16_t> hu;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      // Up to 2,048 a half float holds every whole number.
      for (int i = 0; i < geometry.size[0]; ++i) {
        hu.push_back(static_cast<std::int16_t>((7 * i + 31 * j + 113 * k) % 3000 - 1000));
      }
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

/// Every voxel whose centre lies in the bone or at most the margin outside it holds the CT's number; those well beyond
/// the margin hold nothing.
void expect_hu_of(const GridGeometry& geometry, const BakeOptions& options) {
  const Ball ball{geometry.to_patient(0.5 * Vec3(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1)),
                  8.0};
  const CtVolume ct = varied_ct(geometry);
  const BoneModel bone = bake_bone(ball.field(), ball.surface_points(1.0), ct, options, {});
  // Band and margin, and a voxel's diagonal because whole cells are kept.
  const double far_mm = bone.band_mm() + bone.voxel_mm() + options.hu_margin_mm + geometry.spacing_mm.norm();
  std::vector<Vec3> points_mm;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) points_mm.push_back(geometry.to_patient(Vec3(i, j, k)));
    }
  }
  std::vector<float> distance_mm(points_mm.size());
  std::vector<float> hu(points_mm.size());
  bone.sample(points_mm, distance_mm, hu);
  std::size_t kept = 0;
  std::size_t absent = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const double found = static_cast<double>(hu[i]);
    // The position is rounded by 1e-13 mm or so, times at most 3,000 HU from voxel to voxel.
    if (ball.distance_mm(points_mm[i]) <= options.hu_margin_mm) {
      ++kept;
      wrong += std::abs(found - ct.hu[i]) <= 1e-3 ? 0U : 1U;
    } else if (ball.distance_mm(points_mm[i]) > far_mm) {
      ++absent;
      wrong += std::abs(found + 1024.0) <= 1e-3 ? 0U : 1U;
    }
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(kept, 1000U);
  EXPECT_GT(absent, 1000U);
}

TEST(BakedHu, EqualsTheCtInTheBoneAndItsMargin) {
  GridGeometry geometry;
  geometry.size = {40, 40, 40};
  geometry.spacing_mm = Vec3(0.7, 0.7, 0.7);
  geometry.origin_mm = Vec3(-13.0, 5.0, 300.0);
  expect_hu_of(geometry, {});
  expect_hu_of(geometry, {.voxel_mm = 0.1, .hu_margin_mm = 3.0});
  expect_hu_of(geometry, {.hu_margin_mm = 0.0});
}

TEST(BakedHu, EqualsAnObliqueCtWithThickSlices) {
  GridGeometry geometry;
  geometry.size = {50, 60, 16};
  geometry.spacing_mm = Vec3(0.6, 0.5, 2.0);
  geometry.origin_mm = Vec3(100.0, -40.0, -700.0);
  geometry.directions = (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.3, Vec3::UnitY()) *
                         Eigen::AngleAxisd(1.1, Vec3::UnitZ()))
                            .toRotationMatrix();
  expect_hu_of(geometry, {});
}

TEST(BakedHu, EndsWhereTheCtEnds) {
  // The CT holds the lower half of the ball only.
  GridGeometry geometry;
  geometry.size = {30, 30, 15};
  geometry.origin_mm = Vec3(-14.5, -14.5, -14.5);
  const Ball ball{Vec3::Zero(), 8.0};
  const BoneModel bone = bake_bone(ball.field(), ball.surface_points(1.0), varied_ct(geometry), {}, {});
  EXPECT_EQ(test::hu_at(bone, Vec3(-0.5, -0.5, 2.5)), -1024.0);
  EXPECT_NE(test::hu_at(bone, Vec3(-0.5, -0.5, -2.5)), -1024.0);
}

/// A ball of two layers.
class BallBody final : public Solid {
 public:
  explicit BallBody(const Ball& ball) : ball_(ball) {}
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      values_mm[i] = ball_.distance_mm(points_mm[i]);
      if (!gradients.empty()) gradients[i] = (points_mm[i] - ball_.centre_mm).normalized();
    }
  }
  Box3 bounds_mm() const override { return ball_.bounds_mm(); }
  double hu(const Vec3&, double distance_mm, double) const override { return distance_mm < -2.0 ? 150.0 : 1200.0; }

 private:
  Ball ball_;
};

TEST(BakeSolid, GivesDistanceAndLayersOfABody) {
  const BallBody body(kBall);
  const BoneModel bone = bake_solid(body, {}, 40.0);
  expect_distance_of(bone, kBall);
  EXPECT_EQ(test::hu_at(bone, kBall.centre_mm), 150.0);
  EXPECT_EQ(test::hu_at(bone, kBall.centre_mm + Vec3(9.0, 0.0, 0.0)), 1200.0);
  EXPECT_EQ(test::hu_at(bone, kBall.centre_mm + Vec3(0.0, 10.6, 0.0)), 40.0);
  EXPECT_EQ(bone.metadata().at("method"), "ground truth of a phantom");
}

}  // namespace
}  // namespace spinaltap
