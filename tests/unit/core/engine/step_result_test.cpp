// What a step says it did, against the points that are gone after it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/engine/volume_segments.h"
#include "core/tool/bit_profile.h"
#include "tests/support/bit_contains.h"
#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/every_engine.h"

namespace spinaltap {
namespace {

using test::askew_path;
using test::Draw;

struct Sums {
  double mm3 = 0.0, n_mm = 0.0;
  Vec3 n_mm2 = Vec3::Zero();
};

/// Of the points that live in `before` and not in `after`, with places from `tip_mm`.
Sums gone(const PointVolume& before, const PointVolume& after, const Material& material, const Vec3& tip_mm) {
  Sums sums;
  for (int disc = 0; disc < before.disc_count(); ++disc) {
    for (std::size_t i = 0; i < before.pattern().point_count(); ++i) {
      if (!before.is_occupied(disc, i) || after.is_occupied(disc, i)) continue;
      const double mm3 = before.pattern().point_volume_mm3(DiscPattern::ring_of(i));
      const double n_mm = mm3 * material.cutting_energy_mpa(before.hu(disc, i));
      sums.mm3 += mm3;
      sums.n_mm += n_mm;
      sums.n_mm2 += n_mm * (before.frame().to_patient(before.point_in_path_mm(disc, i)) - tip_mm);
    }
  }
  return sums;
}

void fill_from(PointVolume& volume, std::uint64_t seed) {
  Draw draw(seed);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) volume.set_hu(disc, i, draw(-200.0, 1800.0));
  }
}

class StepResults : public ::testing::TestWithParam<test::NamedEngine> {};

INSTANTIATE_TEST_SUITE_P(Engines, StepResults, ::testing::ValuesIn(test::every_engine()),
                         [](const auto& engine) { return engine.param.name; });

TEST_P(StepResults, AreVolumeWorkAndMomentOfThePointsThatAreGone) {
  const Material material;
  for (const PointVolumeOptions& options :
       {PointVolumeOptions{.radius_mm = 2.0, .spacing_mm = 0.2},
        PointVolumeOptions{.radius_mm = 2.0, .spacing_mm = 0.2, .jitter = 0.4},
        PointVolumeOptions{.radius_mm = 2.0, .spacing_mm = 0.2, .subdivision = DiscSubdivision::hexagons}}) {
    PointVolume volume(askew_path(5.0), options);
    fill_from(volume, 7);
    const auto engine = GetParam().make(volume, {1.6, 10.0, 1.0}, material);
    Draw draw(11);
    double work_n_mm = 0.0;
    for (int step = 0; step < 40; ++step) {
      // In braces: compilers agree on the order of the draws.
      const Vec3 tip_path{draw(-0.8, 0.8), draw(-0.8, 0.8), draw(0.0, 4.0)};
      const Pose pose = test::pose_at(volume, tip_path, Vec3{draw(-0.2, 0.2), draw(-0.2, 0.2), 1.0});
      const PointVolume before = volume;
      const StepResult result = engine->step(pose);
      const Sums expected = gone(before, volume, material, pose.tip_mm);
      work_n_mm += result.work_n_mm;
      EXPECT_NEAR(result.removed_mm3, expected.mm3, 1e-12 + 1e-9 * expected.mm3);
      // Pressures are whole units of 0.001 N/mm²: off by half of one at most.
      EXPECT_NEAR(result.work_n_mm, expected.n_mm, 1e-12 + 1e-9 * expected.n_mm + 0.0005 * expected.mm3);
      // Places are whole sixteenths of a spacing, off by half of one along each axis at most.
      const double off_mm = std::sqrt(3.0) * 0.2 / 32.0;
      EXPECT_LE((result.moment_n_mm2 - expected.n_mm2).norm(), (off_mm + 1e-3) * expected.n_mm + 1e-12);
    }
    EXPECT_GT(work_n_mm, 1000.0);
  }
}

TEST_P(StepResults, OfABitThatTurnsTellHowFarBackItCut) {
  const Material material;
  const DrillBit bit{1.6, 8.0, 1.0};
  for (const double jitter : {0.0, 0.4}) {
    PointVolume volume(askew_path(7.0), {.radius_mm = 2.0, .spacing_mm = 0.2, .jitter = jitter});
    fill_from(volume, 5);
    const auto engine = GetParam().make(volume, bit, material);
    Draw draw(13);
    Vec3 axis_before = Vec3::Zero();
    int turns = 0;
    for (int step = 0; step < 30; ++step) {
      // In braces: compilers agree on the order of the draws.
      const Vec3 tip_path{draw(-0.5, 0.5), draw(-0.5, 0.5), draw(3.0, 6.5)};
      const bool turns_now = step % 3 != 2;
      const Vec3 aside{draw(-0.2, 0.2), draw(-0.2, 0.2), 1.0};
      Pose pose = test::pose_at(volume, tip_path, aside);
      if (!turns_now) pose.axis = axis_before;
      axis_before = pose.axis;
      const PointVolume before = volume;
      const StepResult result = engine->step(pose);
      double sum = 0.0;
      for (const double part : result.work_back_n_mm) sum += part;
      if (step == 0 || !turns_now) {
        EXPECT_EQ(sum, 0.0);
        continue;
      }
      ++turns;
      EXPECT_NEAR(sum, result.work_n_mm, 1e-9 * sum);
      // Places are rounded to sixteenths of a spacing, the axis to 1 / 1024: points so near to where a part ends may
      // count on either side of it.
      const double off_mm = std::sqrt(3.0) * 0.2 / 32.0 + 10.0 / 1024.0;
      // Pressures are whole units of 0.001 N/mm².
      constexpr double kUnitMpa = 0.0005;
      std::array<double, StepResult::kBackParts> least{}, most{};
      for (int disc = 0; disc < before.disc_count(); ++disc) {
        for (std::size_t i = 0; i < before.pattern().point_count(); ++i) {
          if (!before.is_occupied(disc, i) || volume.is_occupied(disc, i)) continue;
          const double mm3 = before.pattern().point_volume_mm3(DiscPattern::ring_of(i));
          const double mpa = material.cutting_energy_mpa(before.hu(disc, i));
          const Vec3 p = before.frame().to_patient(before.point_in_path_mm(disc, i));
          const double back_mm = -(p - pose.tip_mm).dot(pose.axis);
          const auto part_at = [&](double mm) {
            return static_cast<std::size_t>(std::clamp(std::floor(mm / bit.length_mm * 16.0), 0.0, 15.0));
          };
          const std::size_t low = part_at(back_mm - off_mm), high = part_at(back_mm + off_mm);
          if (low == high) least[low] += mm3 * (mpa - kUnitMpa);
          for (std::size_t part = low; part <= high; ++part) most[part] += mm3 * (mpa + kUnitMpa);
        }
      }
      for (std::size_t part = 0; part < least.size(); ++part) {
        EXPECT_GE(result.work_back_n_mm[part], least[part] - 1e-9) << part;
        EXPECT_LE(result.work_back_n_mm[part], most[part] + 1e-9) << part;
      }
    }
    EXPECT_GT(turns, 15);
  }
}

TEST_P(StepResults, AddUpOverVolumesEndToEnd) {
  const Material material;
  std::vector<PointVolume> volumes =
      make_segments(askew_path(4.0), {{0.0, 2.0, 0.2}, {2.0, 4.0, 0.1}}, {.radius_mm = 2.0});
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume& volume : volumes) {
    fill_from(volume, 3);
    engines.push_back(GetParam().make(volume, {1.6, 10.0, 1.0}, material));
  }
  const auto joint = make_joint_engine(std::move(engines));
  for (const double depth_mm : {0.5, 1.7, 2.4, 3.5}) {
    const Pose pose = test::pose_at(volumes[0], Vec3(0.1, 0.2, depth_mm));
    const std::vector<PointVolume> before = volumes;
    const StepResult result = joint->step(pose);
    Sums expected;
    for (std::size_t n = 0; n < volumes.size(); ++n) {
      const Sums part = gone(before[n], volumes[n], material, pose.tip_mm);
      expected.mm3 += part.mm3;
      expected.n_mm += part.n_mm;
      expected.n_mm2 += part.n_mm2;
    }
    ASSERT_GT(expected.n_mm, 0.0);
    EXPECT_NEAR(result.removed_mm3, expected.mm3, 1e-9 * expected.mm3);
    EXPECT_NEAR(result.work_n_mm, expected.n_mm, 1e-4 * expected.n_mm);
    EXPECT_LE((result.moment_n_mm2 - expected.n_mm2).norm(), 0.012 * expected.n_mm);
  }
}

TEST_P(StepResults, OfABitWhoseMotionIsResetAreThoseOfItsNewPlaceAlone) {
  const DrillBit bit{1.6, 3.0, 1.0};
  PointVolume volume(askew_path(5.0), {.radius_mm = 2.0, .spacing_mm = 0.2});
  const auto engine = GetParam().make(volume, bit, {});
  const Pose first = test::pose_at(volume, Vec3(-1.0, 0.0, 4.0));
  engine->step(first);
  engine->reset_motion();
  const Pose there = test::pose_at(volume, Vec3(1.2, 0.0, 4.0));
  engine->step(there);
  // Nothing died between both places.
  const BitProfile profile(bit);
  int between = 0;
  for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
    const Vec3 p = volume.frame().to_patient(volume.point_in_path_mm(10, i));
    const bool is_held = test::bit_contains(profile, there, p) || test::bit_contains(profile, first, p);
    const double from_walls_mm =
        std::min(std::abs(bit_distance_mm(profile, there, p)), std::abs(bit_distance_mm(profile, first, p)));
    if (from_walls_mm > 1e-5) {  // engines' bits are larger by a skin
      EXPECT_EQ(volume.is_occupied(10, i), !is_held);
    }
    if (std::abs(volume.pattern().point_mm(i).x() - 0.1) < 0.15 && !is_held) ++between;
  }
  EXPECT_GT(between, 10);
}

}  // namespace
}  // namespace spinaltap
