// Compiled with optimisation: long loops of its own.

#include "core/segment/segment_spine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/release_only.h"
#include "tests/support/spine_scan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr Level kT11{18};
constexpr Level kL2{21};

std::vector<std::string> names_of(const SpineSegmentation& found) {
  std::vector<std::string> names;
  for (const LevelReport& level : found.levels) names.push_back(level.name);
  return names;
}

int label_at(const LabelVolume& volume, const Vec3& p_mm) {
  const Vec3 p = volume.geometry.to_index(p_mm).array().round();
  const Eigen::Vector3i at = p.cast<int>();
  return volume.labels[volume.geometry.offset(at.x(), at.y(), at.z())];
}

/// T11 to L2 with ribs.
class SpineLevels : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SpineOptions options;
    options.first = kT11;
    options.last = kL2;
    spine_ = new Spine(options);
    ct_ = new CtVolume(test::scan_spine(*spine_));
    found_ = new SpineSegmentation(segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12)}}}));
  }
  static void TearDownTestSuite() {
    delete found_;
    delete ct_;
    delete spine_;
  }

  static Vec3 middle_of(Level level) { return test::vertebra_of(*spine_, level).to_patient(Vec3::Zero()); }
  static LevelGroundTruth ground_truth_of(Level level) {
    const SpineGroundTruth ground_truth = spine_ground_truth(*spine_);
    return *std::find_if(ground_truth.levels.begin(), ground_truth.levels.end(),
                         [&](const auto& l) { return l.level == level; });
  }
  /// 2 mm within the bone from the tip of a process.
  static Vec3 within(const Vec3& tip_mm, Level level) {
    Vec3 normal;
    double value_mm = 0.0;
    test::vertebra_of(*spine_, level).evaluate({&tip_mm, 1}, {&value_mm, 1}, {&normal, 1});
    return tip_mm - 2.0 * normal.normalized();
  }

  static const Spine* spine_;
  static const CtVolume* ct_;
  static const SpineSegmentation* found_;  ///< T12 is given
};
const Spine* SpineLevels::spine_ = nullptr;
const CtVolume* SpineLevels::ct_ = nullptr;
const SpineSegmentation* SpineLevels::found_ = nullptr;

SLOW_TESTS("SpineLevels.*", "SpineLevelsAlone.AreNumberedFromTheHeadWhereNothingTellsTheirNames");

TEST_F(SpineLevels, AreCountedFromTheGivenOne) {
  ASSERT_THAT(names_of(*found_), ElementsAre("T11", "T12", "L1", "L2"));
  for (const LevelReport& level : found_->levels) {
    EXPECT_EQ(level.name_source, NameSource::given);
    EXPECT_EQ(level.label, static_cast<int>(level.level));
    EXPECT_LE((level.body_centre_mm - middle_of(level.level)).norm(), 2.5)
        << level.name << " off in its own frame by "
        << test::vertebra_of(*spine_, level.level).to_own(level.body_centre_mm).transpose() << " mm";
    EXPECT_FALSE(level.is_cut) << level.name;
    EXPECT_FALSE(level.reaches_border) << level.name;
  }
  EXPECT_THAT(levels_of(found_->labels), ElementsAre(kT11, Level::kT12, Level::kL1, kL2));
}

TEST_F(SpineLevels, CoverTheGroundTruth) {
  const LabelVolume ground_truth = true_labels(*spine_, ct_->geometry);
  for (const LevelReport& level : found_->levels) {
    const BoneMask mask = mask_of(found_->labels, level.level);
    EXPECT_GE(test::dice(mask, mask_of(ground_truth, level.level)), 0.9) << level.name;  // voxels of 1 x 1 x 1.5 mm
    const double voxels_mm3 = static_cast<double>(test::voxel_count(mask)) * ct_->geometry.spacing_mm.prod();
    EXPECT_NEAR(level.volume_mm3, voxels_mm3, 1e-6 * voxels_mm3);
  }
}

TEST_F(SpineLevels, AreNotSuspectWhereTheyAreSound) {
  for (const LevelReport& level : found_->levels) {
    std::string texts;
    for (const LevelWarning& warning : level.warnings) texts += warning.text + "\n";
    EXPECT_FALSE(level.is_suspect()) << level.name << ":\n" << texts;
  }
}

TEST_F(SpineLevels, AreGuessedFromTheLastRibs) {
  const SpineSegmentation hinted = segment_spine(*ct_);
  ASSERT_THAT(names_of(hinted), ElementsAre("T11", "T12", "L1", "L2"));
  for (const LevelReport& level : hinted.levels) EXPECT_EQ(level.name_source, NameSource::hint);
  EXPECT_EQ(hinted.labels.labels, found_->labels.labels);
}

TEST_F(SpineLevels, MayHaveTwoNamesThatAgreeAndNoTwoThatDoNot) {
  const LevelPoint t12{Level::kT12, middle_of(Level::kT12)};
  EXPECT_EQ(segment_spine(*ct_, {.names = {t12, {kL2, middle_of(kL2)}}}).labels.labels, found_->labels.labels);
  const std::string words = test::error_of([&] {
    segment_spine(*ct_, {.names = {t12, {Level::kL1, middle_of(kL2)}}});
  });
  EXPECT_THAT(words, HasSubstr("L1: expected a point that agrees with T12"));
  EXPECT_THAT(words, HasSubstr("lies in L2"));
}

TEST_F(SpineLevels, RejectANameBesideTheBodies) {
  EXPECT_THAT(test::error_of([&] {
                segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12) + Vec3(45.0, 0.0, 0.0)}}});
              }),
              HasSubstr("no body's wall around"));
}

TEST_F(SpineLevels, GiveAProcessToTheLevelThatACorrectionNames) {
  const Vec3 p_mm = within(ground_truth_of(Level::kT12).spinous_tip_mm, Level::kT12);
  ASSERT_EQ(label_at(found_->labels, p_mm), static_cast<int>(Level::kT12));
  const SpineSegmentation moved =
      segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12)}}, .corrections = {{Level::kL1, p_mm}}});
  EXPECT_EQ(label_at(moved.labels, p_mm), static_cast<int>(Level::kL1));
  EXPECT_EQ(label_at(moved.labels, middle_of(Level::kT12)), static_cast<int>(Level::kT12));
  EXPECT_EQ(label_at(moved.labels, middle_of(Level::kL1)), static_cast<int>(Level::kL1));
}

TEST_F(SpineLevels, LoseWhatACorrectionExcludes) {
  const Vec3 p_mm = within(ground_truth_of(Level::kL1).left_transverse_tip_mm, Level::kL1);
  ASSERT_EQ(label_at(found_->labels, p_mm), static_cast<int>(Level::kL1));
  const SpineSegmentation without =
      segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12)}}, .corrections = {{Level::kNone, p_mm}}});
  EXPECT_NE(label_at(without.labels, p_mm), static_cast<int>(Level::kL1));
  EXPECT_EQ(label_at(without.labels, middle_of(Level::kL1)), static_cast<int>(Level::kL1));
  const auto volume = [](const SpineSegmentation& s) { return s.levels[2].volume_mm3; };
  EXPECT_LT(volume(without), volume(*found_));
  EXPECT_GT(volume(without), 0.85 * volume(*found_)) << "more than the process is gone";
}

TEST_F(SpineLevels, RejectACorrectionOfALevelThatIsNotThere) {
  EXPECT_THAT(test::error_of([&] {
                segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12)}},
                                     .corrections = {{Level::kL5, middle_of(kL2)}}});
              }),
              HasSubstr("L5"));
}

TEST_F(SpineLevels, AreWhatOneVertebraAloneIs) {
  const Segmentation one = segment_vertebra(*ct_, {.seed_mm = middle_of(Level::kL1)});
  EXPECT_EQ(one.mask.inside, mask_of(found_->labels, Level::kL1).inside);
  EXPECT_EQ(one.report.volume_mm3, found_->levels[2].volume_mm3);
}

TEST_F(SpineLevels, GiveTheSameVertebraFromAnySeedInItsBody) {
  constexpr std::uint64_t kSeed = 20;
  constexpr std::uint64_t kSeeds = 3;  // the regression tests take 20
  const BoneMask first = segment_vertebra(*ct_, {.seed_mm = middle_of(Level::kL1)}).mask;
  for (std::uint64_t n = 0; n < kSeeds; ++n) {
    const Vec3 seed_mm = test::place_in_body(test::vertebra_of(*spine_, Level::kL1), 0.9, kSeed, n);
    EXPECT_EQ(segment_vertebra(*ct_, {.seed_mm = seed_mm}).mask.inside, first.inside)
        << "seed " << kSeed << ", place " << n << ": " << seed_mm.transpose();
  }
}

TEST_F(SpineLevels, GiveTheSameAtAnyNumberOfThreads) {
  const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(segment_spine(*ct_, {.names = {{Level::kT12, middle_of(Level::kT12)}}}).labels.labels,
            found_->labels.labels);
}

TEST(SpineLevelsAlone, AreNotFoundInABlockOfBone) {
  GridGeometry geometry;
  geometry.size = {60, 60, 60};
  std::vector<std::int16_t> hu(geometry.voxel_count(), 40);
  for (std::size_t v = 0; v < hu.size(); ++v) {
    const auto i = static_cast<int>(v % 60);
    const auto j = static_cast<int>(v / 60 % 60);
    if (std::abs(i - 30) < 12 && std::abs(j - 30) < 12) hu[v] = 600;
  }
  const CtVolume ct = make_ct_volume(geometry, std::move(hu));
  EXPECT_THAT(test::error_of([&] { segment_spine(ct); }), HasSubstr("no spine"));
}

TEST(SpineLevelsAlone, AreNumberedFromTheHeadWhereNothingTellsTheirNames) {
  SpineOptions options;
  options.first = Level::kL1;
  options.last = Level{22};
  const SpineSegmentation found = segment_spine(test::scan_spine(Spine(options)));
  ASSERT_THAT(names_of(found), ElementsAre("V1", "V2", "V3"));
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(found.levels[n].label, kFirstUnnamedLabel + static_cast<int>(n));
    EXPECT_EQ(found.levels[n].level, Level::kNone);
    EXPECT_EQ(found.levels[n].name_source, NameSource::counted);
  }
}

TEST(SpineLevelsAlone, AreCountedFromTheSacrum) {
  RELEASE_ONLY();
  SpineOptions options;
  options.first = Level{22};
  options.last = Level::kL5;
  options.sacrum = true;
  const Spine spine(options);
  const SpineSegmentation found = segment_spine(test::scan_spine(spine));
  ASSERT_THAT(names_of(found), ElementsAre("L3", "L4", "L5"));
  for (const LevelReport& level : found.levels) {
    EXPECT_EQ(level.name_source, NameSource::hint);
    EXPECT_LE((level.body_centre_mm - test::vertebra_of(spine, level.level).to_patient(Vec3::Zero())).norm(), 2.5)
        << level.name;
  }
  EXPECT_TRUE(label_of(found.labels, Level::kSacrum).has_value());
}

}  // namespace
}  // namespace spinaltap
