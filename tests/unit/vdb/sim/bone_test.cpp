#include "vdb/sim/bone.h"
#include "core/grading/path_doubt.h"
#include "core/segment/warning_metadata.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "core/base/error.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "mesh/mesh_quality.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"

namespace spinaltap {
namespace {

const test::Ball kPlainBall{Vec3(3.0, -4.0, 5.0), 9.0};

SLOW_TESTS("Bone.StopsWhereTheWorkIsCancelledAndBeginsAgainWhenAskedAgain");

TEST(Bone, HasTheBallsDistancesNumbersNormalsAndSurface) {
  const Bone bone(test::bake_ball(kPlainBall, 0.3, 700));
  const Vec3 out = Vec3(1.0, 2.0, -2.0) / 3.0;
  const std::vector<Vec3> places{kPlainBall.centre_mm + 8.8 * out, kPlainBall.centre_mm + 9.0 * out,
                                 kPlainBall.centre_mm + 9.2 * out};
  const std::vector<float> distance_mm = bone.distance(places);
  const std::vector<Vec3> normals = bone.normals(places);
  for (std::size_t n = 0; n < places.size(); ++n) {
    EXPECT_NEAR(distance_mm[n], kPlainBall.distance_mm(places[n]), 0.01);
    EXPECT_NEAR((normals[n] - out).norm(), 0.0, 0.02);
  }
  EXPECT_NEAR(bone.hu({&kPlainBall.centre_mm, 1})[0], 700.0F, 1.0F);
  EXPECT_TRUE(bone.distance({}).empty());
  const MeshQuality mesh = measure_mesh(bone.surface());
  EXPECT_TRUE(mesh.closed());
  EXPECT_NEAR(mesh.volume_mm3, kPlainBall.volume_mm3(), 0.01 * kPlainBall.volume_mm3());
}

TEST(Bone, GradesNoPathThroughMadeUpSlicesOrAnothersBoneAsPlainA) {
  const Vertebra vertebra;
  const PedicleGroundTruth pedicle = vertebra_ground_truth(vertebra).left;
  DrillPath path{"left", pedicle.entry_mm, pedicle.target_mm, {}};
  path.screw = PedicleScrew{"", 5.0, path.length_mm(), 4.0};
  const auto graded = [&](const std::map<std::string, std::string>& metadata) {
    const Bone bone(bake_solid(vertebra, {.voxel_mm = 1.0}, 60.0, {}, metadata));
    return grade(bone, path);
  };
  EXPECT_EQ(grade_in_words(graded({})), "A");
  std::map<std::string, std::string> filled;
  const double z_mm = pedicle.isthmus_mm.z();
  add_made_up({Vec3::UnitZ(), {{z_mm - 0.5, z_mm + 0.5}}}, filled);
  const PathGrade in_gap = graded(filled);
  EXPECT_EQ(in_gap.grade, Grade::A);
  EXPECT_TRUE(grade_in_words(in_gap).starts_with("A, but ")) << grade_in_words(in_gap);
  EXPECT_TRUE(in_gap.findings.at(0).is_warning);
  std::map<std::string, std::string> unsure;
  add_warnings({{"no gap shows"}, 0.1, {pedicle.entry_mm}}, unsure);
  EXPECT_TRUE(grade_in_words(graded(unsure)).ends_with("run in bone that may be another's"));
  // The planner's and the program's suggestions say it too.
  for (const auto& metadata : {filled, unsure}) {
    const Bone bone(bake_solid(vertebra, {.voxel_mm = 0.5}, 60.0, {}, metadata));
    const SuggestedPath left = bone.suggest()[0].best.value();
    EXPECT_EQ(grade_in_words(left.grade) == "A", path_doubts(bone.doubtful(), left.path).empty());
  }
}

TEST(Bone, HoldsAScrewInsideItAsTheClosedFormSays) {
  // A ball baked with one CT number; the screw lies all in it, 5.5 mm off its middle at most.
  const Bone bone(test::bake_ball(kPlainBall, 0.3, 400));
  DrillPath path{
      "", kPlainBall.centre_mm + Vec3(0.0, 0.0, 6.0), kPlainBall.centre_mm - Vec3(0.0, 0.0, 6.0), {3.0, 50.0, 1.0}};
  path.screw = PedicleScrew{"", 6.0, 12.0, 3.0};
  path.screw->thread = ScrewThread{.core_diameter_mm = 4.0, .pitch_mm = 2.5, .crest_mm = 0.25, .flank_deg = 0.0};
  const HuToDensity calibration{.at_0_hu = 0.1, .per_hu = 0.0005};
  const ScrewFixation fixation = screw_fixation(bone, path, calibration);
  const double pi = std::acos(-1.0), share = std::pow(0.3 / 1.9, 1.7);  // 0.3 g/cm3
  const double pullout_n = 51.6 * share * 9.0 * pi * 6.0 * (0.5 + 0.57735 * 1.0 / 2.5);
  EXPECT_NEAR(fixation.pullout_n.median, pullout_n, 0.02 * pullout_n);
  const double flanks_mm2 = 2.0 * 2.0 * pi / 3.0 * (27.0 - 8.0) / 2.5, core_mm2 = 2.0 * pi * 4.0 * 0.9;
  const double turn_mm3 = 0.25 * 2.0 * pi * 2.5 + pi * (4.0 - 2.25) * 2.5;
  const double torque_n_mm = 117.3 * share * (0.3 * 9.0 * (flanks_mm2 + core_mm2) + turn_mm3 / (2.0 * pi));
  EXPECT_NEAR(fixation.max_torque_n_mm.median, torque_n_mm, 0.02 * torque_n_mm);
}

TEST(Bone, ComesBackFromAFileTheSameWithItsWarnings) {
  const test::TemporaryFolder folder;
  const Bone bone(test::bake_ball(kPlainBall, 0.3));
  bone.save(folder.path() / "bone.vdb");
  const Bone back = Bone::load(folder.path() / "bone.vdb");
  EXPECT_EQ(back.hash(), bone.hash());
  EXPECT_FALSE(back.warnings());
  EXPECT_NE(Bone(test::bake_ball({kPlainBall.centre_mm, 9.05}, 0.3)).hash(), bone.hash());
  EXPECT_THROW(Bone::load(folder.path() / "none.vdb"), Error);
}

TEST(Bone, IsSeenWhereItsSurfaceIs) {
  RELEASE_ONLY();
  const Vertebra vertebra;
  const Bone bone(bake_solid(vertebra, {.voxel_mm = 0.5}, 40.0));
  const Vec3 middle_mm = bone.model().bounds_mm().center();
  for (const Vec3& from : {Vec3(0.0, 1.0, 0.3), Vec3(1.0, -0.4, 0.8)}) {
    const View view =
        bone.view(look_at(middle_mm + 180.0 * from.normalized(), middle_mm, Vec3::UnitZ(), 0.5, 320, 240));
    std::vector<Vec3> points_mm;
    for (int row = 0; row < 240; ++row) {
      for (int column = 0; column < 320; ++column) {
        if (view.mask[view.pixel(column, row)] != 0) points_mm.push_back(view.point_mm(column, row));
      }
    }
    ASSERT_GT(points_mm.size(), 10000U);
    // On the baked surface, and, to the bake's own error, on the solid it was baked from.
    double sum_mm = 0.0, true_mm = 0.0;
    for (const float one : bone.distance(points_mm)) sum_mm += std::abs(static_cast<double>(one));
    std::vector<double> values_mm(points_mm.size());
    vertebra.evaluate(points_mm, values_mm, {});
    for (const double one : values_mm) true_mm += std::abs(one);
    EXPECT_LT(sum_mm / static_cast<double>(points_mm.size()), 1e-4);
    EXPECT_LT(true_mm / static_cast<double>(points_mm.size()), 0.05);
  }
}

TEST(Bone, OfABallHasNoLandmarksButAnOuterWall) {
  const Bone bone(test::bake_ball(kPlainBall, 0.3));
  EXPECT_FALSE(bone.no_landmarks().empty());
  EXPECT_THROW(bone.landmarks(), Error);
  EXPECT_THROW(bone.suggest(), Error);
  EXPECT_NEAR(bone.walls().outer(kPlainBall.centre_mm).distance_mm, 9.0, 0.2);
}

TEST(Bone, OfAVertebraHasItsPediclesAndAPathThroughEachWhoeverAsksFirst) {
  RELEASE_ONLY();
  const Vertebra vertebra;
  const Bone bone(bake_solid(vertebra, {.voxel_mm = 0.5}, 40.0));
  const Bone copy = bone;
  std::vector<std::thread> threads;
  std::vector<const Landmarks*> seen(4);
  for (auto& one : seen) {
    threads.emplace_back([&one, &copy] { one = &copy.landmarks(); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Landmarks* one : seen) EXPECT_EQ(one, &bone.landmarks()) << "worked out once, shared by copies";

  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  EXPECT_NEAR(bone.landmarks().left_pedicle.width_mm, ground_truth.left.width_mm, 0.6);
  const std::vector<Suggestion> suggestions = bone.suggest();
  for (const DrillPath& path : paths_of(suggestions)) {
    EXPECT_EQ(grade(bone, path).grade, Grade::A);
    DrillPath through_the_canal = path;  // in the plane of symmetry
    through_the_canal.entry_mm.x() = through_the_canal.target_mm.x() = 0.0;
    EXPECT_NE(grade(bone, through_the_canal).grade, Grade::A);
  }
}

TEST(Bone, StopsWhereTheWorkIsCancelledAndBeginsAgainWhenAskedAgain) {
  const Vertebra vertebra;
  const Bone bone(bake_solid(vertebra, {.voxel_mm = 0.7}, 40.0));
  const Progress stopped([](std::string_view, double) {});
  stopped.cancel();
  EXPECT_THROW(bone.landmarks(stopped), Cancelled);
  EXPECT_TRUE(bone.no_landmarks().empty());
}

}  // namespace
}  // namespace spinaltap
