#include "core/grading/grade.h"
#include "core/force/cutting_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/anatomy/landmarks.h"
#include "core/base/error.h"
#include "tests/support/nan.h"
#include "tests/support/planning_bones.h"

namespace spinaltap {
namespace {

using test::kNan;

constexpr double kGradeToleranceMm = 0.02;
constexpr double kScrewRadiusMm = 3.0;

void hu_of_300(std::span<const Vec3>, std::span<float> hu) { std::fill(hu.begin(), hu.end(), 300.0F); }

class GradePath : public ::testing::Test {
 protected:
  static const WallDistance& walls() {
    static const test::Block block;
    static const WallDistance walls(block.bone(), block.landmarks());
    return walls;
  }

  /// From the block's back straight forward at x and z, to y.
  static DrillPath path(double x_mm, double z_mm = 0.0, double to_y_mm = -12.0) {
    DrillPath path{"", Vec3(x_mm, test::Block::kHalfDepthMm, z_mm), Vec3(x_mm, to_y_mm, z_mm), {}};
    path.screw = PedicleScrew{"", 2.0 * kScrewRadiusMm, 45.0, 4.0};
    return path;
  }

  static PathGrade grade(const DrillPath& path, const GradeOptions& options = {}) {
    return grade_path(walls(), hu_of_300, Material(), path, options);
  }
};

TEST(GertzbeinRobbins, ChangesAtExactly2And4And6Mm) {
  const double less = 1.0 - 1e-12;
  EXPECT_EQ(gertzbein_robbins(0.0), Grade::A);
  EXPECT_EQ(gertzbein_robbins(1e-9), Grade::B);
  EXPECT_EQ(gertzbein_robbins(2.0 * less), Grade::B);
  EXPECT_EQ(gertzbein_robbins(2.0), Grade::C);
  EXPECT_EQ(gertzbein_robbins(4.0 * less), Grade::C);
  EXPECT_EQ(gertzbein_robbins(4.0), Grade::D);
  EXPECT_EQ(gertzbein_robbins(6.0 * less), Grade::D);
  EXPECT_EQ(gertzbein_robbins(6.0), Grade::E);
  EXPECT_EQ(gertzbein_robbins(100.0), Grade::E);
  EXPECT_EQ(letter_of(Grade::A), 'A');
  EXPECT_EQ(letter_of(Grade::E), 'E');
}

TEST(GertzbeinRobbins, RejectsBreachesThatAreNegativeOrNoNumber) {
  EXPECT_THROW(gertzbein_robbins(-1e-9), Error);
  EXPECT_THROW(gertzbein_robbins(kNan), Error);
}

TEST_F(GradePath, FollowsTheProtrusionThroughAFlatWall) {
  const std::vector<std::pair<double, Grade>> cases{{-0.1, Grade::A}, {0.1, Grade::B}, {1.9, Grade::B},
                                                    {2.1, Grade::C},  {3.9, Grade::C}, {4.1, Grade::D},
                                                    {5.9, Grade::D},  {6.1, Grade::E}};
  for (const double side : {1.0, -1.0}) {
    for (const auto& [breach_mm, expected] : cases) {
      const PathGrade graded = grade(path(side * (test::Block::kHalfWidthMm - kScrewRadiusMm + breach_mm)));
      EXPECT_EQ(graded.grade, expected) << breach_mm;
      EXPECT_NEAR(graded.breach_mm, std::max(0.0, breach_mm), kGradeToleranceMm);
      EXPECT_NEAR(graded.outer.clearance_mm, -breach_mm, kGradeToleranceMm);
      EXPECT_EQ(graded.outer.side, PathSide::lateral);
      EXPECT_EQ(graded.is_left, side > 0.0);
      if (breach_mm > 0.0) {
        EXPECT_EQ(graded.breach_side, PathSide::lateral);
        EXPECT_FALSE(graded.breaches_canal);
      }
    }
  }
}

TEST_F(GradePath, TellsHowAScrewHoldsByTheBoneItIsInAndNothingOfABit) {
  DrillPath screwed = path(25.0);
  DrillPath bare = screwed;
  bare.screw.reset();
  EXPECT_FALSE(grade(bare).fixation);
  const std::optional<ScrewFixation> fixation = grade(screwed).fixation;
  ASSERT_TRUE(fixation);
  // All of its thread in the block: Chapman's formula.
  const double g_cm3 = Material().density.density_g_cm3(300.0);
  const double diameter_mm = 2.0 * kScrewRadiusMm, thread_mm = screwed.length_mm() - 4.0;
  const ScrewThread thread = usual_thread(diameter_mm);
  const double by_hand_n = 51.6 * std::pow(g_cm3 / 1.9, 1.7) * thread_mm * std::numbers::pi * diameter_mm *
                           (0.5 + 0.57735 * thread.depth_mm(diameter_mm) / thread.pitch_mm);
  EXPECT_NEAR(fixation->engaged_mm, thread_mm, 1e-6);
  EXPECT_NEAR(fixation->pullout_n.median / by_hand_n, 1.0, 0.02);
  // Its axis in the block's side: half the hold, though the sampler tells of bone there, too.
  screwed.entry_mm.x() = screwed.target_mm.x() = test::Block::kHalfWidthMm;
  EXPECT_NEAR(grade(screwed).fixation->pullout_n.median / by_hand_n, 0.5, 0.05);
}

TEST_F(GradePath, NamesTheSideOfTheNearestApproachOnLeftAndRight) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(grade(path(side * 25.0)).outer.side, PathSide::lateral);
    EXPECT_EQ(grade(path(side * 19.0, 13.0)).outer.side, PathSide::cranial);
    EXPECT_EQ(grade(path(side * 19.0, -13.0)).outer.side, PathSide::caudal);
    EXPECT_EQ(grade(path(side * 19.0, 0.0, -19.0)).outer.side, PathSide::anterior);
    EXPECT_EQ(grade(path(side * 19.0)).canal.side, PathSide::medial);
    const PathGrade into_canal = grade(path(side * 9.5));
    EXPECT_EQ(into_canal.canal.side, PathSide::medial);
    EXPECT_EQ(into_canal.breach_side, PathSide::medial);
    EXPECT_EQ(grade(path(side * 19.0, 16.0)).breach_side, PathSide::cranial);
    EXPECT_EQ(grade(path(side * 19.0, -16.0)).breach_side, PathSide::caudal);
  }
}

TEST_F(GradePath, NamesSidesInTheVertebrasOwnFrame) {
  // A vertebra that lies on its left side: its top is the block's +x.
  Landmarks lying = walls().landmarks();
  lying.axes.col(0) = -Vec3::UnitZ();
  lying.axes.col(2) = Vec3::UnitX();
  const WallDistance turned(walls().bone(), lying);
  const PathGrade graded = grade_path(turned, hu_of_300, Material(), path(26.0));
  EXPECT_EQ(graded.outer.side, PathSide::cranial);
  EXPECT_EQ(graded.canal.side, PathSide::caudal);
}

TEST_F(GradePath, KnowsClearanceAndDepthOfTheNearestApproach) {
  const PathGrade graded = grade(path(18.0));
  EXPECT_NEAR(graded.canal.clearance_mm, 18.0 - 8.0 - kScrewRadiusMm, kGradeToleranceMm);
  EXPECT_NEAR(graded.canal.depth_mm, 20.0, 1.5);
  EXPECT_EQ(graded.grade, Grade::A);
  EXPECT_EQ(graded.breach_mm, 0.0);
  for (const GradeRow& row : graded.rows) {
    const double y_mm = 20.0 - row.depth_mm;
    EXPECT_NEAR(row.canal_mm, std::hypot(18.0, y_mm) - 8.0 - row.radius_mm, kGradeToleranceMm);
    // Of the section: walls beside it are nearer than to its middle, those behind and ahead are not. From 3 mm on a
    // bound by the middle stands for both.
    const double beside_mm = 12.0 - row.radius_mm;
    const double along_mm = std::min(row.depth_mm, y_mm + 20.0);
    const double bound_mm = std::min(beside_mm, along_mm - row.radius_mm);
    if (row.depth_mm == 0.0 || std::abs(bound_mm - 3.0) < 0.1) continue;  // in the surface; between the two
    const double outer_mm = bound_mm > 3.0 ? bound_mm : std::min(beside_mm, along_mm);
    EXPECT_NEAR(row.outer_mm, outer_mm, kGradeToleranceMm) << row.depth_mm;
  }
  EXPECT_EQ(graded.rows.front().depth_mm, 0.0);
  EXPECT_DOUBLE_EQ(graded.rows.back().depth_mm, 32.0);
  EXPECT_EQ(graded.rows.back().radius_mm, 0.0);
}

TEST_F(GradePath, DoesNotCountTheEntryOpening) {
  // Straight and slanting, from the surface, from 5 mm before it, and from 1 mm below it.
  for (const double slant_mm : {0.0, 12.0}) {
    for (const double before_mm : {0.0, 5.0, -1.0}) {
      DrillPath slanting = path(20.0, -0.5 * slant_mm);
      slanting.target_mm.z() = 0.5 * slant_mm;
      slanting.entry_mm -= before_mm * slanting.direction();
      const PathGrade graded = grade(slanting);
      EXPECT_EQ(graded.grade, Grade::A) << slant_mm << " " << before_mm;
      EXPECT_GT(graded.outer.clearance_mm, 4.0) << slant_mm << " " << before_mm;
      EXPECT_TRUE(graded.rows.front().is_entry);
      EXPECT_FALSE(graded.rows.back().is_entry);
      EXPECT_LE(graded.entry_end_mm, 16.5 + before_mm + 1.0);
    }
  }
}

TEST_F(GradePath, EndsTheEntryOpeningBeforeTheIsthmusAtTheLatest) {
  // Along the side wall the section is never whole in bone: what sticks out counts from 4 mm before the isthmus on.
  const PathGrade graded = grade(path(29.0));
  EXPECT_NEAR(graded.entry_end_mm, 16.0, 0.25);
  EXPECT_EQ(graded.grade, Grade::C);
  for (const GradeRow& row : graded.rows) EXPECT_EQ(row.is_entry, row.depth_mm < 16.0);
}

TEST_F(GradePath, CountsTheCanalInTheEntryOpeningToo) {
  Landmarks far_ahead = walls().landmarks();
  far_ahead.left_pedicle.isthmus_mm.y() = -60.0;
  far_ahead.right_pedicle.isthmus_mm.y() = -60.0;
  const WallDistance moved(walls().bone(), far_ahead);
  DrillPath wide = path(18.5);
  wide.screw->diameter_mm = 24.0;
  const PathGrade graded = grade_path(moved, hu_of_300, Material(), wide);
  EXPECT_TRUE(graded.rows[graded.rows.size() / 2].is_entry);
  EXPECT_NEAR(graded.breach_mm, 1.5, kGradeToleranceMm);
  EXPECT_TRUE(graded.breaches_canal);
  EXPECT_EQ(graded.breach_side, PathSide::medial);
}

TEST_F(GradePath, CountsAndNamesATipThatGoesOutInFront) {
  const PathGrade graded = grade(path(18.0, 0.0, -22.5));
  EXPECT_EQ(graded.grade, Grade::C);
  EXPECT_NEAR(graded.breach_mm, 2.5, kGradeToleranceMm);
  EXPECT_NEAR(graded.breach_depth_mm, 42.5, 1e-9);
  EXPECT_EQ(graded.breach_side, PathSide::anterior);
  EXPECT_FALSE(graded.breaches_canal);
  EXPECT_EQ(graded.outer.side, PathSide::anterior);
  EXPECT_LT(graded.outer.clearance_mm, 0.0);
}

TEST_F(GradePath, CountsAPathThroughTheCanal) {
  DrillPath across{"", Vec3(12.0, 20.0, 0.0), Vec3(-6.0, -16.0, 0.0), {}};
  const PathGrade graded = grade(across);
  EXPECT_EQ(graded.grade, Grade::E);
  EXPECT_TRUE(graded.breaches_canal);
  EXPECT_LT(graded.canal.clearance_mm, -graded.breach_mm + kGradeToleranceMm);
}

TEST_F(GradePath, GradesAPathThatNeverMeetsBoneByHowFarItIs) {
  const PathGrade graded = grade(path(40.0));
  EXPECT_EQ(graded.grade, Grade::E);
  EXPECT_NEAR(graded.breach_mm, 13.0, kGradeToleranceMm);
  EXPECT_EQ(graded.breach_side, PathSide::lateral);
  EXPECT_TRUE(std::isnan(graded.hu));
  EXPECT_EQ(graded.max_thrust_n, 0.0);
  for (const double share : graded.hu_band_shares) EXPECT_EQ(share, 0.0);
}

TEST_F(GradePath, IgnoresWhatStandsOutBehindTheEntry) {
  DrillPath longer = path(24.0);
  longer.screw->length_mm = 100.0;
  const PathGrade graded = grade(longer);
  EXPECT_EQ(graded.grade, Grade::A);
  EXPECT_NEAR(graded.outer.clearance_mm, grade(path(24.0)).outer.clearance_mm, 1e-12);
}

TEST_F(GradePath, TakesTheBitWhereThePathHasNoScrew) {
  DrillPath drilled = path(25.0);
  drilled.bit.diameter_mm = 2.0;
  EXPECT_NEAR(grade(drilled).outer.clearance_mm, 5.0 - kScrewRadiusMm, kGradeToleranceMm);
  drilled.screw.reset();
  EXPECT_NEAR(grade(drilled).outer.clearance_mm, 5.0 - 1.0, kGradeToleranceMm);
}

TEST_F(GradePath, TakesTheHoleBehindABurrAsWideAsItsHead) {
  DrillPath burred = path(25.0);
  burred.screw.reset();
  burred.bit = {4.0, 50.0, 1.0, BitShape::round_burr};
  burred.bit.shank_diameter_mm = 2.0;
  EXPECT_EQ(grade(burred).rows.front().radius_mm, 2.0);
}

TEST_F(GradePath, WeighsCtNumbersByTheToolsVolumeInBone) {
  const HuSampler two_parts = [](std::span<const Vec3> points_mm, std::span<float> hu) {
    for (std::size_t n = 0; n < hu.size(); ++n) hu[n] = points_mm[n].y() > 0.0 ? 100.0F : 500.0F;
  };
  const PathGrade graded = grade_path(walls(), two_parts, Material(), path(18.0, 0.0, -10.0));
  // 20 mm of the cylinder behind, 6 mm and a cone of 4 mm in front.
  const double front = 6.0 + 4.0 / 3.0;
  const double share = front / (20.0 + front);
  // Half a step of 27 mm is lost at the surface, and half a step at the parts' border.
  ASSERT_EQ(graded.hu_band_shares.size(), 3U);
  EXPECT_NEAR(graded.hu_band_shares[0], 1.0 - share, 0.012);
  EXPECT_EQ(graded.hu_band_shares[1], 0.0);
  EXPECT_NEAR(graded.hu_band_shares[2], share, 0.012);
  EXPECT_NEAR(graded.hu, 100.0 + 400.0 * share, 5.0);
  for (const GradeRow& row : graded.rows) {
    if (row.depth_mm > 0.0) {
      EXPECT_NEAR(row.hu, row.depth_mm < 20.0 ? 100.0 : 500.0, 1e-3) << row.depth_mm;
      const bool is_behind = row.depth_mm < 20.0;
      EXPECT_EQ(row.hu_band_shares, (std::vector<double>{is_behind ? 1.0 : 0.0, 0.0, is_behind ? 0.0 : 1.0}))
          << row.depth_mm;
    }
  }
}

TEST_F(GradePath, CountsABandFromItsLowerBorderOn) {
  const HuSampler at_border = [](std::span<const Vec3>, std::span<float> hu) {
    std::fill(hu.begin(), hu.end(), 375.0F);
  };
  EXPECT_DOUBLE_EQ(grade_path(walls(), at_border, Material(), path(18.0)).hu_band_shares[2], 1.0);
}

TEST_F(GradePath, PredictsTheThrustOfTheBitAndLessWhileItsTipEnters) {
  const DrillPath planned = path(18.0);
  const GradeOptions options;
  const double feed_mm = options.feed_mm_s * 60.0 / options.spindle.rpm;
  CuttingResistance block = resistance_of_block(planned.bit, Material(), 300.0);
  const double full_n = block.thrust_n(feed_mm);
  const double lips_n = full_n - block.chisel_n;
  ASSERT_GT(lips_n, 0.1 * full_n);
  // The screw is twice as wide as its hole; that is not what is drilled.
  ASSERT_GT(planned.screw->diameter_mm, 1.9 * planned.bit.diameter_mm);
  const PathGrade graded = grade(planned);
  for (const GradeRow& row : graded.rows) {
    if (row.depth_mm == 0.0) continue;  // the chisel edge is at the surface
    // The lips cut the square of the share of their cone that is in; four annuli make that four steps.
    const double in = std::min(1.0, row.depth_mm / planned.bit.tip_length_mm);
    EXPECT_NEAR((row.thrust_n - block.chisel_n) / lips_n, in * in, in < 1.0 ? 0.25 : 1e-3) << row.depth_mm;
  }
  EXPECT_NEAR(graded.max_thrust_n, full_n, 1e-3 * full_n);
}

TEST_F(GradePath, PredictsMoreThrustAtAFasterFeedAndASlowerSpindle) {
  GradeOptions faster;
  faster.feed_mm_s = 2.0;
  GradeOptions slower_spindle;
  slower_spindle.spindle.rpm = 625.0;
  const double usual_n = grade(path(18.0)).max_thrust_n;
  EXPECT_GT(grade(path(18.0), faster).max_thrust_n, 1.1 * usual_n);
  // What counts is the feed per turn.
  EXPECT_NEAR(grade(path(18.0), slower_spindle).max_thrust_n, grade(path(18.0), faster).max_thrust_n, 1e-9);
}

TEST_F(GradePath, FindsNoBreachDeeperThanTheNearestApproachAllows) {
  // A place of the tool is beyond a wall by at most what its section's middle lacks.
  for (const double x_mm : {6.0, 8.5, 10.0, 26.0, 28.0, 31.0}) {
    for (const double lean_mm : {-4.0, 5.0}) {
      DrillPath leaning = path(x_mm);
      leaning.target_mm.x() += lean_mm;
      const PathGrade graded = grade(leaning);
      const double nearest_mm = std::min(graded.outer.clearance_mm, graded.canal.clearance_mm);
      EXPECT_LE(graded.breach_mm, std::max(0.0, -nearest_mm) + kGradeToleranceMm);
    }
  }
}

TEST_F(GradePath, FindsTheSameBreachAsAllPlacesOfTheTool) {
  for (const double x_mm : {9.0, 12.0, 26.5}) {
    DrillPath leaning = path(x_mm);
    leaning.target_mm += Vec3(2.0, 0.0, 1.0);
    const PathGrade graded = grade(leaning);
    double max_mm = 0.0;
    const Vec3 axis = leaning.direction();
    const Vec3 first = any_perpendicular(axis);
    for (const GradeRow& row : graded.rows) {
      for (int n = 0; n < 360; ++n) {
        const double angle = n * std::numbers::pi / 180.0;
        const Vec3 p_mm = leaning.entry_mm + row.depth_mm * axis +
                          row.radius_mm * (std::cos(angle) * first + std::sin(angle) * axis.cross(first));
        const bool is_in_canal = std::hypot(p_mm.x(), p_mm.y()) < test::Block::kHoleMm;
        if (row.is_entry && !is_in_canal) continue;
        max_mm = std::max(max_mm, is_in_canal ? test::Block::kHoleMm - std::hypot(p_mm.x(), p_mm.y())
                                              : std::abs(p_mm.x()) - test::Block::kHalfWidthMm);
      }
    }
    EXPECT_NEAR(graded.breach_mm, max_mm, 0.03) << x_mm;  // 48 places of a ring: 3 mm (1 - cos 3.75 degrees)
  }
}

TEST_F(GradePath, RejectsWhatMakesNoSense) {
  const auto rejects = [](const DrillPath& bad, const GradeOptions& options = {}, const HuSampler& hu = hu_of_300,
                          const Material& material = {}) {
    EXPECT_THROW(grade_path(walls(), hu, material, bad, options), Error);
  };
  DrillPath bad = path(18.0);
  bad.target_mm.x() = kNan;
  rejects(bad);
  bad = path(18.0);
  bad.target_mm = bad.entry_mm;
  rejects(bad);
  bad = path(18.0);
  bad.screw->diameter_mm = kNan;
  rejects(bad);
  for (const double step_mm : {0.0, -1.0, kNan, 1e-9}) rejects(path(18.0), {.step_mm = step_mm});
  rejects(path(18.0), {.hu_bands = {375.0, 135.0}});
  rejects(path(18.0), {.hu_bands = {135.0, 135.0}});
  rejects(path(18.0), {.hu_bands = {kNan}});
  rejects(path(18.0), {.ring_points = 3});
  for (const double number : {kNan, 0.0, -1.0, 1e9}) {
    rejects(path(18.0), {.spindle = {.rpm = number}});
    rejects(path(18.0), {.feed_mm_s = number});
  }
  rejects(path(18.0), {}, HuSampler());
  Material material;
  material.cutting_exponent = kNan;
  rejects(path(18.0), {}, hu_of_300, material);
  EXPECT_EQ(grade(path(18.0), {.hu_bands = {}}).hu_band_shares, std::vector<double>{1.0});
}

TEST_F(GradePath, RejectsAPlateByName) {
  DrillPath cut = path(18.0);
  cut.bit = plate_bit(10.0, 1.0, 40.0);
  const auto is_named = testing::ThrowsMessage<Error>(testing::HasSubstr("for a grade, found a plate"));
  EXPECT_THAT([&] { grade(cut); }, is_named);
  cut.screw.reset();
  EXPECT_THAT([&] { grade(cut); }, is_named);
  EXPECT_THAT([&] { breach_mm(walls(), cut); }, is_named);
}

TEST(GradePhantom, FindsItsOwnPathsSafeAndTheirPediclesWallsNearest) {
  const test::PhantomBone phantom;
  const WallDistance walls(phantom.bone, phantom.landmarks);
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(*phantom.vertebra);
  for (const PedicleGroundTruth& pedicle : {ground_truth.left, ground_truth.right}) {
    DrillPath path{"", pedicle.entry_mm, pedicle.target_mm, {}};
    path.screw = PedicleScrew{"", 6.5, 45.0, 4.0};
    const PathGrade graded = grade_path(walls, hu_of_300, Material(), path);
    EXPECT_EQ(graded.grade, Grade::A);
    EXPECT_EQ(graded.is_left, pedicle.isthmus_mm.x() > 0.0);
    // The isthmus is 9 mm wide: 4.5 - 3.25 mm is left on both sides.
    EXPECT_NEAR(graded.outer.clearance_mm, 1.25, 0.1);
    EXPECT_EQ(graded.outer.side, PathSide::lateral);
    EXPECT_NEAR(graded.canal.clearance_mm, 1.25, 0.1);
    EXPECT_EQ(graded.canal.side, PathSide::medial);
    // 2 mm further in, the screw stands 0.75 mm in the canal.
    const Vec3 inward_mm = -2.0 * (pedicle.isthmus_mm.x() > 0.0 ? 1.0 : -1.0) * Vec3::UnitX();
    path.entry_mm += inward_mm;
    path.target_mm += inward_mm;
    const PathGrade shifted = grade_path(walls, hu_of_300, Material(), path);
    EXPECT_EQ(shifted.grade, Grade::B);
    EXPECT_NEAR(shifted.breach_mm, 0.75, 0.15);
    EXPECT_TRUE(shifted.breaches_canal);
    EXPECT_EQ(shifted.breach_side, PathSide::medial);
  }
}

}  // namespace
}  // namespace spinaltap
