#include "vdb/sim/drilling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/session/operator/path_motion.h"
#include "mesh/mesh_distance.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"
#include "vdb/grid/isosurface.h"
#include "vdb/remaining/live_mesh.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {
namespace {

using test::kLargeBall;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int16_t kHu = 300;

const BoneModel& ball_bone() {
  static const BoneModel bone = test::bake_ball(kLargeBall, 0.25, kHu);
  return bone;
}

/// From the surface 22 mm along a slanting diameter. The bit's wall lies between two rings of points, where their
/// shares of the section add up to it exactly; at 3.0 mm it would lie on one.
DrillPath diameter_path() {
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry = kLargeBall.centre_mm - kLargeBall.radius_mm * axis;
  return {"diameter", entry, entry + 22.0 * axis, {3.1, 50.0, 5.0}};
}

constexpr double kFeedMmS = 1.0;
constexpr double kAdvanceMm = 0.02;

/// The ball is no vertebra: no landmarks are looked for.
const Bone& session_bone() {
  static const Bone bone(ball_bone());
  return bone;
}

SessionSetup setup_of(const DrillPath& path) {
  SessionSetup setup;
  setup.path = path;
  setup.has_clearances = false;
  return setup;
}

PathMotionOptions motion_of(const SessionSetup& setup, double step_mm = kAdvanceMm) {
  return {.line = {.lead_in_mm = setup.volume.lead_in_mm},
          .rate_hz = kFeedMmS / step_mm,
          .feed = {.steps = {{0.0, kFeedMmS}}}};
}

Drilling drill(const SessionSetup& setup, const PathMotionOptions& motion,
               const DrillingOptions& options = {.log_step_mm = 0.5}) {
  PlannedMotion tool_operator(setup.path, motion);
  return drill_bone(session_bone(), setup, tool_operator, options);
}

const Drilling& drilled_ball() {
  static const Drilling drilling = drill(setup_of(diameter_path()), motion_of(setup_of(diameter_path())));
  return drilling;
}

CuttingResistance even_bone() { return resistance_of_block(diameter_path().bit, Material(), kHu); }

double feed_mm() { return kFeedMmS * 60.0 / Spindle().rpm; }

TEST(DrillBone, NeedsTheThrustOfTheModel) {
  const Material material;
  const double expected_n = even_bone().thrust_n(feed_mm());
  int rows = 0;
  for (const DepthRow& row : drilled_ball().rows) {
    // From where the whole cone is in, and what it cuts is averaged; the surface is curved. The chisel edge feels two
    // discs ahead, and the volume ends at the target.
    if (row.depth_mm < 6.4 || row.depth_mm > 21.6) continue;
    ++rows;
    EXPECT_NEAR(row.thrust_n, expected_n, 0.01 * expected_n) << row.depth_mm;
    EXPECT_NEAR(row.hu, kHu, 1e-9);
    EXPECT_NEAR(row.density_g_cm3, material.density.density_g_cm3(kHu), 1e-12);
  }
  EXPECT_EQ(rows, 31);
  EXPECT_NEAR(drilled_ball().max_thrust_n, expected_n, 0.01 * expected_n);
}

TEST(DrillBone, NeedsNoForceBeforeItMeetsBoneAndLessWithTheConesTip) {
  const DrillPath path = diameter_path();
  const double chisel_n = even_bone().chisel_n;
  const double lips_n = even_bone().thrust_n(feed_mm()) - chisel_n;
  for (const DepthRow& row : drilled_ball().rows) {
    if (row.depth_mm < -0.25) {  // the chisel edge feels two discs ahead
      EXPECT_EQ(row.removed, 0U);
      EXPECT_EQ(row.thrust_n, 0.0);
      EXPECT_TRUE(std::isnan(row.hu));
      EXPECT_TRUE(std::isnan(row.density_g_cm3));
    } else if (row.depth_mm > 1.5 && row.depth_mm < 4.6) {
      // The lips cut the cone's section at the surface, where the row's depths average d² (nearly flat), 0.2 mm ago:
      // that is how long a box of averaging is.
      const double share = std::pow((row.depth_mm - 0.25 - 0.2) / path.bit.tip_length_mm, 2);
      EXPECT_NEAR(row.thrust_n, chisel_n + share * lips_n, 0.05 * lips_n) << row.depth_mm;
    }
  }
  EXPECT_NEAR(drilled_ball().entry_depth_mm, 0.0, 0.15);
}

TEST(DrillBone, DoesTheWorkOfTheVolumeItRemoves) {
  // The hole: a cylinder from the entry to the shoulder, and the cone, less the cap that the sphere leaves out.
  const DrillPath path = diameter_path();
  const double r = path.bit.radius_mm();
  const double cap_height = kLargeBall.radius_mm - std::sqrt(kLargeBall.radius_mm * kLargeBall.radius_mm - r * r);
  const double missing_mm3 = std::numbers::pi * r * r * cap_height / 2.0;
  const double hole_mm3 = std::numbers::pi * r * r * (22.0 - path.bit.tip_length_mm * 2.0 / 3.0) - missing_mm3;
  double work_n_mm = 0.0;
  std::size_t removed = 0;
  for (const DepthRow& row : drilled_ball().rows) {
    work_n_mm += row.work_n_mm;
    removed += row.removed;
  }
  EXPECT_EQ(removed, drilled_ball().removed);
  // Points a tenth of a millimetre apart; the cone's wall cuts their cells at random.
  EXPECT_NEAR(work_n_mm, Material().cutting_energy_mpa(kHu) * hole_mm3,
              0.01 * Material().cutting_energy_mpa(kHu) * hole_mm3);
  const double taken_mm3 = measure_mesh(bone_surface(ball_bone())).volume_mm3 -
                           measure_mesh(bone_surface(drilled_ball().drilled)).volume_mm3;
  EXPECT_NEAR(taken_mm3, hole_mm3, 0.01 * hole_mm3);
}

TEST(DrillBone, CountsWhatTheVolumeHolds) {
  const Drilling& drilling = drilled_ball();
  EXPECT_EQ(drilling.points_per_disc, 2611U);
  EXPECT_EQ(drilling.discs, 250);
  EXPECT_EQ(drilling.points, 250U * 2611U);
  EXPECT_EQ(drilling.cycles, 1250U);
  EXPECT_LT(drilling.removed, drilling.points_in_bone);
  std::size_t cycles = 0;
  for (const DepthRow& row : drilling.rows) cycles += row.cycles;
  EXPECT_EQ(cycles, drilling.cycles);
  EXPECT_EQ(drilling.rows.size(), 50U);
  EXPECT_NEAR(drilling.rows.back().depth_mm, 22.0, 1e-9);
}

TEST(DrillBone, RemovesTheSameAtAnyAdvanceAndNeedsTheSameThrust) {
  const SessionSetup setup = setup_of(diameter_path());
  const Drilling drilling = drill(setup, motion_of(setup, 0.007));
  EXPECT_EQ(drilling.removed, drilled_ball().removed);
  EXPECT_EQ(drilling.rows.size(), drilled_ball().rows.size());
  EXPECT_NEAR(drilling.max_thrust_n, drilled_ball().max_thrust_n, 0.01 * drilling.max_thrust_n);
}

TEST(DrillBone, RemovesTheSameWithEveryEngine) {
  SessionSetup setup = setup_of(diameter_path());
  setup.volume.spacing_mm = 0.2;
  PathMotionOptions tilted = motion_of(setup);
  tilted.line.tilt_deg = 2.0;
  const Drilling ring = drill(setup, tilted);
  EXPECT_GT(ring.removed, 10'000U);
  for (const EngineKind kind : {EngineKind::leaf, EngineKind::arc, EngineKind::reference}) {
    setup.engine = kind;
    const Drilling other = drill(setup, tilted);
    EXPECT_EQ(other.removed, ring.removed);
    EXPECT_EQ(other.max_thrust_n, ring.max_thrust_n);
  }
}

TEST(DrillBone, CutsTheSameBoneWithFinerPointsNearTheSurface) {
  const auto work_n_mm = [](const Drilling& drilling) {
    double sum = 0.0;
    for (const DepthRow& row : drilling.rows) sum += row.work_n_mm;
    return sum;
  };
  SessionSetup coarse = setup_of(diameter_path());
  coarse.volume.spacing_mm = 0.2;
  SessionSetup fine = coarse;
  fine.fine_spacing_mm = 0.1;
  fine.fine_near_mm = 3.0;
  fine.fine_tip_mm = 2.0;
  const Drilling by_coarse = drill(coarse, motion_of(coarse));
  const Drilling by_fine = drill(fine, motion_of(fine));
  ASSERT_EQ(by_fine.left.volumes.size(), 3U);  // around the entry, between, before the target
  EXPECT_GT(by_fine.points, by_coarse.points * 2);
  // A bit of 15.5 spacings across is cut to 1 % at 0.2 mm, and better at 0.1 mm.
  EXPECT_NEAR(work_n_mm(by_fine), work_n_mm(by_coarse), 0.02 * work_n_mm(by_coarse));
}

TEST(DrillBone, CutsTheHoleOfATremblingOperatorOutOfTheGrid) {
  RELEASE_ONLY();
  const SessionSetup setup = setup_of(diameter_path());
  PathMotionOptions trembling = motion_of(setup, 0.005);
  trembling.tremor_mm = 0.15;
  const Drilling drilling = drill(setup, trembling);
  // What the points lost is what the grid lost: both are the union of all poses. A point stands for its share of its
  // ring; the wall cuts points and voxels at random.
  double points_mm3 = 0.0;
  const PointVolume& volume = drilling.left.volumes.front();
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t n = 0; n < volume.pattern().point_count(); ++n) {
      const Vec3 p_mm = volume.frame().to_patient(volume.point_in_path_mm(disc, n));
      const bool was_bone = kLargeBall.distance_mm(p_mm) < 0.0;
      if (was_bone && !volume.is_occupied(disc, n)) points_mm3 += std::numbers::pi / 3.0 * 1e-3;
    }
  }
  const double grid_mm3 =
      measure_mesh(bone_surface(ball_bone())).volume_mm3 - measure_mesh(bone_surface(drilling.drilled)).volume_mm3;
  EXPECT_NEAR(grid_mm3, points_mm3, 0.015 * points_mm3);
  const double steady_mm3 = measure_mesh(bone_surface(ball_bone())).volume_mm3 -
                            measure_mesh(bone_surface(drilled_ball().drilled)).volume_mm3;
  EXPECT_GT(grid_mm3, 1.1 * steady_mm3);  // a hole wider by twice the tremor
}

TEST(DrillBone, KeepsTheBoneAsItWasBeforeWithEarlierHolesInIt) {
  SessionSetup setup = setup_of(diameter_path());
  const DrillPath& path = setup.path;
  const Vec3 aside_mm = 8.0 * path.direction().unitOrthogonal();
  const Pose out{path.entry_mm + aside_mm - 5.0 * path.direction(), path.direction()};
  const Pose in{path.entry_mm + aside_mm + 15.0 * path.direction(), path.direction()};
  setup.holes = {{path.bit, {{out, in}}}};
  const Drilling drilling = drill(setup, motion_of(setup, 0.5));
  const std::array<Vec3, 2> middles_mm{in.tip_mm - 8.0 * path.direction(), path.entry_mm + 7.0 * path.direction()};
  std::array<std::uint8_t, 2> before{}, after{};
  drilling.before.inside(middles_mm, before);
  drilling.drilled.inside(middles_mm, after);
  EXPECT_THAT(before, testing::ElementsAre(0, 1));
  EXPECT_THAT(after, testing::ElementsAre(0, 0));
}

TEST(DrillBone, InRealTimeCountsItsCyclesAndRemovesWhatTheOperatorReached) {
  SessionSetup setup = setup_of(diameter_path());
  setup.volume.spacing_mm = 0.2;
  PathMotionOptions quick = motion_of(setup);
  quick.rate_hz = 500.0;
  quick.feed.steps = {{0.0, 20.0}};
  LiveMesh live(ball_bone(), setup.path.bit, setup.options.max_jump_mm);
  const Drilling drilling = drill(setup, quick,
                                  {.log_step_mm = 0.5,
                                   .real_time = RealTimeOptions{.rate_hz = 500.0, .tool_rate_hz = 500.0},
                                   .display = [&live](const Cycle& cycle) { live.update(cycle.input); }});
  ASSERT_TRUE(drilling.real_time.has_value());
  EXPECT_EQ(drilling.real_time->collision.cycles, drilling.cycles);
  EXPECT_GT(drilling.real_time->display.cycles, 0U);
  EXPECT_NEAR(drilling.session_s, 25.0 / 20.0, 1e-9);
  EXPECT_NEAR(drilling.deepest_mm, 22.0, 1e-6);
  // Late or not, the straight ways between the poses are cut.
  const Drilling lock_step = drill(setup, quick);
  EXPECT_EQ(drilling.removed, lock_step.removed);
}

TEST(DrillBone, AsksTheExactSurfaceWhereThereIsOne) {
  class SmallerBall final : public ScalarField {
   public:
    void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
      for (std::size_t i = 0; i < points_mm.size(); ++i) {
        values_mm[i] = (points_mm[i] - kLargeBall.centre_mm).norm() - (kLargeBall.radius_mm - 5.0);
      }
    }
  };
  const SmallerBall exact;
  const SessionSetup setup = setup_of(diameter_path());
  const Drilling drilling = drill(setup, motion_of(setup), {.exact = &exact, .log_step_mm = 0.5});
  // The tip meets the smaller ball 5 mm beyond the entry; the first disc in it may lie a spacing further.
  EXPECT_NEAR(drilling.entry_depth_mm, 5.0, 0.15);
  // A cylinder of 3 mm, less half a spacing, from 5 mm to 22 mm, in points of their share of the section.
  const double expected = std::numbers::pi * 2.95 * 2.95 * 17.0 / (std::numbers::pi / 3.0 * 1e-3);
  EXPECT_NEAR(static_cast<double>(drilling.points_in_bone), expected, 0.03 * expected);
}

TEST(DrillBone, TakesOneByteLessAPointWithCtNumbersOfEightBits) {
  SessionSetup setup = setup_of(diameter_path());
  setup.volume.hu_bits = HuBits::eight;
  const Drilling drilling = drill(setup, motion_of(setup));
  EXPECT_EQ(drilling.removed, drilled_ball().removed);
  EXPECT_NEAR(drilled_ball().bytes_per_point - drilling.bytes_per_point, 1.0, 0.01);
}

TEST(DrillBone, SaysWhereAPathRunsThatMissesTheBone) {
  DrillPath path = diameter_path();
  path.name = "beside";
  path.entry_mm = Vec3(60.5, -2.0, 100.0);
  path.target_mm = Vec3(60.5, 20.25, 100.0);
  EXPECT_THAT(
      [&] { drill(setup_of(path), motion_of(setup_of(path))); },
      ThrowsMessage<Error>(AllOf(HasSubstr("\"beside\""), HasSubstr("misses the bone"), HasSubstr("60.5, -2, 100"),
                                 HasSubstr("60.5, 20.25, 100"), HasSubstr("the bone lies within (-12."))));
}

TEST(DrillBone, LeavesASurfaceThatIsSharpAtTheRim) {
  const TriangleMesh mesh = sharp_surface(drilled_ball().drilled);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 2);
  // Where the bit's wall meets the ball: a circle.
  const DrillPath path = diameter_path();
  const double radius_mm = path.bit.radius_mm();
  const Vec3 axis = path.direction();
  const Vec3 u = any_perpendicular(axis);
  const Vec3 v = axis.cross(u);
  std::vector<Vec3> rim_mm;
  for (int n = 0; n < 360; ++n) {
    const double turn = n * std::numbers::pi / 180.0;
    rim_mm.push_back(kLargeBall.centre_mm -
                     std::sqrt(kLargeBall.radius_mm * kLargeBall.radius_mm - radius_mm * radius_mm) * axis +
                     radius_mm * (std::cos(turn) * u + std::sin(turn) * v));
  }
  const MeshDistance sharp = surface_to_mesh(rim_mm, mesh);
  const MeshDistance rounded = surface_to_mesh(rim_mm, bone_surface(drilled_ball().drilled));
  const double voxel_mm = ball_bone().voxel_mm();
  EXPECT_LT(sharp.mean_mm, 0.05 * voxel_mm);
  EXPECT_LT(5.0 * sharp.mean_mm, rounded.mean_mm);
  // A cell that the rim cuts a corner of, between the voxels, has no vertex on it.
  EXPECT_LT(sharp.max_mm, 0.3 * voxel_mm);
  RemainingBone whole(ball_bone(), {.voxel_mm = voxel_mm});
  const double before_mm3 = measure_mesh(join_blocks(RemainingSurface(whole).blocks())).volume_mm3;
  // A cylinder less half of the ball's cap that it begins with, and a cone.
  const double cap_mm =
      kLargeBall.radius_mm - std::sqrt(kLargeBall.radius_mm * kLargeBall.radius_mm - radius_mm * radius_mm);
  const double tip_mm = path.bit.tip_length_mm;
  const double hole_mm3 =
      std::numbers::pi * radius_mm * radius_mm * (path.length_mm() - tip_mm - 0.5 * cap_mm + tip_mm / 3.0);
  EXPECT_NEAR(before_mm3 - quality.volume_mm3, hole_mm3, 0.005 * hole_mm3);
}

}  // namespace
}  // namespace spinaltap
