#include "vdb/sim/bake_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/ct/label_map.h"
#include "core/ct/read_ct.h"
#include "tests/support/labelled_balls.h"
#include "tests/support/release_only.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/sim/label_warnings.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Level kT11{18};

const test::LabelledBalls& balls() {
  static const test::LabelledBalls made;
  return made;
}

BakeLevelsOptions quick() {
  BakeLevelsOptions options;
  options.bake.bake.voxel_mm = 0.5;
  return options;
}

TEST(ReachesBorder, LooksAtAllSixSides) {
  BoneMask mask;
  mask.geometry.size = {4, 5, 6};
  mask.inside.assign(mask.geometry.voxel_count(), 0);
  mask.inside[mask.geometry.offset(2, 2, 2)] = 1;
  EXPECT_FALSE(reaches_border(mask));
  for (const std::array<int, 3>& at : {std::array{0, 2, 2}, {3, 2, 2}, {2, 0, 2}, {2, 4, 2}, {2, 2, 0}, {2, 2, 5}}) {
    BoneMask other = mask;
    other.inside[mask.geometry.offset(at[0], at[1], at[2])] = 1;
    EXPECT_TRUE(reaches_border(other)) << at[0] << ' ' << at[1] << ' ' << at[2];
  }
}

TEST(LabelWarnings, SuspectALabelThatIsAShell) {
  const test::LabelledBalls& made = balls();
  const BoneMask whole = mask_of(made.labels, kT11);
  EXPECT_LT(warnings_of_label(made.ct, whole, kT11, {}, {}).severity, kSuspect);
  BoneMask shell = whole;
  for (int k = 0; k < shell.geometry.size[2]; ++k) {
    for (int j = 0; j < shell.geometry.size[1]; ++j) {
      for (int i = 0; i < shell.geometry.size[0]; ++i) {
        const Vec3 p_mm = shell.geometry.to_patient(Vec3(i, j, k));
        if ((p_mm - made.balls[0].centre_mm).norm() < 3.5) shell.inside[shell.geometry.offset(i, j, k)] = 0;
      }
    }
  }
  const LevelWarnings warnings = warnings_of_label(made.ct, shell, kT11, {}, {});
  EXPECT_GE(warnings.severity, kSuspect);
  EXPECT_THAT(warnings.warnings, testing::Contains(HasSubstr("the label: it encloses hollows of")));
  EXPECT_THAT(warnings.warnings, testing::Contains(HasSubstr("the label: nowhere is it deeper than")));
}

TEST(BakeLevels, BakesWholeLevelsAndLeavesTheCutOneOut) {
  RELEASE_ONLY();
  BakeLevelsOptions options = quick();
  options.warnings[Level::kT12] = {{"looks odd"}, 0.5};
  std::vector<std::string> stages;
  const Progress progress([&](std::string_view stage, double) { stages.emplace_back(stage); });
  const BakedLevels baked = bake_levels(balls().ct, balls().labels, options, progress);
  ASSERT_EQ(baked.levels.size(), 2U);
  EXPECT_EQ(baked.levels[0].level, kT11);
  EXPECT_EQ(baked.levels[1].level, Level::kT12);
  ASSERT_EQ(baked.skipped.size(), 1U);
  EXPECT_EQ(baked.skipped[0].level, Level::kL1);
  EXPECT_THAT(baked.skipped[0].reason, HasSubstr("border"));
  for (std::size_t n = 0; n < 2; ++n) {
    const Box3 bounds_mm = baked.levels[n].baked.bone.bounds_mm();
    // The band of three voxels around the surface, and what a CT of 0.8 mm leaves open.
    EXPECT_LT((bounds_mm.center() - balls().balls[n].centre_mm).norm(), 0.4);
    EXPECT_NEAR(test::distance_at(baked.levels[n].baked.bone, balls().balls[n].centre_mm + Vec3(5, 0, 0)), 0.0, 0.3);
    EXPECT_EQ(baked.levels[n].notes.landmarks, "");
    EXPECT_NE(baked.levels[n].notes.no_landmarks, "");  // a ball has no canal
  }
  EXPECT_EQ(baked.levels[0].baked.bone.metadata().at("level"), "T11");
  EXPECT_THAT(baked.levels[0].notes.warnings, ElementsAre(HasSubstr("no ring of bone closes round the canal")));
  EXPECT_THAT(baked.levels[1].notes.warnings, ElementsAre("looks odd"));
  EXPECT_EQ(baked.levels[1].notes.severity, 0.5);
  ASSERT_FALSE(stages.empty());
  EXPECT_THAT(stages.front(), HasSubstr("T11 (1 of 2), "));
  EXPECT_THAT(stages.back(), HasSubstr("T12 (2 of 2), "));
}

TEST(BakeLevels, GivesEachBoneAsIfBakedAloneAlsoOutOfTheFile) {
  RELEASE_ONLY();
  const BakedLevels baked = bake_levels(balls().ct, balls().labels, quick());
  const test::TemporaryFolder folder;
  StagedOutput output;
  write_levels(baked, folder.path() / "spine.vdb", output);
  write_levels(baked, folder.path() / "bones", output);
  output.write(folder.path() / "map.seg.nrrd", encode_label_volume(balls().labels, "map.seg.nrrd"));
  output.commit();
  for (const Level level : {kT11, Level::kT12}) {
    BakeCtOptions alone = quick().bake;
    alone.labels = LabelChoice{folder.path() / "map.seg.nrrd", 0, level};
    const BoneModel bone = bake_ct(balls().ct, alone).bone;
    const BoneModel of_spine = read_bone(folder.path() / "spine.vdb", level);
    EXPECT_EQ(bone_hash(of_spine), bone_hash(bone));
    EXPECT_EQ(of_spine.metadata(), bone.metadata());
    EXPECT_EQ(bone_hash(read_bone(folder.path() / "bones" / (level_name(level) + ".vdb"), level)), bone_hash(bone));
  }
}

TEST(BakeLevels, SaysWhyThereIsNothingToBake) {
  LabelVolume unknown = balls().labels;
  for (auto& entry : unknown.names) entry.second.level = Level::kNone;
  EXPECT_THAT([&] { bake_levels(balls().ct, unknown); }, ThrowsMessage<Error>(HasSubstr("known")));
  LabelVolume cut = balls().labels;
  cut.names = {{20, {"L1", Level::kL1}}};
  EXPECT_THAT([&] { bake_levels(balls().ct, cut); }, ThrowsMessage<Error>(HasSubstr("L1: cut")));
  LabelVolume moved = balls().labels;
  moved.geometry.origin_mm.x() += 1.0;
  EXPECT_THAT([&] { bake_levels(balls().ct, moved); }, ThrowsMessage<Error>(HasSubstr("grid")));
  BakeLevelsOptions strict = quick();
  strict.is_strict = true;
  EXPECT_THAT([&] { bake_levels(balls().ct, balls().labels, strict); }, ThrowsMessage<Error>(HasSubstr("L1: cut")));
}

TEST(ChooseBone, TakesALabelByItsNumberOrItsName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path map = folder.path() / "map.nii.gz";
  StagedOutput output;
  output.write(map, encode_label_volume(balls().labels, map));
  output.write(folder.path() / "one.nii", encode_label_map(mask_of(balls().labels, 18), 300, "one.nii"));
  output.commit();
  const ChosenBone by_name = choose_bone(balls().ct, LabelChoice{map, 0, Level::kT12}, {});
  const ChosenBone by_number = choose_bone(balls().ct, LabelChoice{map, 19}, {});
  EXPECT_EQ(by_name.mask.inside, by_number.mask.inside);
  EXPECT_EQ(by_name.label, 19);
  EXPECT_EQ(by_number.level, Level::kT12);
  EXPECT_THAT(
      [&] {
        choose_bone(balls().ct, LabelChoice{map, 0, Level::kL5}, {});
      },
      ThrowsMessage<Error>(HasSubstr("there are: T11, T12, L1")));
  // A number needs no name, and may be one that maps of many levels cannot have.
  const ChosenBone unnamed = choose_bone(balls().ct, LabelChoice{folder.path() / "one.nii", 300}, {});
  EXPECT_EQ(unnamed.level, Level::kNone);
  EXPECT_EQ(unnamed.mask.inside, mask_of(balls().labels, 18).inside);
}

TEST(BakeLevels, BakesL3AndLeavesItsCutNeighboursOut) {
  RELEASE_ONLY();
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume ct = read_ct(data / "dicom");
  const LabelVolume labels = read_label_volume(data / "sub-ct_seg-vert_label-22_msk.nii.gz", ct.geometry);
  const BakedLevels baked = bake_levels(ct, labels, quick());
  ASSERT_EQ(baked.levels.size(), 1U);
  EXPECT_EQ(level_name(baked.levels[0].level), "L3");
  EXPECT_THAT(baked.levels[0].notes.landmarks, HasSubstr("left_pedicle"));
  ASSERT_EQ(baked.skipped.size(), 2U);
  EXPECT_EQ(level_name(baked.skipped[0].level) + level_name(baked.skipped[1].level), "L2L4");
  EXPECT_THAT(baked.skipped[0].reason, HasSubstr("border"));
}

}  // namespace
}  // namespace spinaltap
