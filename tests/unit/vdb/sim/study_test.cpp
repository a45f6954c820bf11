#include "vdb/sim/study.h"
#include "core/anatomy/bone_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/spine_file.h"

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

SLOW_TESTS("Study.KnowsTheVertebraeBesideABoneOfASpine",
           "Study.TakesWhatIsKnownOfABoneFromItsFolderOnlyWhereItIsAsItWas");

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

/// A spine of two, of one CT.
std::filesystem::path near_vertebrae(const Vertebra& lower, const Vertebra& upper,
                                     const std::filesystem::path& folder) {
  Box3 box = lower.bounds_mm();
  box.extend(upper.bounds_mm());
  const CtVolume ct = test::even_ct(box, 2.0, 400);
  std::vector<SpineBone> bones;
  for (const auto& [level, vertebra] : {std::pair{Level{22}, &lower}, std::pair{Level{21}, &upper}}) {
    const Vec3 seed_mm = vertebra_ground_truth(*vertebra).left.entry_mm;
    bones.push_back({level,
                     bake_bone(*vertebra, {&seed_mm, 1}, ct, {.voxel_mm = 0.5},
                               {{"source_hash", ct.source_hash}, {"level", level_name(level)}}),
                     {}});
  }
  StagedOutput output;
  write_spine(bones, output.stage(folder / "spine.vdb"));
  output.commit();
  return folder / "spine.vdb";
}

TEST(Study, KnowsTheVertebraeBesideABoneOfASpine) {
  const test::TemporaryFolder folder;
  StudySpec spine;
  spine.kind = StudyKind::geometry;
  VertebraAnatomy above;
  above.placement.position_mm = Vec3(0.0, 0.0, 38.0);
  const Vertebra vertebra, other(above);
  const VertebraGroundTruth truth = vertebra_ground_truth(vertebra);
  DrillPath path{"left", truth.left.entry_mm, truth.left.target_mm, {3.2, 80.0, 1.0}};
  path.screw = PedicleScrew{"", 6.5, 45.0, 4.5};
  spine.bones = {{.file = near_vertebrae(vertebra, other, folder.path()), .level = Level{22}, .paths = {path}}};
  spine.errors.emplace();
  spine.errors->name = "measured";
  spine.errors->measured = {{0, 0, 0, 0, 0}, {0, 0, 0, 0, 40}, {0, 0, 0, 0, -40}};
  spine.design.runs = 12;
  const Study study(spine);
  const Bone bone = study.bone();
  ASSERT_EQ(bone.neighbours().size(), 1U);
  EXPECT_EQ(bone.neighbours()[0].level(), Level{21});
  EXPECT_EQ(study.spec().bones[0].neighbours, std::vector<std::string>{bone.neighbours()[0].hash()});
  std::set<double> met;
  for (const StudyRow& row : study.run()) {
    met.insert(row[StudyColumn::off_cranial_deg]);
    EXPECT_NEAR(row[StudyColumn::off_cranial_deg], row[StudyColumn::error_cranial_deg], 1e-9);
    const double depth_mm = row[StudyColumn::screw_neighbour_mm];
    // Where the axis runs into the other bone, it is met at the axis; where no place of the screw comes near, it is
    // not.
    const DrillPath erred =
        erred_path(path, error_frame(bone.landmarks(), path), {0, 0, 0, 0, row[StudyColumn::error_cranial_deg]});
    std::vector<Vec3> axis_mm;
    for (int n = 0; n <= 200; ++n) {
      axis_mm.push_back(erred.target_mm - n / 200.0 * path.screw->length_mm * erred.direction());
    }
    std::vector<double> values_mm(axis_mm.size());
    other.evaluate(axis_mm, values_mm, {});
    const double nearest_mm = *std::min_element(values_mm.begin(), values_mm.end());
    if (nearest_mm < 0.0) {
      EXPECT_NEAR(depth_mm, 0.5 * path.screw->diameter_mm, BoneShape::kSampleMm);
    }
    EXPECT_EQ(depth_mm > 0.0, row[StudyColumn::error_cranial_deg] > 0.0);
    EXPECT_EQ(nearest_mm<0.0, row[StudyColumn::error_cranial_deg]> 0.0);
    const PathGrade graded = grade(bone, erred);
    ASSERT_TRUE(graded.neighbour.has_value());
    EXPECT_NEAR(graded.neighbour->depth_mm, depth_mm, 1e-9);
  }
  EXPECT_EQ(met.size(), 3U);
  EXPECT_NE(study.identity().study.find(bone.neighbours()[0].hash()), std::string::npos);
  // A bone of a file of its own has none.
  bone.save(folder.path() / "bone.vdb");
  EXPECT_TRUE(Bone::load(folder.path() / "bone.vdb").neighbours().empty());
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
