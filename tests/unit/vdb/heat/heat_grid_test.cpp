#include "vdb/heat/heat_grid.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/made_bone.h"
#include "tests/support/release_only.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

constexpr double kGridPi = std::numbers::pi;
constexpr ThermalTissue kHeatedCortex{5.5e-4, 2.2625e-3};

/// The same everywhere.
class EvenMedium final : public HeatMedium {
 public:
  explicit EvenMedium(const ThermalTissue& tissue) : tissue_(tissue) {}
  void tissues(std::span<const Vec3> /*points_mm*/, std::span<ThermalTissue> tissues) const override {
    std::ranges::fill(tissues, tissue_);
  }

 private:
  ThermalTissue tissue_;
};
const EvenMedium kEven(kHeatedCortex);

/// Heat in an endless even medium, `spread` being four times diffusivity times time.
double instant_point_k(double heat_j, double distance_mm, double time_s) {
  const double spread = 4.0 * kHeatedCortex.diffusivity_mm2_s() * time_s;
  return heat_j / kHeatedCortex.capacity_j_mm3_k * std::pow(kGridPi * spread, -1.5) *
         std::exp(-distance_mm * distance_mm / spread);
}

SLOW_TESTS("HeatGrid.TellsHowLongWhichVolumeWasHot", "HeatGrid.StaysWithinABakedBone");

TEST(HeatGrid, SpreadsAnInstantPointAsTheExactSolution) {
  HeatGrid grid(kEven, {.voxel_mm = 0.125});
  grid.heat_point(Vec3::Zero(), 0.05);
  grid.advance(1.0);
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0.5, -0.75, 0), Vec3(0.5, 0.5, -0.5), Vec3(0, 0, 1.25)}) {
    const double exact_k = instant_point_k(0.05, at.norm(), 1.0);
    EXPECT_NEAR(grid.rise_k(at), exact_k, 0.01 * exact_k) << at.transpose();
  }
  EXPECT_NEAR(grid.balance().in_bone_j, 0.05, 1e-12);
}

TEST(HeatGrid, HeatsAroundAStandingPointAsTheExactSolution) {
  HeatGrid grid(kEven, {.voxel_mm = 0.1});
  const double watts = 0.2;
  for (int step = 0; step < 400; ++step) {
    grid.heat_point(Vec3::Zero(), watts * 0.005);
    grid.advance(0.005);
  }
  // Carslaw and Jaeger 10.4: P / (4 π k r) erfc(r / √(4 α t)).
  for (const Vec3& at : {Vec3(1.0, 0, 0), Vec3(0, -0.8, 0.6), Vec3(0.6, 1.0, 0.8)}) {
    const double r = at.norm();
    const double exact_k = watts / (4.0 * kGridPi * kHeatedCortex.conductivity_w_mm_k * r) *
                           std::erfc(r / std::sqrt(4.0 * kHeatedCortex.diffusivity_mm2_s() * 2.0));
    EXPECT_NEAR(grid.rise_k(at), exact_k, 0.01 * exact_k) << at.transpose();
  }
}

TEST(HeatGrid, FollowsAMovingPointAsRosenthal) {
  RELEASE_ONLY();
  // Carslaw and Jaeger 10.7: from a start at rest; the first part alone, doubled, is Rosenthal's, which it comes to. A
  // pulse stands for half a step before and after it.
  const double speed_mm_s = 0.5, watts = 0.2, dt_s = 0.01, end_s = 5.0;
  HeatGrid grid(kEven, {.voxel_mm = 0.125});
  const auto steps = static_cast<int>(std::lround(end_s / dt_s));
  for (int step = 0; step < steps; ++step) {
    grid.heat_point(Vec3(0, 0, speed_mm_s * dt_s * step), watts * dt_s);
    grid.advance(dt_s);
  }
  const double alpha = kHeatedCortex.diffusivity_mm2_s();
  for (const Vec3& from_point : {Vec3(0, 1.0, 0), Vec3(0.75, 0, -1.0), Vec3(0, 0.75, -0.75), Vec3(0, 0, -1.0),
                                 Vec3(0.75, 0.5, -0.5), Vec3(0.75, 0.25, 0.25)}) {
    const double r = from_point.norm();
    const double root = std::sqrt(4.0 * alpha * end_s);
    const double drift = speed_mm_s * end_s / root;
    const double power = speed_mm_s / (2.0 * alpha);
    const double exact_k =
        watts / (8.0 * kGridPi * kHeatedCortex.conductivity_w_mm_k * r) * std::exp(-power * from_point.z()) *
        (std::exp(-power * r) * std::erfc(r / root - drift) + std::exp(power * r) * std::erfc(r / root + drift));
    const double rosenthal_k =
        watts / (4.0 * kGridPi * kHeatedCortex.conductivity_w_mm_k * r) * std::exp(-power * (r + from_point.z()));
    const double found_k = grid.rise_k(Vec3(0, 0, speed_mm_s * end_s) + from_point);
    std::printf("moving point, %.2f mm: %.4f, exact %.4f, Rosenthal %.4f\n", r, found_k, exact_k, rosenthal_k);
    EXPECT_NEAR(found_k, exact_k, 0.01 * exact_k) << from_point.transpose();
  }
}

TEST(HeatGrid, SpreadsARingAsTheExactSolution) {
  // Its heat goes in a quarter of a voxel outside it.
  HeatGrid grid(kEven, {.voxel_mm = 0.1, .origin_mm = Vec3(0.03, -0.02, 0.01)});
  grid.heat_ring(Vec3::Zero(), Vec3::UnitZ(), 1.5, 2.0);
  grid.advance(1.0);
  const double a = 1.525;
  for (const Vec3& near : {Vec3(0, 0, 0), Vec3(1.0, 0, 0), Vec3(0, 1.5, 0), Vec3(1.4, 1.4, 0.3), Vec3(0, -2.0, 0.5)}) {
    // The centre of the voxel that is asked.
    const Vec3 at = Vec3(0.03, -0.02, 0.01) + 0.1 * ((near - Vec3(0.03, -0.02, 0.01)) / 0.1).array().round().matrix();
    const double r = std::hypot(at.x(), at.y());
    // Round the ring by 720 points.
    double exact_k = 0.0;
    for (int n = 0; n < 720; ++n) {
      const double angle = n * kGridPi / 360.0;
      exact_k +=
          instant_point_k(2.0 / 720.0, std::sqrt(r * r + a * a - 2.0 * r * a * std::cos(angle) + at.z() * at.z()), 1.0);
    }
    EXPECT_NEAR(grid.rise_k(near), exact_k, 0.02 * exact_k + 0.001) << near.transpose();
  }
}

/// Bone below z = 0.1, air above it.
class HalfSpace final : public HeatMedium {
 public:
  void tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      tissues[n] = points_mm[n].z() < 0.1 ? kHeatedCortex : ThermalTissue{};
    }
  }
};

TEST(HeatGrid, LetsNoHeatIntoAir) {
  // The surface mirrors: a point and its image. Voxels end at 0.1.
  const HalfSpace half;
  HeatGrid grid(half, {.voxel_mm = 0.2});
  grid.heat_point(Vec3(0, 0, -0.8), 0.05);
  grid.heat_point(Vec3(0, 0, 3.0), 0.01);
  grid.advance(2.0);
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.6, 0, -0.2), Vec3(0, 0.4, -1.0)}) {
    const double exact_k = instant_point_k(0.05, (at - Vec3(0, 0, -0.8)).norm(), 2.0) +
                           instant_point_k(0.05, (at - Vec3(0, 0, 1.0)).norm(), 2.0);
    EXPECT_NEAR(grid.rise_k(at), exact_k, 0.01 * exact_k) << at.transpose();
  }
  EXPECT_EQ(grid.rise_k(Vec3(0, 0, 0.2)), 0.0);
  EXPECT_NEAR(grid.balance().in_bone_j, 0.05, 1e-12);
  EXPECT_EQ(grid.balance().missed_j, 0.01);
}

/// Two tissues side by side.
class TwoTissues final : public HeatMedium {
 public:
  static constexpr ThermalTissue kLeft{2.9e-4, 3.05e-3};
  void tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) tissues[n] = points_mm[n].x() < 0.1 ? kLeft : kHeatedCortex;
  }
};

TEST(HeatGrid, SharesHeatBetweenTwoTissuesAsTheExactSolution) {
  // A sheet 0.9 mm right of their border at 0.1 mm: a part is thrown back, the rest goes on, by effusivities √(k c).
  const TwoTissues two;
  HeatGrid grid(two, {.voxel_mm = 0.2});
  const int half = 30;
  const double per_mm2_j = 0.3;
  for (int y = -half; y <= half; ++y) {
    for (int z = -half; z <= half; ++z) grid.heat_point(Vec3(1.0, 0.2 * y, 0.2 * z), per_mm2_j * 0.04);
  }
  grid.advance(2.0);
  const auto effusivity = [](const ThermalTissue& t) { return std::sqrt(t.conductivity_w_mm_k * t.capacity_j_mm3_k); };
  const double left = effusivity(TwoTissues::kLeft), right = effusivity(kHeatedCortex);
  const double root_right = std::sqrt(kHeatedCortex.diffusivity_mm2_s());
  const auto exact_k = [&](double x_mm) {
    const double d = 0.9, x = x_mm - 0.1, four_t = 8.0;
    const auto gauss = [&](double root_s) { return std::exp(-root_s * root_s / four_t); };
    if (x < 0.0) {
      const double root_left = std::sqrt(TwoTissues::kLeft.diffusivity_mm2_s());
      return per_mm2_j / ((left + right) * std::sqrt(kGridPi * 2.0)) * gauss(-x / root_left + d / root_right);
    }
    return per_mm2_j / (2.0 * right * std::sqrt(kGridPi * 2.0)) *
           (gauss((x - d) / root_right) + (right - left) / (right + left) * gauss((x + d) / root_right));
  };
  for (const double x_mm : {-0.6, -0.2, 0.0, 0.2, 1.0, 1.6}) {
    EXPECT_NEAR(grid.rise_k(Vec3(x_mm, 0, 0)), exact_k(x_mm), 0.015 * exact_k(x_mm)) << x_mm;
  }
}

/// 4 s of a 3 mm bit at 1 mm/s with 1 W.
HeatGrid drilled_block(const HeatMedium& medium, double water_w_mm2_k) {
  HeatGrid grid(medium, {.voxel_mm = 0.25, .wall_transfer_w_mm2_k = water_w_mm2_k, .water_rise_k = -10.0});
  const BitProfile bit(twist_drill(3.0, 40.0, 118.0, 0.5));
  for (int step = 1; step <= 40; ++step) {
    const Vec3 tip(0, 0, 2.0 + 0.1 * step);
    grid.drill(bit, {tip, Vec3::UnitZ()});
    grid.heat_ring(tip - Vec3(0, 0, 0.9), Vec3::UnitZ(), 1.5, 0.1);
    grid.advance(0.1);
  }
  return grid;
}

TEST(HeatGrid, LosesNoHeat) {
  for (const double water : {0.0, 1e-3}) {
    const HeatGrid grid = drilled_block(kEven, water);
    const HeatBalance balance = grid.balance();
    EXPECT_NEAR(balance.given_j, 4.0, 1e-9);
    EXPECT_NEAR(balance.in_bone_j + balance.drilled_j + balance.water_j, balance.given_j, 1e-9);
    EXPECT_GT(balance.drilled_j, 0.0);
    EXPECT_EQ(balance.water_j > 0.0, water > 0.0);
  }
}

TEST(HeatGrid, GivesTheSameBitsAtAnyNumberOfThreads) {
  RELEASE_ONLY();
  const auto values_of = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const HeatGrid grid = drilled_block(kEven, 1e-3);
    std::vector<double> values{grid.balance().in_bone_j, grid.balance().water_j, grid.hottest().rise_k};
    for (double x = -4.0; x < 4.0; x += 0.25) values.push_back(grid.rise_k(Vec3(x, 0.5, 4.0)));
    return values;
  };
  const std::vector<double> alone = values_of(1);
  EXPECT_EQ(values_of(2), alone);
  EXPECT_EQ(values_of(4), alone);
}

TEST(HeatGrid, TellsHowLongWhichVolumeWasHot) {
  // A point's rise stays above one of 10 K for as long as the exact solution says.
  HeatGrid grid(kEven, {.voxel_mm = 0.125, .hot_rise_k = {10.0, 13.0}});
  grid.heat_point(Vec3::Zero(), 0.5);
  grid.advance(5.0);
  for (const double seconds : {1.0, 2.0}) {
    for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
      double exact_mm3 = 0.0;
      // Shells: the time above is counted in steps of 5 ms.
      for (double r = 0.01; r < 4.0; r += 0.02) {
        double above_s = 0.0;
        for (double t = 0.0025; t < 5.0; t += 0.005) {
          if (instant_point_k(0.5, r, t) > (which == 0 ? 10.0 : 13.0)) above_s += 0.005;
        }
        if (above_s >= seconds) exact_mm3 += 4.0 * kGridPi * r * r * 0.02;
      }
      // Whole voxels of a ball: a shell of a tenth of a voxel.
      const double radius_mm = std::cbrt(exact_mm3 * 0.75 / kGridPi);
      EXPECT_NEAR(grid.hot_volume_mm3(which, seconds), exact_mm3, 4.0 * kGridPi * radius_mm * radius_mm * 0.02)
          << which << " " << seconds;
    }
  }
  EXPECT_EQ(grid.hot_volume_mm3(0, 60.0), 0.0);
}

TEST(HeatGrid, StaysWithinABakedBone) {
  initialize_openvdb();
  const BoneModel ball = test::made_bone([](const Vec3& p) { return p.norm() - 5.0; },
                                         Box3(Vec3::Constant(-7.0), Vec3::Constant(7.0)), 0.25);
  const BoneMedium medium(ball, {0.0, 0.001}, ThermalBone{});
  HeatGrid grid(medium, {.voxel_mm = 0.25});
  grid.heat_point(Vec3::Zero(), 5.0);
  grid.advance(200.0);
  // In the end all of it is as warm: heat over capacity of a ball of 300 HU, 0.3 g/cm³.
  const double even_k = 5.0 / (4.0 / 3.0 * kGridPi * 125.0 * ThermalBone{}.at(0.3).capacity_j_mm3_k);
  EXPECT_NEAR(grid.rise_k(Vec3(0, 0, 4.5)), even_k, 0.03 * even_k);
  EXPECT_NEAR(grid.rise_k(Vec3(-4.0, 0, 0)), even_k, 0.03 * even_k);
  EXPECT_EQ(grid.rise_k(Vec3(5.5, 0, 0)), 0.0);
  EXPECT_NEAR(grid.balance().in_bone_j, 5.0, 1e-9);
}

TEST(HeatGrid, IsWrittenInPlace) {
  const test::TemporaryFolder folder;
  Mat3 axes;
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  HeatGrid grid(kEven, {.voxel_mm = 0.2, .origin_mm = Vec3(10, -20, 30), .axes = axes});
  const Vec3 at = Vec3(10, -20, 30) + axes * Vec3(0.4, 0.8, -0.6);
  grid.heat_point(at, 0.05);
  grid.advance(0.5);
  const auto path = folder.path() / "heat.vdb";
  grid.write(path, 37.0);
  detail::VdbFile file(path);
  const auto read = file.read_floats("max_temperature");
  const auto index = read->worldToIndex(detail::to_vdb(at));
  EXPECT_NEAR(index.x(), 2.0, 1e-9);
  EXPECT_NEAR(index.y(), 4.0, 1e-9);
  EXPECT_NEAR(index.z(), -3.0, 1e-9);
  EXPECT_NEAR(static_cast<double>(read->tree().getValue({2, 4, -3})), 37.0 + grid.max_rise_k(at), 1e-4);
  EXPECT_GT(grid.max_rise_k(at), grid.rise_k(at));
  EXPECT_TRUE(file.has("seconds_hot_0"));
  EXPECT_TRUE(file.has("seconds_hot_1"));
}

TEST(HeatGrid, RejectsOptionsWithoutSense) {
  EXPECT_THROW(HeatGrid(kEven, {.voxel_mm = 0.0}), Error);
  EXPECT_THROW(HeatGrid(kEven, {.axes = Mat3::Zero()}), Error);
  EXPECT_THROW(HeatGrid(kEven, {.wall_transfer_w_mm2_k = -1.0}), Error);
  HeatGrid grid(kEven, {});
  EXPECT_THROW(grid.advance(0.0), Error);
  EXPECT_THROW(grid.hot_volume_mm3(2, 1.0), Error);
}

}  // namespace
}  // namespace spinaltap
