#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/surface/surface_points.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

constexpr double kBallMm = 9.0;

struct Scan {
  CtVolume ct;
  BoneMask mask;
};

/// A ball of 1000 HU around `centre_mm` in water, each voxel blended by its share of bone over a voxel's width.
Scan scanned_ball(const Vec3& centre_mm, const GridGeometry& geometry, double radius_mm = kBallMm) {
  std::vector<std::int16_t> hu;
  BoneMask mask{geometry, {}};
  const double width_mm = geometry.spacing_mm.maxCoeff();
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const double r_mm = (geometry.to_patient(Vec3(i, j, k)) - centre_mm).norm();
        hu.push_back(
            static_cast<std::int16_t>(std::lround(1000.0 * std::clamp(0.5 + (radius_mm - r_mm) / width_mm, 0.0, 1.0))));
        mask.inside.push_back(hu.back() >= 500 ? 1 : 0);
      }
    }
  }
  return {make_ct_volume(geometry, std::move(hu)), std::move(mask)};
}

/// 60 x 60 x 48 voxels whose middle is `middle_mm`.
GridGeometry grid_around(const Vec3& middle_mm, const Mat3& directions = Mat3::Identity()) {
  GridGeometry geometry;
  geometry.size = {60, 60, 48};
  geometry.spacing_mm = Vec3(0.4, 0.4, 0.5);
  geometry.directions = directions;
  geometry.origin_mm = middle_mm - directions * Vec3(29.5, 29.5, 23.5).cwiseProduct(geometry.spacing_mm);
  return geometry;
}

/// A mask's terraces show through its smoothing: at their rims normals lean by up to the slope of a smoothed step of
/// one voxel, 0.5 mm / (sqrt(2 pi) * 0.5 mm) or 22 degrees, and the points there, moved along such normals, miss more
/// than others.
void expect_ball(const SurfacePoints& surface, const Vec3& centre_mm) {
  const double count = static_cast<double>(surface.positions_mm.size());
  double worst_mm = 0.0, mean_mm = 0.0, squares_mm2 = 0.0, worst_rad = 0.0, squares_rad2 = 0.0;
  for (std::size_t i = 0; i < surface.positions_mm.size(); ++i) {
    const Vec3 out = surface.positions_mm[i] - centre_mm;
    const double miss_mm = out.norm() - kBallMm;
    worst_mm = std::max(worst_mm, std::abs(miss_mm));
    mean_mm += miss_mm / count;
    squares_mm2 += miss_mm * miss_mm / count;
    const double angle_rad = std::acos(std::min(1.0, surface.normals[i].dot(out.normalized())));
    worst_rad = std::max(worst_rad, angle_rad);
    squares_rad2 += angle_rad * angle_rad / count;
    EXPECT_NEAR(surface.normals[i].norm(), 1.0, 1e-12);
  }
  EXPECT_LT(std::abs(mean_mm), 0.005);  // a hundredth of a voxel
  EXPECT_LT(std::sqrt(squares_mm2), 0.02);
  EXPECT_LT(worst_mm, 0.15);
  EXPECT_LT(std::sqrt(squares_rad2), 4.0 * kDegree);
  EXPECT_LT(worst_rad, 22.0 * kDegree);
  // About one point for each grid line that pierces the ball: three projections of it, twice, over the voxel's faces.
  const double disc_mm2 = std::numbers::pi * kBallMm * kBallMm;
  const double expected = 2.0 * disc_mm2 * (1.0 / 0.16 + 2.0 / 0.2);
  EXPECT_NEAR(static_cast<double>(surface.positions_mm.size()), expected, 0.1 * expected);
}

TEST(ExtractSurface, LiesWithinASmallFractionOfAVoxelOfABall) {
  const Vec3 centre_mm(100.3, -50.1, 700.2);
  const Scan scan = scanned_ball(centre_mm, grid_around(Vec3(100, -50, 700)));
  expect_ball(extract_surface(scan.ct, scan.mask), centre_mm);
}

TEST(ExtractSurface, DoesNotCareHowTheCtLies) {
  RELEASE_ONLY();
  const Vec3 centre_mm(100.3, -50.1, 700.2);
  const Mat3 turn = Eigen::AngleAxisd(0.6, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Scan turned = scanned_ball(centre_mm, grid_around(Vec3(100, -50, 700), turn));
  expect_ball(extract_surface(turned.ct, turned.mask), centre_mm);
  // Slices stacked from the head down: left-handed axes.
  const Mat3 mirrored = Vec3(1, 1, -1).asDiagonal();
  const Scan stacked = scanned_ball(centre_mm, grid_around(Vec3(100, -50, 700), mirrored));
  expect_ball(extract_surface(stacked.ct, stacked.mask), centre_mm);
}

TEST(ExtractSurface, IsBetterWithTheGreyValuesThanWithout) {
  RELEASE_ONLY();
  const Vec3 centre_mm(0.3, -0.1, 0.2);
  const Scan scan = scanned_ball(centre_mm, grid_around(Vec3::Zero()));
  const auto mean_error_mm = [&](bool refine) {
    const SurfacePoints surface = extract_surface(scan.ct, scan.mask, {.refine_by_hu = refine});
    double sum = 0.0;
    for (const Vec3& p : surface.positions_mm) sum += std::abs((p - centre_mm).norm() - kBallMm);
    return sum / static_cast<double>(surface.positions_mm.size());
  };
  EXPECT_LT(mean_error_mm(true), 0.5 * mean_error_mm(false));
}

TEST(ExtractSurface, ClosesBoneThatTheCtsBorderCuts) {
  // The ball's centre lies on the CT's upper face: half a ball.
  const GridGeometry geometry = grid_around(Vec3::Zero());
  const double top_mm = 23.5 * 0.5;
  const Scan scan = scanned_ball(Vec3(0, 0, top_mm), geometry);
  const SurfacePoints surface = extract_surface(scan.ct, scan.mask);
  // Seen from within, there is a point near every direction: also upwards, where the cut is.
  const Vec3 inside(0, 0, top_mm - 3.0);
  for (int n = 0; n < 400; ++n) {
    const double z = 1.0 - 2.0 * (n + 0.5) / 400.0;
    const double angle = 2.399963 * n;
    const Vec3 direction(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    double best = -1.0;
    for (const Vec3& p : surface.positions_mm) best = std::max(best, (p - inside).normalized().dot(direction));
    // Points of the cut lie 0.4 mm apart and 3 mm away: 8 degrees; smoothing rounds the rim.
    EXPECT_GT(best, std::cos(10.0 * std::numbers::pi / 180.0)) << direction.transpose();
  }
  // The points of the cut face upwards.
  for (std::size_t i = 0; i < surface.positions_mm.size(); ++i) {
    const Vec3& p = surface.positions_mm[i];
    if (std::hypot(p.x(), p.y()) < 5.0 && p.z() > top_mm - 1.0) {
      EXPECT_GT(surface.normals[i].z(), 0.95);
    }
  }
}

TEST(ExtractSurface, GivesTheSameBitsAtAnyNumberOfThreads) {
  RELEASE_ONLY();
  const Scan scan = scanned_ball(Vec3(0.3, -0.1, 0.2), grid_around(Vec3::Zero()), 0.5 * kBallMm);
  SurfacePoints one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = extract_surface(scan.ct, scan.mask);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  const SurfacePoints two = extract_surface(scan.ct, scan.mask);
  EXPECT_EQ(one.positions_mm, two.positions_mm);
  EXPECT_EQ(one.normals, two.normals);
}

TEST(ExtractSurface, RejectsMasksAndOptionsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scan scan = scanned_ball(Vec3::Zero(), grid_around(Vec3::Zero()));
  for (const double bad : {nan, -1.0, 1e6})
    EXPECT_THROW(extract_surface(scan.ct, scan.mask, {.smooth_mm = bad}), Error);
  BoneMask other = scan.mask;
  other.geometry.origin_mm.x() += 1.0;
  EXPECT_THROW(extract_surface(scan.ct, other), Error);
  other = scan.mask;
  other.geometry.size = {60, 48, 60};
  EXPECT_THROW(extract_surface(scan.ct, other), Error);
  std::fill(scan.mask.inside.begin(), scan.mask.inside.end(), std::uint8_t{0});
  EXPECT_THROW(extract_surface(scan.ct, scan.mask), Error);
  scan.mask.inside[scan.mask.geometry.offset(30, 30, 24)] = 1;  // one voxel, which smoothing wipes out
  EXPECT_THROW(extract_surface(scan.ct, scan.mask), Error);
}

}  // namespace
}  // namespace spinaltap
