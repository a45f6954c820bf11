// A bit that touches with its spindle off.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/force/detail/tool_contact.h"
#include "core/points/bone_points.h"
#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

using test::FeltBit;
using test::kFeltHu;

const Spindle kOff{.rpm = 0.0};

/// Stiffness of a surface as large as the bit's section, N/mm.
double stiffness_n_mm() { return Material().contact_stiffness_n_mm(kFeltHu); }

TEST(Contact, PushesBackFromAFloorInProportionToDepth) {
  // A bit that ends nearly flat, 1 mm of floor: bone from z = 4 mm on.
  const DrillBit flat = twist_drill(3.0, 20.0, 176.0, 2.9);
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  for (const double spacing_mm : {0.2, 0.1, 0.05}) {
    PointVolume volume = test::block(8.0, 3.0, spacing_mm, kFeltHu);
    test::fill_density(volume, material, [&](const Vec3& p) { return p.z() > 4.0 ? density : 0.0; });
    FeltBit felt(volume, flat, material, kOff);
    for (double depth_mm = -0.5; depth_mm < 1.2; depth_mm += 0.013) {
      const DrillForce& force = felt.move_to(Vec3(0.0, 0.0, 4.0 + depth_mm));
      const Vec3 push_n = felt.along_path(force.contact_n);
      EXPECT_EQ(force.force_n, force.contact_n);
      EXPECT_EQ(force.thrust_n, 0.0);
      EXPECT_EQ(force.torque_n_mm, 0.0);
      // Bone begins half a spacing before its first disc: where the lattice puts the floor, to half a spacing. Walls
      // are pushed from all around, which cancels.
      const double slack_n = stiffness_n_mm() * (0.5 * spacing_mm + 0.02);
      EXPECT_NEAR(-push_n.z(), stiffness_n_mm() * std::max(0.0, depth_mm), slack_n) << depth_mm;
      EXPECT_NEAR(push_n.head<2>().norm(), 0.0, 0.02 * stiffness_n_mm()) << depth_mm;
    }
  }
}

TEST(Contact, GrowsWithoutJumps) {
  const DrillBit bit{3.0, 20.0, 5.0};
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  PointVolume volume = test::block(8.0, 3.0, 0.1, kFeltHu);
  test::fill_density(volume, material, [&](const Vec3& p) { return p.z() > 4.0 ? density : 0.0; });
  FeltBit felt(volume, bit, material, kOff);
  double before_n = 0.0;
  double max_rise_n = 0.0;
  for (double depth_mm = -0.2; depth_mm < 1.0; depth_mm += 0.005) {
    const double push_n = -felt.along_path(felt.move_to(Vec3(0.0, 0.0, 4.0 + depth_mm)).contact_n).z();
    EXPECT_GE(push_n, before_n - 0.02 * stiffness_n_mm());
    max_rise_n = std::max(max_rise_n, push_n - before_n);
    before_n = push_n;
  }
  EXPECT_GT(before_n, 0.0);
  // 5 um of a whole section's stiffness would be 0.005 of it; a ring of places that sets in makes it more.
  EXPECT_LT(max_rise_n, 0.03 * stiffness_n_mm());
}

TEST(Contact, OfAShankComesFromTheWallThatItLeansOn) {
  const DrillBit bit{3.0, 20.0, 5.0};
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  PointVolume volume = test::block(12.0, 3.0, 0.1, kFeltHu);
  // A wall from x = 1.5 mm on: the cylinder touches it along its whole length in the volume.
  test::fill_density(volume, material, [&](const Vec3& p) { return p.x() > 1.5 ? density : 0.0; });
  FeltBit felt(volume, bit, material, kOff);
  double before_n = 0.0;
  for (const double into_mm : {0.1, 0.2, 0.3, 0.4}) {
    const Vec3 push_n = felt.along_path(felt.move_to(Vec3(into_mm, 0.0, 12.0)).contact_n);
    EXPECT_LT(push_n.x(), -before_n);
    EXPECT_LT(std::abs(push_n.y()), 0.02 * std::abs(push_n.x()));
    EXPECT_LT(std::abs(push_n.z()), 0.1 * std::abs(push_n.x()));
    before_n = -push_n.x();
  }
  // Each mm of the cylinder's length pushes with the depth over its circle: 2 R integral of cos of (R cos - d) ... in
  // closed form below, over the section, along some 7 mm of cylinder and, less, the cone.
  const double r = 1.5, d = r - 0.4;
  const double edge = std::acos(d / r);
  double per_mm = 0.0;  // of depth along the normal times the share across: (r - d / cos) cos
  for (int n = 0; n < 1000; ++n) {
    const double angle = (n + 0.5) / 1000 * edge;
    per_mm += 2.0 * edge / 1000 * r * (r - d / std::cos(angle)) * std::cos(angle);
  }
  const double cylinder_n = stiffness_n_mm() * per_mm * 7.0 / (std::numbers::pi * r * r);
  EXPECT_NEAR(before_n, cylinder_n, 0.15 * cylinder_n);
}

TEST(Contact, DoesNotDependOnHowManyPlacesStandForTheSurface) {
  // Two bits of the same outline, the second in more pieces of places since it is longer; both in bone with their tips.
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  PointVolume volume = test::block(8.0, 3.0, 0.05, kFeltHu);
  test::fill_density(volume, material, [&](const Vec3& p) { return p.z() > 4.0 ? density : 0.0; });
  FeltBit felt_short(volume, {3.0, 8.0, 2.0}, material, kOff);
  FeltBit felt_long(volume, {3.0, 50.0, 2.0}, material, kOff);
  const BonePoints bone({&volume, 1}, material);
  EXPECT_GT(ToolContact(bone, {3.0, 50.0, 2.0}).place_count(), ToolContact(bone, {3.0, 8.0, 2.0}).place_count());
  const double a = felt_short.move_to(Vec3(0.0, 0.0, 5.0)).contact_n.norm();
  EXPECT_NEAR(felt_long.move_to(Vec3(0.0, 0.0, 5.0)).contact_n.norm(), a, 1e-9 * a);
  EXPECT_GT(a, 0.0);
}

TEST(Contact, TakesEnergyOutOfWhatBouncesOnIt) {
  // Pressed 1 mm into a floor and back, at 100 mm/s: more force on the way in than on the way out at the same depth.
  const DrillBit flat = twist_drill(3.0, 20.0, 176.0, 2.9);
  Material material;
  const double density = material.density.density_g_cm3(kFeltHu);
  PointVolume volume = test::block(8.0, 3.0, 0.1, kFeltHu);
  test::fill_density(volume, material, [&](const Vec3& p) { return p.z() > 4.0 ? density : 0.0; });
  FeltBit felt(volume, flat, material, kOff);
  const auto push_n = [&](double z_mm) { return -felt.along_path(felt.move_to(Vec3(0.0, 0.0, z_mm)).contact_n).z(); };
  std::vector<double> in_n, out_n;
  constexpr double kStepMm = 0.1;  // of a millisecond
  for (int n = -20; n <= 10; ++n) in_n.push_back(push_n(4.0 + kStepMm * n));
  for (int n = 0; n < 50; ++n) push_n(5.0);  // it stands
  const double at_rest_n = push_n(5.0);
  for (int n = 10; n >= -20; --n) out_n.push_back(push_n(4.0 + kStepMm * n));
  // A factor of 1 + 0.0015 s/mm times 100 mm/s on the way in, by then.
  EXPECT_NEAR(in_n.back(), 1.15 * at_rest_n, 0.01 * at_rest_n);
  double in_n_mm = 0.0, out_n_mm = 0.0;
  for (const double n : in_n) in_n_mm += n * kStepMm;
  for (const double n : out_n) out_n_mm += n * kStepMm;
  EXPECT_GT(in_n_mm, 1.15 * out_n_mm);
  EXPECT_GE(*std::min_element(out_n.begin(), out_n.end()), 0.0) << "bone does not hold it back";
}

TEST(ToolContact, CoversTheWholeSurfaceWithForcesThatCancelInsideBone) {
  // In bone all around, at depths that are the same everywhere, a closed surface feels nothing.
  PointVolume volume = test::block(30.0, 6.0, 0.2, kFeltHu);
  for (const DrillBit& bit : {DrillBit{3.0, 12.0, 4.0}, twist_drill(3.0, 12.0, 118.0, 0.6),
                              DrillBit{4.0, 12.0, 1.0, BitShape::round_burr, 0.0, 1.5},
                              DrillBit{4.0, 12.0, 3.0, BitShape::conical_burr, 1.0, 2.0}}) {
    FeltBit felt(volume, bit, {}, kOff);
    const double push_n = felt.move_to(Vec3(0.0, 0.0, 22.0)).contact_n.norm();
    EXPECT_LT(push_n, 0.02 * stiffness_n_mm() * bit.radius_mm());
  }
}

}  // namespace
}  // namespace spinaltap
