#include "vdb/sim/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kStudiedBall{Vec3(3.0, -4.0, 5.0), 9.0};

/// Twelve runs through a ball whose entries differ.
StudySpec spec(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "bone.vdb";
  if (!std::filesystem::exists(file)) Bone(test::bake_ball(kStudiedBall, 0.4)).save(file);
  StudySpec spec;
  spec.name = "ball";
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry_mm = kStudiedBall.centre_mm - kStudiedBall.radius_mm * axis;
  spec.bones = {{.file = file, .paths = {{"slanting", entry_mm, entry_mm + 5.0 * axis, {2.0, 30.0, 2.0}}}}};
  spec.volume.spacing_mm = 0.2;
  spec.volume.lead_in_mm = 1.0;
  spec.tool_operator.step_mm = 0.05;
  spec.design.runs = 12;
  spec.design.distributions = {
      {.factor = StudyFactor::entry_left_mm, .kind = FactorDistribution::Kind::normal, .a = 0.0, .b = 0.5}};
  return spec;
}

std::vector<std::string> texts_of(const std::vector<StudyRow>& rows) {
  std::vector<std::string> texts;
  for (const StudyRow& row : rows) texts.push_back(study_csv(row));
  return texts;
}

TEST(Study, HasEachRunOnceWhateverItsShardAndWhateverIsDoneAlready) {
  const test::TemporaryFolder folder;
  const Study study(spec(folder.path()));
  ASSERT_EQ(study.run_count(), 12U);
  EXPECT_GT(study.spec().volume.radius_mm, 1.0);
  const std::vector<std::string> whole = texts_of(study.run());
  ASSERT_EQ(whole.size(), 12U);

  std::vector<std::string> second = texts_of(study.run({2, 3}));
  ASSERT_EQ(second.size(), 4U);
  EXPECT_EQ(second[0], whole[4]);
  EXPECT_EQ(second[3], whole[7]);

  const std::vector<std::filesystem::path> folders{folder.path() / "one", folder.path() / "two"};
  EXPECT_EQ(study.run_into(folders[0], {1, 2}).runs, 6U);
  EXPECT_EQ(study.run_into(folders[0], {1, 2}).runs, 0U) << "done already";
  EXPECT_FALSE(merge({folders.data(), 1}).is_whole());
  EXPECT_EQ(Study(spec(folder.path())).run_into(folders[1], {2, 2}).runs, 6U);
  const StudyTable table = merge(folders);
  ASSERT_TRUE(table.is_whole());
  for (const auto& [run, text] : table.rows) EXPECT_EQ(text, whole[run]);
}

TEST(Study, DrillsVoxelsAsItDrillsPoints) {
  const test::TemporaryFolder folder;
  StudySpec in_voxels = spec(folder.path());
  in_voxels.engine = EngineKind::voxel;
  in_voxels.volume.spacing_mm = 0.1;
  StudySpec in_points = in_voxels;
  in_points.engine = EngineKind::ring;
  const Study study(in_voxels);
  const std::vector<StudyRow> voxels = study.run(), points = Study(in_points).run();
  ASSERT_EQ(voxels.size(), points.size());
  double voxels_mm3 = 0.0, points_mm3 = 0.0;
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    SCOPED_TRACE(n);
    EXPECT_EQ(voxels[n][StudyColumn::min_clearance_outer_mm], points[n][StudyColumn::min_clearance_outer_mm]);
    EXPECT_EQ(voxels[n][StudyColumn::depth_mm], points[n][StudyColumn::depth_mm]);
    // Of each hole 1 % of its section is in how the lattice lies.
    const double hole_mm3 = points[n][StudyColumn::removed_mm3];
    EXPECT_NEAR(voxels[n][StudyColumn::removed_mm3], hole_mm3, 0.02 * hole_mm3);
    EXPECT_NEAR(voxels[n][StudyColumn::max_thrust_n], points[n][StudyColumn::max_thrust_n],
                0.15 * points[n][StudyColumn::max_thrust_n]);
    voxels_mm3 += voxels[n][StudyColumn::removed_mm3];
    points_mm3 += hole_mm3;
  }
  EXPECT_NEAR(voxels_mm3, points_mm3, 0.005 * points_mm3);
  // Each run finds the whole bone, whatever was drilled before it, and another study is another.
  const std::vector<StudyRow> second = study.run({2, 3});
  ASSERT_EQ(second.size(), 4U);
  EXPECT_EQ(study_csv(second[0]), study_csv(voxels[4]));
  EXPECT_NE(study.identity().study, Study(in_points).identity().study);
}

TEST(Study, RejectsShardsThatThereAreNotAndFoldersOfOtherStudies) {
  const test::TemporaryFolder folder;
  const Study study(spec(folder.path()));
  EXPECT_THAT([&] { study.run({4, 3}); }, ThrowsMessage<Error>(HasSubstr("expected a shard from 1 to 3, found 4")));
  EXPECT_THROW(study.run({0, 3}), Error);
  study.run_into(folder.path() / "one", {1, 6});
  StudySpec other = spec(folder.path());
  other.design.seed = 2;
  EXPECT_THROW(Study(other).run_into(folder.path() / "one"), Error);
  Study(other).run_into(folder.path() / "other", {1, 6});
  const std::vector<std::filesystem::path> folders{folder.path() / "one", folder.path() / "other"};
  EXPECT_THAT([&] { merge(folders); }, ThrowsMessage<Error>(HasSubstr("expected shards of one study")));
  EXPECT_THROW(merge({}), Error);
}

TEST(Study, TakesWhatIsKnownOfABoneFromItsFolderOnlyWhereItIsAsItWas) {
  const test::TemporaryFolder folder;
  const Study first(spec(folder.path()));
  const std::vector<std::string> whole = texts_of(first.run());
  const std::filesystem::path kept = folder.path() / "study";
  const auto surveys = [&] {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(kept)) {
      if (entry.path().filename().string().starts_with("bone-")) files.push_back(entry.path());
    }
    return files;
  };
  first.open_folder(kept);
  ASSERT_EQ(surveys().size(), 1U);
  const std::filesystem::path file = surveys().front();
  const std::string text = read_whole_file(file);
  const auto expect_same = [&](const char* what) {
    const Study again(spec(folder.path()), {}, kept);
    EXPECT_EQ(again.identity().study, first.identity().study) << what;
    EXPECT_EQ(texts_of(again.run()), whole) << what;
    again.open_folder(kept);
    EXPECT_EQ(read_whole_file(file), text) << what << ": kept again as it was";
  };
  expect_same("as it was kept");
  for (std::size_t n = 0; n < text.size(); n += 97) {
    std::string damaged = text;
    damaged[n] = damaged[n] == '7' ? '3' : '7';
    std::ofstream(file, std::ios::trunc) << damaged;
    expect_same("damaged");
  }
  std::ofstream(file, std::ios::trunc) << text.substr(0, text.size() / 2);
  expect_same("cut short");
  std::filesystem::remove(file);
  expect_same("deleted");

  // Another bone in the file's place: what was kept of the one before says nothing.
  Bone(test::bake_ball({kStudiedBall.centre_mm, kStudiedBall.radius_mm + 0.5}, 0.4)).save(folder.path() / "bone.vdb");
  const Study other(spec(folder.path()), {}, kept);
  EXPECT_NE(other.identity().study, first.identity().study);
  EXPECT_EQ(other.spec().bones[0].hash, Bone::load(folder.path() / "bone.vdb").hash());
  EXPECT_THROW(other.open_folder(kept), Error);
  EXPECT_EQ(surveys().size(), 1U) << "another study's folder is left alone";
}

TEST(Study, RejectsAPathThatMissesTheBone) {
  const test::TemporaryFolder folder;
  StudySpec beside = spec(folder.path());
  beside.bones[0].paths[0].entry_mm.x() += 40.0;
  beside.bones[0].paths[0].target_mm.x() += 40.0;
  EXPECT_THROW(Study(beside).run(), Error);
  // Nor does it leave a folder that looks like a study's.
  EXPECT_THROW(Study(beside).run_into(folder.path() / "beside"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "beside"));
}

}  // namespace
}  // namespace spinaltap
