#include "mesh/decimate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "mesh/display_mesh.h"
#include "mesh/remaining_mesh.h"
#include "mesh/self_intersections.h"
#include "tests/support/cut_hole.h"
#include "tests/support/drilled_ball.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using test::kDrilledBall;

const Pose kHoleStart{kDrilledBall.centre_mm - 20.0 * test::kAslant, test::kAslant};
const Pose kHoleEnd{kDrilledBall.centre_mm + 4.0 * test::kAslant, test::kAslant};

const BoneModel& ball_with_hole() {
  static const BoneModel bone = test::without_hole(test::ball_to_drill(), test::paper_drill(), kHoleStart, kHoleEnd);
  return bone;
}

/// How far a place is from the surface that the ball has without the drill's cylinder and cone.
double off_surface_mm(const Vec3& p_mm) {
  return std::abs(
      std::max(kDrilledBall.distance_mm(p_mm), -bit_distance_mm(BitProfile(test::paper_drill()), kHoleEnd, p_mm)));
}

SLOW_TESTS("DecimateDrilledBall.*");

TEST(DecimateDrilledBall, KeepsTheErrorAndTheRim) {
  constexpr double kMaxErrorMm = 0.05;
  const TriangleMesh fine = sharp_surface(ball_with_hole());
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, kMaxErrorMm, &report);
  EXPECT_TRUE(report.reached);
  EXPECT_LE(report.to_surface.max_mm, kMaxErrorMm);
  EXPECT_LE(report.from_surface.max_mm, kMaxErrorMm);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 2);
  EXPECT_TRUE(self_intersections(mesh).empty());
  EXPECT_LT(5 * mesh.triangles.size(), fine.triangles.size());
  // Against the body itself; the fine mesh has an error of its own.
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    ASSERT_LT(off_surface_mm(vertex.cast<double>()), kMaxErrorMm + 0.04);
  }
  // Where the drill's wall meets the ball.
  const double radius_mm = test::paper_drill().radius_mm();
  const double back_mm = std::sqrt(kDrilledBall.radius_mm * kDrilledBall.radius_mm - radius_mm * radius_mm);
  const Vec3 u = any_perpendicular(test::kAslant);
  std::vector<Vec3> rim_mm;
  for (int n = 0; n < 360; ++n) {
    const double turn = n * std::numbers::pi / 180.0;
    rim_mm.push_back(kDrilledBall.centre_mm - back_mm * test::kAslant +
                     radius_mm * (std::cos(turn) * u + std::sin(turn) * test::kAslant.cross(u)));
  }
  EXPECT_LT(surface_to_mesh(rim_mm, mesh).mean_mm, 0.03);
}

TEST(DecimateDrilledBall, IsWhatADrilledBoneIsShownAs) {
  RemeshReport report;
  const TriangleMesh mesh = display_mesh(ball_with_hole(), {}, &report);
  EXPECT_TRUE(report.reached);
  const TriangleMesh same = decimate(sharp_surface(ball_with_hole()), DisplayMeshOptions().max_error_mm);
  EXPECT_EQ(mesh.triangles, same.triangles);
  EXPECT_EQ(mesh.vertices_mm, same.vertices_mm);
}

// The rim is cut from cells at any place: the fine mesh has triangles as thin as one likes.
TEST(DecimateDrilledBall, HasNoThinTriangles) {
  const TriangleMesh fine = sharp_surface(ball_with_hole());
  ASSERT_LT(measure_mesh(fine).smallest_angle_deg, 1.0);
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, 0.05, &report);
  EXPECT_GE(measure_mesh(mesh).smallest_angle_deg, 5.0);
  EXPECT_EQ(report.smallest_angle_deg, measure_mesh(mesh).smallest_angle_deg);
}

TEST(DecimateDrilledBall, GivesFewerTrianglesForALargerError) {
  const TriangleMesh fine = sharp_surface(ball_with_hole());
  RemeshReport coarse;
  RemeshReport exact;
  const std::size_t many = decimate(fine, 0.04, &exact).triangles.size();
  const std::size_t few = decimate(fine, 0.2, &coarse).triangles.size();
  EXPECT_TRUE(exact.reached);
  EXPECT_TRUE(coarse.reached);
  EXPECT_LT(2 * few, many);
}

TEST(Decimate, KeepsATorusWithinTheError) {
  constexpr double kRingMm = 10.0, kTubeMm = 4.0, kMaxErrorMm = 0.1;
  const TriangleMesh fine = test::torus_mesh(kRingMm, kTubeMm, 72, 36);
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, kMaxErrorMm, &report);
  EXPECT_TRUE(report.reached);
  EXPECT_LT(2 * mesh.triangles.size(), fine.triangles.size());
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 0);
  // Vertices of the fine mesh lie on the torus; its chords are up to 0.02 mm within.
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    const Vec3 p = vertex.cast<double>();
    const double off_mm = std::hypot(std::hypot(p.x(), p.y()) - kRingMm, p.z()) - kTubeMm;
    ASSERT_LT(std::abs(off_mm), kMaxErrorMm + 0.02);
  }
}

// Waves so steep that a collapse on one sheet reaches the next: what misses is done again until nothing does.
TEST(Decimate, KeepsTheErrorAndMeetsItselfNowhereWhereSheetsAreNear) {
  constexpr double kMaxErrorMm = 0.25;
  TriangleMesh fine = test::torus_mesh(10.0, 4.0, 400, 120);
  for (Eigen::Vector3f& p : fine.vertices_mm) {
    const float along = std::atan2(p.y(), p.x());
    p.z() *= 1.0F + 0.35F * std::sin(60.0F * along);
  }
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, kMaxErrorMm, &report);
  EXPECT_TRUE(report.reached);
  EXPECT_LE(report.to_surface.max_mm, kMaxErrorMm);
  EXPECT_LE(report.from_surface.max_mm, kMaxErrorMm);
  EXPECT_TRUE(self_intersections(mesh).empty());
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 0);
  EXPECT_LT(mesh.triangles.size(), fine.triangles.size());
}

TEST(Decimate, GivesTheSameBitsAtAnyNumberOfThreads) {
  const TriangleMesh fine = test::torus_mesh(20.0, 6.0, 400, 120);  // of several parts
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return decimate(fine, 0.05);
  };
  const TriangleMesh one = with_threads(1);
  const TriangleMesh two = with_threads(2);
  EXPECT_EQ(one.vertices_mm, two.vertices_mm);
  EXPECT_EQ(one.triangles, two.triangles);
}

// A finger of three thin triangles on a side: no edge at its foot can collapse before it is gone.
TEST(Decimate, TakesAwayASpikeThatNoTriangleAroundAllowsToCollapse) {
  TriangleMesh fine = test::torus_mesh(10.0, 4.0, 72, 36);
  const auto [a, b, c] = fine.triangles.front();
  const Eigen::Vector3f foot = (fine.vertices_mm[a] + fine.vertices_mm[b] + fine.vertices_mm[c]) / 3.0F;
  const Eigen::Vector3f out =
      (fine.vertices_mm[b] - fine.vertices_mm[a]).cross(fine.vertices_mm[c] - fine.vertices_mm[a]).normalized();
  const auto tip = static_cast<std::uint32_t>(fine.vertices_mm.size());
  fine.vertices_mm.push_back(foot + 0.002F * out + 0.3F * (fine.vertices_mm[a] - foot));
  fine.triangles.front() = {a, b, tip};
  fine.triangles.push_back({b, c, tip});
  fine.triangles.push_back({c, a, tip});
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, 0.05, &report);
  EXPECT_TRUE(report.reached);
  EXPECT_GE(report.smallest_angle_deg, 5.0);
  EXPECT_EQ(measure_mesh(mesh).euler_number, 0);
}

// As where a drill's tip just comes out of the far side: the neck may not be closed, so it is made a little wider.
TEST(Decimate, WidensANeckThatIsThinnerThanItsTriangles) {
  constexpr float kRingMm = 10.0F, kThinnest = 2e-4F, kMaxErrorMm = 0.05F;
  TriangleMesh fine = test::torus_mesh(10.0, 0.4, 400, 12);
  for (Eigen::Vector3f& p : fine.vertices_mm) {
    const float along = std::atan2(p.y(), p.x());
    const Eigen::Vector3f middle(kRingMm * std::cos(along), kRingMm * std::sin(along), 0.0F);
    p = middle + std::clamp(std::abs(along) / 0.05F, kThinnest, 1.0F) * (p - middle);
  }
  RemeshReport report;
  const TriangleMesh mesh = decimate(fine, static_cast<double>(kMaxErrorMm), &report);
  EXPECT_TRUE(report.reached);
  EXPECT_GE(report.smallest_angle_deg, 5.0);
  EXPECT_LE(report.to_surface.max_mm, static_cast<double>(kMaxErrorMm));
  EXPECT_LE(report.from_surface.max_mm, static_cast<double>(kMaxErrorMm));
  EXPECT_EQ(measure_mesh(mesh).euler_number, 0);
}

TEST(Decimate, RejectsWhatIsNotClosed) {
  TriangleMesh open = test::torus_mesh(10.0, 4.0, 24, 12);
  EXPECT_THROW(decimate(open, 0.0), Error);
  EXPECT_THROW(decimate(open, std::numeric_limits<double>::quiet_NaN()), Error);
  open.triangles.pop_back();
  EXPECT_THROW(decimate(open, 0.05), Error);
  TriangleMesh pinched = test::torus_mesh(10.0, 4.0, 24, 12);
  for (auto& t : pinched.triangles) {
    for (std::uint32_t& corner : t) corner = corner == 100 ? 3 : corner;  // two places of the surface meet in one
  }
  EXPECT_THROW(decimate(pinched, 0.05), Error);
  EXPECT_THROW(decimate({}, 0.05), Error);
}

}  // namespace
}  // namespace spinaltap
