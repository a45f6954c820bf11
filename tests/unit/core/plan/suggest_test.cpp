// Compiled with optimisation: long loops of its own.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/base/error.h"
#include "core/plan/convergence.h"
#include "core/plan/suggest.h"
#include "tests/support/planning_bones.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

void hu_of_200(std::span<const Vec3>, std::span<float> hu) { std::fill(hu.begin(), hu.end(), 200.0F); }

std::vector<PedicleScrew> table() {
  std::vector<PedicleScrew> screws;
  for (const double diameter_mm : {5.0, 6.0, 6.5, 7.0, 8.0}) {
    for (const double length_mm : {35.0, 40.0, 45.0, 50.0}) screws.push_back({"", diameter_mm, length_mm, 4.0});
  }
  return screws;
}

/// A turned and moved phantom by its true surface, and its landmarks as they are found.
class SuggestPaths : public testing::Test {
 protected:
  static const Vertebra& vertebra() {
    VertebraAnatomy anatomy;
    anatomy.placement = {Vec3(12.0, -30.0, 400.0), Vec3(7.0, -5.0, 11.0)};
    static const Vertebra solid(anatomy);
    return solid;
  }
  static const WallDistance& walls() {
    static const BoneShape bone(std::make_shared<const Vertebra>(vertebra().anatomy()), vertebra().bounds_mm(), 0.3);
    static const Landmarks landmarks = find_landmarks(bone);
    static const WallDistance of_bone(bone, landmarks);
    return of_bone;
  }
  static const std::vector<Suggestion>& suggested() {
    static const std::vector<Suggestion> both = suggest_paths(walls(), hu_of_200, {}, table());
    return both;
  }
  static double value_mm(const Vec3& p_mm) {
    double value = 0.0;
    vertebra().evaluate({&p_mm, 1}, {&value, 1}, {});
    return value;
  }
};

SLOW_TESTS("SuggestPaths.*");

TEST_F(SuggestPaths, RunThroughTheIsthmusOfEachSideIntoTheBody) {
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra());
  ASSERT_EQ(suggested().size(), 2U);
  EXPECT_EQ(suggested()[0].side, "left");
  EXPECT_EQ(suggested()[1].side, "right");
  for (std::size_t n = 0; n < 2; ++n) {
    ASSERT_TRUE(suggested()[n].best) << suggested()[n].rejection;
    const SuggestedPath& best = *suggested()[n].best;
    const PedicleGroundTruth& pedicle = n == 0 ? ground_truth.left : ground_truth.right;
    const Vec3 direction = best.path.direction();
    const double way_mm = (pedicle.isthmus_mm - best.path.entry_mm).dot(pedicle.axis) / direction.dot(pedicle.axis);
    const Vec3 off_mm = best.path.entry_mm + way_mm * direction - pedicle.isthmus_mm;
    // A screw of 6.5 in a pedicle of 9.0 by 14.5 mm with 1 mm around it has little choice across.
    EXPECT_LT(std::abs(off_mm.dot(pedicle.width_axis)), 0.5);
    EXPECT_LT(std::abs(off_mm.dot(pedicle.height_axis)), 4.0);
    EXPECT_LT(std::acos(direction.dot(pedicle.axis)) / kDegree, 16.0);
    // Of 9.0 mm 80 % are 7.2 mm, and 7.0 mm with 1 mm to both sides fill them without any room to err.
    EXPECT_GE(best.path.screw->diameter_mm, 6.5);
    EXPECT_LE(best.path.screw->diameter_mm, 7.0);
    EXPECT_NEAR(best.path.length_mm(), best.path.screw->length_mm, 1e-9);
    EXPECT_LT(std::abs(value_mm(best.path.entry_mm)), 0.01) << "the entry is on the bone's surface";
    EXPECT_LT(vertebra().to_own(best.path.target_mm).y(), 5.0) << "the tip is well in the body";
    EXPECT_GT(best.angles.convergence_deg, 0.0);
    EXPECT_LT(best.angles.convergence_deg, 28.0);
    EXPECT_LT(std::abs(best.angles.inclination_deg), 16.0);
  }
}

TEST_F(SuggestPaths, KeepTheirMarginsOfTheTrueSurface) {
  constexpr int kAround = 36;
  for (const Suggestion& suggestion : suggested()) {
    ASSERT_TRUE(suggestion.best);
    const SuggestedPath& best = *suggestion.best;
    EXPECT_EQ(best.grade.grade, Grade::A);
    const Vec3 direction = best.path.direction();
    const Vec3 beside = any_perpendicular(direction);
    const Vec3 above = direction.cross(beside);
    double min_mm = std::numeric_limits<double>::infinity();
    for (double depth_mm = best.grade.entry_end_mm; depth_mm <= best.path.length_mm() - 4.0; depth_mm += 0.2) {
      for (int n = 0; n < kAround; ++n) {
        const double angle = 2.0 * std::numbers::pi * n / kAround;
        const Vec3 out = std::cos(angle) * beside + std::sin(angle) * above;
        min_mm =
            std::min(min_mm, -value_mm(best.path.entry_mm + depth_mm * direction + best.path.screw->radius_mm() * out));
      }
    }
    EXPECT_GT(min_mm, 0.0);
    EXPECT_GT(best.grade.canal.clearance_mm, 0.9);
    // Ahead of the tip there are 5 mm and more.
    for (double ahead_mm = 0.0; ahead_mm < 4.9; ahead_mm += 0.1) {
      EXPECT_LT(value_mm(best.path.target_mm + ahead_mm * direction), 0.0) << ahead_mm;
    }
  }
}

TEST_F(SuggestPaths, WarnWhereTheyConvergeAsNonePublishedForTheLevelDoes) {
  // The phantom's pedicles converge by 12 degrees: much for a T12, little for a T1, and as an L3's do.
  int warned = 0;
  for (const Level level : {Level::kT1, Level::kT12, *level_from_name("L3")}) {
    SuggestOptions options;
    options.level = level;
    const ConvergenceRange range = published_convergence(level).value();
    for (const Suggestion& suggestion : suggest_paths(walls(), hu_of_200, {}, table(), options)) {
      ASSERT_TRUE(suggestion.best);
      const double deg = suggestion.best->angles.convergence_deg;
      const std::vector<Finding>& findings = suggestion.best->grade.findings;
      const auto tells = [](const Finding& finding) {
        return finding.is_warning && finding.words.starts_with("converges by ");
      };
      const auto count = std::count_if(findings.begin(), findings.end(), tells);
      EXPECT_EQ(count, deg < range.low_deg || deg > range.high_deg ? 1 : 0) << level_name(level) << ' ' << deg;
      warned += static_cast<int>(count);
    }
  }
  EXPECT_GT(warned, 0);
  EXPECT_LT(warned, 6);
}

TEST_F(SuggestPaths, OfferForARodNoneThatIsWorseThanTheBest) {
  const auto warnings = [](const SuggestedPath& path) {
    const std::vector<Finding>& findings = path.grade.findings;
    return std::count_if(findings.begin(), findings.end(), [](const Finding& one) { return one.is_warning; });
  };
  std::size_t offered = 0;
  for (const Suggestion& suggestion : suggested()) {
    for (const SuggestedPath& other : suggestion.others) {
      EXPECT_EQ(other.grade.grade, suggestion.best->grade.grade);
      EXPECT_LE(warnings(other), warnings(*suggestion.best));
    }
    offered += suggestion.others.size();
  }
  EXPECT_GT(offered, 0U);
}

TEST_F(SuggestPaths, OfAVertebraThatMirrorsItselfMirrorEachOther) {
  const SuggestedPath& left = *suggested()[0].best;
  const SuggestedPath& right = *suggested()[1].best;
  EXPECT_EQ(left.path.screw->diameter_mm, right.path.screw->diameter_mm);
  EXPECT_EQ(left.path.screw->length_mm, right.path.screw->length_mm);
  EXPECT_NEAR(left.score, right.score, 0.1);
  EXPECT_NEAR(left.angles.convergence_deg, right.angles.convergence_deg, 4.0);
}

TEST_F(SuggestPaths, AreTheSameAtAnyNumberOfThreads) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Suggestion> again = suggest_paths(walls(), hu_of_200, {}, table());
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(again[n].best->path.entry_mm, suggested()[n].best->path.entry_mm);
    EXPECT_EQ(again[n].best->path.target_mm, suggested()[n].best->path.target_mm);
    EXPECT_EQ(again[n].best->score, suggested()[n].best->score);
  }
}

TEST_F(SuggestPaths, GoIntoTheDenserBoneWhereThatIsWorthMost) {
  SuggestOptions options;
  options.weights = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
  const auto mean_height = [&](double sign) {
    const HuSampler denser_to_one_end = [&](std::span<const Vec3> points_mm, std::span<float> hu) {
      for (std::size_t n = 0; n < hu.size(); ++n) {
        hu[n] = static_cast<float>(150.0 + 10.0 * sign * vertebra().to_own(points_mm[n]).z());
      }
    };
    const Suggestion left = suggest_paths(walls(), denser_to_one_end, {}, table(), options)[0];
    const DrillPath& path = left.best.value().path;
    return vertebra().to_own(0.5 * (path.entry_mm + path.target_mm)).z();
  };
  EXPECT_GT(mean_height(1.0), mean_height(-1.0) + 1.0);
}

TEST_F(SuggestPaths, SayWhyThereIsNone) {
  SuggestOptions wide;
  wide.margin_mm = wide.min_margin_mm = 3.0;
  const std::vector<Suggestion> none = suggest_paths(walls(), hu_of_200, {}, table(), wide);
  for (const Suggestion& suggestion : none) {
    EXPECT_FALSE(suggestion.best);
    EXPECT_NE(suggestion.rejection.find("3 mm of bone"), std::string::npos) << suggestion.rejection;
    EXPECT_NE(suggestion.rejection.find(suggestion.side), std::string::npos) << suggestion.rejection;
  }
}

TEST_F(SuggestPaths, SayWhyAThinScrewIsNoThicker) {
  // In a pedicle of 9 mm, half filled.
  const auto reasons_of = [&](const std::vector<PedicleScrew>& screws) {
    std::string all;
    for (const Suggestion& suggestion : suggest_paths(walls(), hu_of_200, {}, screws)) {
      for (const std::string& reason : suggestion.best.value().reasons) all += reason + "\n";
    }
    return all;
  };
  const std::string wide = reasons_of({{"", 4.5, 40.0, 4.0}, {"", 7.6, 40.0, 4.0}});
  EXPECT_NE(wide.find("a screw of 7.6 x 40 mm on this way would leave 0."), std::string::npos) << wide;
  EXPECT_NE(wide.find("and 1 mm are looked for"), std::string::npos) << wide;
  const std::string wider = reasons_of({{"", 4.5, 40.0, 4.0}, {"", 10.5, 40.0, 4.0}});
  EXPECT_NE(wider.find("a screw of 10.5 x 40 mm on this way would breach"), std::string::npos) << wider;
  const std::string single = reasons_of({{"", 4.5, 40.0, 4.0}});
  EXPECT_NE(single.find("the table has no thicker screw"), std::string::npos) << single;
  for (const Suggestion& suggestion : suggested()) {
    for (const std::string& reason : suggestion.best->reasons) EXPECT_EQ(reason.find("on this way"), std::string::npos);
  }
}

TEST_F(SuggestPaths, SayOfEachThinScrewWhatKeepsAThickerOneFromAllWays) {
  // In a pedicle of 9 mm 4.5 mm are thin, and nothing keeps 10.5 mm in it.
  const std::vector<PedicleScrew> thin_or_too_thick{{"", 4.5, 40.0, 4.0}, {"", 10.5, 40.0, 4.0}};
  for (const Suggestion& suggestion : suggest_paths(walls(), hu_of_200, {}, thin_or_too_thick)) {
    std::vector<SuggestedPath> all = suggestion.others;
    all.push_back(suggestion.best.value());
    for (const SuggestedPath& one : all) {
      std::string reasons;
      for (const std::string& reason : one.reasons) reasons += reason + "\n";
      EXPECT_NE(reasons.find("no way of "), std::string::npos) << reasons;
      EXPECT_NE(reasons.find(" takes one of 10.5 mm: "), std::string::npos) << reasons;
      EXPECT_NE(reasons.find(" mm of bone around it in the pedicle"), std::string::npos) << reasons;
      EXPECT_NE(reasons.find("on this way would breach the "), std::string::npos) << reasons;
      EXPECT_NE(reasons.find(" mm of depth\n"), std::string::npos) << "where it is limited: " << reasons;
    }
  }
}

TEST_F(SuggestPaths, SayOfAThickerScrewThatItIsTooShort) {
  const std::vector<PedicleScrew> long_or_thick{{"", 4.5, 35.0, 4.0}, {"", 4.6, 25.0, 4.0}};
  for (const Suggestion& suggestion : suggest_paths(walls(), hu_of_200, {}, long_or_thick)) {
    std::string reasons;
    for (const std::string& reason : suggestion.best.value().reasons) reasons += reason + "\n";
    EXPECT_NE(reasons.find("a screw of 4.6 x 25 mm on this way would reach only "), std::string::npos) << reasons;
    EXPECT_NE(reasons.find(" % into the body"), std::string::npos) << reasons;
  }
}

TEST_F(SuggestPaths, TakeAThickScrewThatBestWaysForThinOnesHaveNoRoomFor) {
  // One of 6 mm fills two thirds of the pedicle; the many thin ones of the table do not crowd it out.
  std::vector<PedicleScrew> screws{{"", 6.0, 35.0, 4.0}};
  for (const double length_mm : {35.0, 40.0, 45.0, 50.0}) screws.push_back({"", 3.5, length_mm, 4.0});
  for (const Suggestion& suggestion : suggest_paths(walls(), hu_of_200, {}, screws)) {
    EXPECT_EQ(suggestion.best.value().path.screw->diameter_mm, 6.0);
  }
}

TEST_F(SuggestPaths, RejectOptionsWithoutSense) {
  const auto rejected = [&](const auto& change) {
    SuggestOptions options;
    change(options);
    EXPECT_THROW(suggest_paths(walls(), hu_of_200, {}, table(), options), Error);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  rejected([&](SuggestOptions& options) { options.margin_mm = nan; });
  rejected([&](SuggestOptions& options) { options.bit = plate_bit(10.0, 1.0, 40.0); });
  rejected([&](SuggestOptions& options) { options.margin_mm = -1.0; });
  rejected([&](SuggestOptions& options) { options.front_margin_mm = nan; });
  rejected([&](SuggestOptions& options) { options.widest_share = 0.0; });
  rejected([&](SuggestOptions& options) { options.furthest_share = 1.5; });
  rejected([&](SuggestOptions& options) { options.max_turn_deg = 90.0; });
  rejected([&](SuggestOptions& options) { options.weights.canal = nan; });
  rejected([&](SuggestOptions& options) { options.bit.diameter_mm = nan; });
  EXPECT_THROW(suggest_paths(walls(), hu_of_200, {}, {}), Error);
  std::vector<PedicleScrew> bad = table();
  bad[1].length_mm = nan;
  EXPECT_THROW(suggest_paths(walls(), hu_of_200, {}, bad), Error);
}

constexpr double kShaftRadiusMm = 3.0;
constexpr double kConeMm = 4.0;
constexpr double kLengthMm = 32.0;

const WallDistance& walls() {
  static const test::Block block;
  static const WallDistance of_block(block.bone(), block.landmarks());
  return of_block;
}

/// From the block's back straight forward.
DrillPath straight_forward(double x_mm, double z_mm) {
  const Vec3 entry_mm(x_mm, test::Block::kHalfDepthMm, z_mm);
  DrillPath path{"", entry_mm, entry_mm - kLengthMm * Vec3::UnitY(), {}};
  path.screw = PedicleScrew{"", 2.0 * kShaftRadiusMm, kLengthMm, kConeMm};
  return path;
}

/// The angle at which the screw's edge, where its cone begins, has come `room_mm` further aside.
double turn_to_wall_deg(double room_mm) {
  double low = 0.0, high = 0.5;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    const double reach_mm = (kLengthMm - kConeMm) * std::sin(middle) + kShaftRadiusMm * (std::cos(middle) - 1.0);
    (reach_mm > room_mm ? high : low) = middle;
  }
  return low * 180.0 / std::numbers::pi;
}

// Rings of the screw are looked at 0.5 mm apart along it: a wall is met at most that late.
constexpr double kZoneToleranceMm = 0.06;
constexpr double kZoneToleranceDeg = 0.2;

TEST(SafeZone, ReachesToTheWallsOfABlock) {
  const double lateral_mm = 2.0, cranial_mm = 3.0;
  for (const double side : {1.0, -1.0}) {
    const SafeZone zone =
        safe_zone(walls(), straight_forward(side * (test::Block::kHalfWidthMm - kShaftRadiusMm - lateral_mm),
                                            test::Block::kHalfHeightMm - kShaftRadiusMm - cranial_mm));
    EXPECT_NEAR(zone.lateral_mm, lateral_mm, kZoneToleranceMm) << side;
    EXPECT_NEAR(zone.cranial_mm, cranial_mm, kZoneToleranceMm) << side;
    EXPECT_NEAR(zone.lateral_deg, turn_to_wall_deg(lateral_mm), kZoneToleranceDeg) << side;
    EXPECT_NEAR(zone.cranial_deg, turn_to_wall_deg(cranial_mm), kZoneToleranceDeg) << side;
    // Far walls: no further than is looked.
    EXPECT_EQ(zone.caudal_mm, 8.0) << side;
  }
}

TEST(SafeZone, ReachesToTheCanal) {
  const double medial_mm = 1.5;
  const SafeZone zone = safe_zone(walls(), straight_forward(test::Block::kHoleMm + kShaftRadiusMm + medial_mm, 0.0));
  EXPECT_NEAR(zone.medial_mm, medial_mm, kZoneToleranceMm);
}

TEST(SafeZone, IsNothingAroundAPathThatBreaches) {
  const SafeZone zone = safe_zone(walls(), straight_forward(test::Block::kHalfWidthMm - 1.0, 0.0));
  for (const double error : {zone.medial_mm, zone.lateral_mm, zone.cranial_mm, zone.caudal_mm, zone.medial_deg,
                             zone.lateral_deg, zone.cranial_deg, zone.caudal_deg}) {
    EXPECT_EQ(error, 0.0);
  }
}

TEST(PublishedConvergence, GrowsDownTheLumbarSpineAndFallsDownTheThoracic) {
  // 5 degrees times the level's number, 10 to either side.
  EXPECT_DOUBLE_EQ(published_convergence(Level::kL1)->low_deg, -5.0);
  EXPECT_DOUBLE_EQ(published_convergence(Level::kL5)->low_deg, 15.0);
  EXPECT_DOUBLE_EQ(published_convergence(Level::kL5)->high_deg, 35.0);
  // The ends of the series, less and more two deviations.
  EXPECT_DOUBLE_EQ(published_convergence(Level::kT1)->low_deg, 17.0);
  EXPECT_DOUBLE_EQ(published_convergence(Level::kT1)->high_deg, 39.8);
  EXPECT_DOUBLE_EQ(published_convergence(Level::kT12)->low_deg, -14.6);
  EXPECT_DOUBLE_EQ(published_convergence(Level::kT12)->high_deg, 8.4);
  for (Level level = Level::kT1; level != Level::kT12; level = level_below(level)) {
    EXPECT_GT(published_convergence(level)->low_deg, published_convergence(level_below(level))->low_deg);
    EXPECT_GT(published_convergence(level)->high_deg, published_convergence(level_below(level))->high_deg);
  }
}

TEST(PublishedConvergence, IsNotToldOfOtherLevels) {
  for (const Level level : {Level::kNone, Level::kC7, Level::kL6, Level::kSacrum, Level::kT13}) {
    EXPECT_FALSE(published_convergence(level).has_value()) << level_name(level);
  }
}

}  // namespace

}  // namespace spinaltap
