// Bits that turn in bone: what the spindle gives must be the energy of what they cut, wherever they turn about.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/force/drill_forces.h"
#include "core/points/hu_byte.h"
#include "tests/support/made_bone.h"
#include "tests/support/release_only.h"
#include "vdb/engine/occupied_voxels.h"
#include "vdb/engine/voxel_engine.h"

namespace spinaltap {
namespace {

constexpr std::int16_t kTurnedHu = 304;  // cancellous; eight bits have it
constexpr double kTurnedHalfMm = 14.0;
constexpr double kTurnStepS = 1e-3;

/// An even cube around the origin.
const BoneModel& even_cube() {
  static const BoneModel bone = [] {
    auto grids = std::make_shared<detail::BoneGrids>();
    const Box3 box_mm(Vec3::Constant(-kTurnedHalfMm - 1.5), Vec3::Constant(kTurnedHalfMm + 1.5));
    grids->sdf = test::made_sdf([](const Vec3& p) { return p.cwiseAbs().maxCoeff() - kTurnedHalfMm; }, box_mm, 0.5);
    auto hu = openvdb::FloatGrid::create(static_cast<float>(kTurnedHu));
    hu->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    hu->setName("hu");
    hu->denseFill(
        {openvdb::Coord::floor(detail::to_vdb(box_mm.min())), openvdb::Coord::ceil(detail::to_vdb(box_mm.max()))},
        static_cast<float>(kTurnedHu), true);
    grids->hu = hu;
    return BoneModel(grids);
  }();
  return bone;
}

/// A session's engine and forces in the cube.
class TurningBit {
 public:
  TurningBit(const DrillBit& bit, double voxel_mm)
      : bone_(even_cube(), {.voxel_mm = voxel_mm}),
        engine_(make_voxel_engine(bone_, bit, material_)),
        occupied_(make_occupied_bone(bone_, material_)),
        forces_(*occupied_, bit, material_) {}

  DrillForce step(const Pose& pose) {
    const StepResult result = engine_->step(pose);
    removed_n_mm += result.work_n_mm;
    return forces_.update(result, pose, kTurnStepS, spindle);
  }
  /// To `depth_mm` below the cube's upper face, along `axis`, and rests there.
  void plunge(const Vec3& entry_mm, const Vec3& axis, double depth_mm) {
    for (double at_mm = -2.0; at_mm < depth_mm; at_mm += 0.02) step({entry_mm + at_mm * axis, axis});
    for (int n = 0; n < 200; ++n) step({entry_mm + depth_mm * axis, axis});
    removed_n_mm = 0.0;
  }

  const Spindle spindle{10'000.0, true};
  double removed_n_mm = 0.0;

 private:
  Material material_;
  VoxelBone bone_;
  std::unique_ptr<DrillEngine> engine_;
  std::unique_ptr<OccupiedBone> occupied_;
  DrillForces forces_;
};

/// A plain cylinder, whose section does not change along it.
DrillBit cylinder_bit() { return profile_bit({{0.0, 0.0}, {0.0, 1.5}, {60.0, 1.5}}); }

/// Of a cylinder of radius R that turns by `rate` rad/s about a place `about_mm` back from its tip, in bone that it
/// lies in over `deep_mm`: every stretch of it cuts 2 R times its own way, at its own feed.
double torque_of_turning(const Material& material, const Spindle& spindle, double radius_mm, double rate,
                         double about_mm, double deep_mm) {
  const double turns_per_s = spindle.rpm / 60.0;
  const double power = 2.0 - material.feed_exponent;
  const auto ends = [&](double mm) { return std::copysign(std::pow(std::abs(mm), power), mm); };
  const double along = (ends(deep_mm - about_mm) - ends(-about_mm)) / power;  // of |way|^(1 - m) over its length
  const double power_n_mm_s = material.cutting_energy_mpa(kTurnedHu) * 2.0 * radius_mm *
                              std::pow(rate, 1.0 - material.feed_exponent) * along *
                              std::pow(turns_per_s * material.reference_feed_mm, material.feed_exponent);
  return power_n_mm_s / (2.0 * std::numbers::pi * turns_per_s);
}

TEST(TurningForces, TurnTheSpindleWithTheEnergyOfWhatIsCutWhereverTheBitTurnsAbout) {
  RELEASE_ONLY();
  constexpr double kDeepMm = 20.0;
  const Vec3 axis = -Vec3::UnitZ();
  const Vec3 entry_mm(0.13, -0.21, kTurnedHalfMm);
  for (const double voxel_mm : {0.2, 0.1, 0.07}) {
    for (const double about_mm : {0.0, 20.0, 8.0, 60.0}) {  // tip, entry, between them, behind
      SCOPED_TRACE(testing::Message() << voxel_mm << " mm, about a place " << about_mm << " mm back from the tip");
      TurningBit bit(cylinder_bit(), voxel_mm);
      bit.plunge(entry_mm, axis, kDeepMm);
      const Vec3 pivot_mm = entry_mm + (kDeepMm - about_mm) * axis;
      // The furthest place in bone goes 2.4 mm in all, in a plane that is not the lattice's.
      const double most_mm = std::max(about_mm, kDeepMm - about_mm);
      const double rate = 6.0 / most_mm;  // rad/s: 6 mm/s there
      const Vec3 around = Vec3(0.8, 0.6, 0.0);
      double turned_n_mm = 0.0, expected_n_mm = 0.0;
      for (int n = 1; n <= 400; ++n) {
        const double angle = rate * kTurnStepS * n;
        const Vec3 now = Eigen::AngleAxisd(angle, around) * axis;
        const DrillForce force = bit.step({pivot_mm + about_mm * now, now});
        ASSERT_TRUE(force.force_n.allFinite());
        if (n <= 150) continue;  // what is felt comes a box of 0.2 to 0.4 mm of way late
        // Leaning, a little more or less of the bit lies below the face.
        const double above_mm = (kTurnedHalfMm - (pivot_mm + about_mm * now).z()) / -now.z();
        turned_n_mm += force.torque_n_mm;
        expected_n_mm += torque_of_turning(Material(), bit.spindle, 1.5, rate, about_mm, above_mm);
      }
      EXPECT_NEAR(turned_n_mm / expected_n_mm, 1.0, 0.02);
    }
  }
}

TEST(TurningForces, AWobbleAboutTheTipFeelsNoKickWhenItGoesAsideAfterwards) {
  // 3 degrees about the tip at 30 mm of depth is not to be had in this cube: 24 mm, and as much at the mouth.
  const DrillBit drill = twist_drill(3.0, 60.0, 118.0, 0.48);
  const Vec3 axis = -Vec3::UnitZ();
  const Vec3 entry_mm(0.13, -0.21, kTurnedHalfMm);
  const auto most_aside = [&](double turn_deg) {
    TurningBit bit(drill, 0.1);
    bit.plunge(entry_mm, axis, 24.0);
    const Vec3 tip_mm = entry_mm + 24.0 * axis;
    Vec3 now = axis;
    const Vec3 around = Vec3(0.8, 0.6, 0.0);
    for (int n = 1; n <= 300 && turn_deg > 0.0; ++n) {
      now = Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180.0 * n / 300.0, around) * axis;
      bit.step({tip_mm, now});
    }
    for (int n = 0; n < 100; ++n) bit.step({tip_mm, now});
    const Vec3 aside = now.cross(around).normalized();
    std::array<double, 2> most{};
    for (int n = 1; n <= 1000; ++n) {
      const DrillForce force = bit.step({tip_mm + 1e-3 * n * aside, now});  // 1 mm/s
      most[0] = std::max(most[0], force.force_n.norm());
      most[1] = std::max(most[1], force.torque_n_mm);
    }
    return most;
  };
  const auto without = most_aside(0.0), with = most_aside(3.0);
  EXPECT_LT(with[0], without[0] + 5.0);
  EXPECT_LT(with[1], 1.3 * without[1] + 5.0);
  EXPECT_GT(without[0], 0.1);
}

TEST(TurningForces, AfterAStopAreNeverMoreThanTwiceTheSteadyOnes) {
  RELEASE_ONLY();
  // Aside, about the tip, about the entry; each stops for a tenth of a second and goes on.
  const Vec3 axis = -Vec3::UnitZ();
  const Vec3 entry_mm(0.13, -0.21, kTurnedHalfMm);
  for (int kind = 0; kind < 3; ++kind) {
    SCOPED_TRACE(kind);
    TurningBit bit(twist_drill(3.0, 60.0, 118.0, 0.48), 0.1);
    bit.plunge(entry_mm, axis, 16.0);
    const Vec3 around = Vec3(0.8, 0.6, 0.0), aside = axis.cross(around);
    const auto pose_at = [&](double share) -> Pose {  // of 3 mm
      const double angle = share * 3.0 / 16.0;
      const Vec3 now = kind == 0 ? axis : Vec3(Eigen::AngleAxisd(angle, around) * axis);
      if (kind == 0) return {entry_mm + 16.0 * axis + 3.0 * share * aside, axis};
      if (kind == 1) return {entry_mm + 16.0 * axis, now};
      return {entry_mm + 16.0 * now, now};
    };
    double steady_n = 0.0, after_n = 0.0, steady_n_mm = 0.0, after_n_mm = 0.0;
    for (int n = 1; n <= 500; ++n) {
      const DrillForce force = bit.step(pose_at(5e-4 * n));
      if (n <= 250) continue;
      steady_n = std::max(steady_n, force.lateral_n.norm());
      steady_n_mm = std::max(steady_n_mm, force.torque_n_mm);
    }
    for (int n = 0; n < 100; ++n) bit.step(pose_at(0.25));
    for (int n = 501; n <= 1000; ++n) {
      const DrillForce force = bit.step(pose_at(5e-4 * n));
      after_n = std::max(after_n, force.lateral_n.norm());
      after_n_mm = std::max(after_n_mm, force.torque_n_mm);
    }
    EXPECT_GT(steady_n_mm, 0.5);
    EXPECT_LT(after_n, 2.0 * steady_n);
    EXPECT_LT(after_n_mm, 2.0 * steady_n_mm);
  }
}

TEST(TurningForces, PureSpinFeelsNothing) {
  TurningBit bit(twist_drill(3.0, 60.0, 118.0, 0.48), 0.1);
  const Vec3 axis = -Vec3::UnitZ();
  const Vec3 entry_mm(0.13, -0.21, kTurnedHalfMm);
  bit.plunge(entry_mm, axis, 10.0);
  for (int n = 0; n < 100; ++n) {
    const DrillForce force = bit.step({entry_mm + 10.0 * axis, axis});
    EXPECT_LT(force.force_n.norm(), 1e-9);
    EXPECT_LT(force.torque_n_mm, 1e-9);
  }
}

}  // namespace
}  // namespace spinaltap
