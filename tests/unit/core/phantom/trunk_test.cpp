#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/phantom/random_trunk.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

double value_in_trunk(const Spine& spine, const Vec3& p) {
  double value = 0.0;
  spine.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

TEST(Trunk, IsTheSameOfTheSameSeedAndAnotherOfAnother) {
  int differ = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TrunkOptions a = random_trunk_options(seed), b = random_trunk_options(seed);
    EXPECT_EQ(describe(a), describe(b));
    EXPECT_EQ(a.scan.slices, b.scan.slices);
    const Spine one(a.spine), same(b.spine);
    for (int n = 0; n < 50; ++n) {
      const Vec3 p = one.bounds_mm().min() + 0.02 * n * one.bounds_mm().sizes();
      ASSERT_EQ(value_in_trunk(one, p), value_in_trunk(same, p));
    }
    differ += describe(a) == describe(random_trunk_options(seed + 100)) ? 0 : 1;
  }
  EXPECT_EQ(differ, 10);
}

TEST(Trunk, CanBeMadeOfEverySeedWithProbabilitiesAsAskedFor) {
  int necks = 0, crushed = 0, filled = 0, thin = 0, thick = 0;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TrunkOptions options = random_trunk_options(seed);
    const ScanOptions& scan = options.scan;
    // Levels two above the view's are made.
    necks += level_rank(options.spine.first) < level_rank(Level{6}) ? 1 : 0;
    crushed += options.spine.crushed.empty() ? 0 : 1;
    filled += options.spine.cement.empty() && options.spine.screws.empty() ? 0 : 1;
    thin += scan.slice_step_mm < 1.0 ? 1 : 0;
    thick += scan.slice_step_mm > 3.0 ? 1 : 0;
    EXPECT_GE(scan.slice_step_mm, 0.5);
    EXPECT_LE(scan.slice_step_mm, 5.0);
    EXPECT_LT(static_cast<double>(scan.columns) * scan.rows * scan.slices, 3e7);
  }
  // Within three standard deviations of 25 %, a little below 25 % (necks are not crushed), 15 %, 12 % and 22 %.
  EXPECT_NEAR(necks, 50, 19);
  EXPECT_NEAR(crushed, 44, 19);
  EXPECT_NEAR(filled, 28, 16);
  EXPECT_NEAR(thin, 20, 15);
  EXPECT_NEAR(thick, 44, 19);
}

TEST(Trunk, HasCrushedBodiesAsHighAsAskedForUnderPediclesThatStayExact) {
  SpineOptions options;
  options.first = Level{16};
  options.last = Level{21};
  options.ribs = false;
  options.crushed = {{Level::kT12, 0.4, 0.9}};
  const Spine spine(options);
  options.crushed.clear();
  const Spine sound(options);
  const std::size_t n = spine.part_of(Level::kT12).value();
  const auto height_mm = [&](const Spine& of, double y_share) {
    const PlacedLevel& placed = of.placed()[n];
    const double y = y_share * placed.measures.body_depth_mm;
    // Within the rims, where the endplates are flat.
    double low = 0.0, high = 0.0;
    const auto inside = [&](double z) {
      return of.part_value_mm(n, placed.position_mm + placed.rotation * Vec3(0.0, y, z)) < 0.0;
    };
    while (inside(low - 0.05)) low -= 0.05;
    while (inside(high + 0.05)) high += 0.05;
    return high - low;
  };
  const double front_share = height_mm(spine, -0.4) / height_mm(sound, -0.4);
  // At four fifths of the way to the front: 0.45 between front and back; edges are round.
  EXPECT_NEAR(front_share, 0.45, 0.08);
  EXPECT_EQ(spine_ground_truth(spine).levels[n].pedicles.left.width_mm,
            spine_ground_truth(sound).levels[n].pedicles.left.width_mm);
  // Discs are not wedged by it: the levels above lean forward.
  for (const DiscGroundTruth& disc : spine_ground_truth(spine).discs) EXPECT_LT(disc.height_mm, 12.0);
}

TEST(Trunk, HasAsManyLevelsAsAskedFor) {
  SpineOptions options;
  options.first = Level{18};
  options.last = Level::kL6;
  options.thoracic_levels = 13;
  options.lumbar_levels = 6;
  options.sacrum = options.pelvis = true;
  const Spine spine(options);
  std::string names;
  for (const PlacedLevel& placed : spine.placed()) names += level_name(placed.level) + " ";
  EXPECT_EQ(names, "T11 T12 T13 L1 L2 L3 L4 L5 L6 sacrum ");
  options = {};
  options.thoracic_levels = 11;
  options.lumbar_levels = 4;
  options.first = Level{17};
  options.last = Level{23};
  const Spine fewer(options);
  names.clear();
  for (const PlacedLevel& placed : fewer.placed()) names += level_name(placed.level) + " ";
  EXPECT_EQ(names, "T10 T11 L1 L2 L3 L4 ");
}

TEST(Trunk, HasBonesAroundItThatAreNoLevels) {
  SpineOptions options;
  options.first = Level{23};
  options.sacrum = options.pelvis = true;
  const Spine low(options);
  const Vec3 sacrum = low.placed().back().position_mm;
  const Vec3 head = sacrum + Vec3(88.0, -22.0, -88.0);
  EXPECT_EQ(low.label_at(head), kOtherBoneLabel);
  // The socket's roof is bone, with a gap between.
  EXPECT_EQ(low.label_at(head + Vec3(-8.0, 3.0, 32.0)), kOtherBoneLabel);
  EXPECT_EQ(low.label_at(head + Vec3(0.0, 0.0, 25.0)), 0);
  options = {};
  options.first = Level::kT1;
  options.last = Level{11};
  options.shoulders = true;
  const Spine high(options);
  EXPECT_EQ(high.label_at(high.placed()[1].position_mm + Vec3(-160.0, -4.0, -8.0)), kOtherBoneLabel);
}

TEST(Trunk, HasCementAndAnAortaWithoutContrast) {
  SpineOptions options;
  options.first = Level{20};
  options.last = Level{22};
  options.cement = {Level{21}};
  const Spine spine(options);
  int cement = 0, points = 0;
  const PlacedLevel& l2 = spine.placed()[1];
  for (double x = -12.0; x <= 12.0; x += 2.0) {
    for (double y = -12.0; y <= 8.0; y += 2.0) {
      for (double z = -8.0; z <= 8.0; z += 2.0, ++points) {
        const Vec3 p = l2.position_mm + l2.rotation * Vec3(x, y, z);
        cement += spine.hu(p, value_in_trunk(spine, p), 0.5) > 1500.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(cement, points / 20);
  EXPECT_LT(cement, points);
  TrunkTissueOptions around;
  around.soft.aorta_hu = 42.0;
  const TrunkTissue tissue(spine, around);
  EXPECT_NEAR(tissue.hu(l2.position_mm + Vec3(11.0, -0.5 * l2.measures.body_depth_mm - 13.0, 0.0)), 42.0, 1.0);
  EXPECT_EQ(tissue.hu(l2.position_mm + Vec3(0.0, -260.0, 0.0)), -1000.0);
}

TEST(Trunk, RejectsOptionsWithoutSense) {
  const auto rejection = [](const SpineOptions& options) {
    return test::error_of([&] { const Spine spine(options); });
  };
  SpineOptions options;
  options.pelvis = true;
  EXPECT_NE(rejection(options).find("a pelvis needs a sacrum"), std::string::npos) << rejection(options);
  options = {};
  options.shoulders = true;
  EXPECT_NE(rejection(options).find("shoulders need T2"), std::string::npos) << rejection(options);
  options = {};
  options.last = Level::kL6;
  EXPECT_NE(rejection(options).find("last is L6"), std::string::npos) << rejection(options);
  options = {};
  options.crushed = {{Level::kL1, 0.1, 0.9}};
  EXPECT_NE(rejection(options).find("crushed.front_share"), std::string::npos) << rejection(options);
  options = {};
  options.first = Level{23};
  const Spine spine(options);
  EXPECT_THROW(TrunkTissue(spine, {.gas_share = 2.0}), Error);
}

}  // namespace
}  // namespace spinaltap
