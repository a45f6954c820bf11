// What `plan --auto` suggests for real vertebrae: scanned meshes of ten lumbar ones, and T2 to T11 of a CT. See
// tests/support/test_data.h for where they lie. Every side gets a path, or a reason that an exhaustive search bears
// out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/anatomy/bone_shape.h"
#include "core/ct/read_ct.h"
#include "core/grading/instrument.h"
#include "core/plan/convergence.h"
#include "core/segment/segment_spine.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bake_levels.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

/// Whether a straight screw of a diameter keeps a margin through the pedicle, is borne from its entry opening on,
/// enters beside the joint, has a free way in and ends well in the body, on any trajectory of a lattice twice as fine
/// as the search's in each of its four numbers: written on its own, by the bone's lattice and the rules of
/// docs/planning.md.
bool exhaustive_finds(const Bone& bone, const PedicleLandmarks& pedicle, double diameter_mm, double margin_mm) {
  constexpr double kStepMm = 0.5, kBehindMm = 4.0, kAheadMm = 10.0, kMaxDeg = 16.0;
  const BoneShape& shape = bone.shape();
  const double radius_mm = 0.5 * diameter_mm;
  const auto depth_mm = [&](const Vec3& p_mm) { return -shape.lattice_mm(p_mm); };
  const auto works = [&](const Vec3& crossing_mm, const Vec3& direction) {
    for (double at_mm = -kBehindMm; at_mm <= kAheadMm; at_mm += kStepMm) {
      if (depth_mm(crossing_mm + at_mm * direction) < radius_mm + margin_mm) return false;
    }
    double entry_at_mm = -kBehindMm;
    while (depth_mm(crossing_mm + entry_at_mm * direction) > 0.0) entry_at_mm -= 0.1;
    const Vec3 entry_mm = crossing_mm + entry_at_mm * direction;
    const Vec3 u = any_perpendicular(direction), v = direction.cross(u);
    const auto all_around = [&](double at_mm, double r_mm, bool inside) {
      for (int n = 0; n < 16; ++n) {
        const double angle = std::numbers::pi / 8.0 * n;
        const Vec3 p_mm = entry_mm + at_mm * direction + r_mm * (std::cos(angle) * u + std::sin(angle) * v);
        if ((depth_mm(p_mm) > 0.0) != inside) return false;
      }
      return true;
    };
    for (double at_mm = opening_limit_mm(radius_mm) + 0.5; at_mm < -entry_at_mm - kBehindMm; at_mm += kStepMm) {
      if (!all_around(at_mm, radius_mm, true)) return false;
    }
    for (double at_mm = opening_limit_mm(radius_mm) + 0.5; at_mm < 60.0; at_mm += kStepMm) {
      if (!all_around(-at_mm, 0.5 * radius_mm, false)) return false;
    }
    for (int n = 0; n < 16; ++n) {
      const double angle = std::numbers::pi / 8.0 * n;
      const PointTree::Nearest near = shape.nearest(entry_mm + radius_mm * (std::cos(angle) * u + std::sin(angle) * v));
      if (bone.walls().parts().is_joint(shape.points_mm()[near.index], shape.normals()[near.index])) return false;
      if (-shape.normals()[near.index].dot(direction) < 0.5) return false;  // steeper than 60 degrees
    }
    return true;
  };
  for (double x = -1.0; x <= 1.0; x += 1.0 / 6.0) {
    for (double y = -1.0; y <= 1.0; y += 1.0 / 8.0) {
      if (x * x + y * y > 1.0) continue;
      const Vec3 crossing_mm = pedicle.isthmus_mm + 0.3 * pedicle.width_mm * x * pedicle.width_axis +
                               0.35 * pedicle.height_mm * y * pedicle.height_axis;
      if (depth_mm(crossing_mm) < radius_mm + margin_mm) continue;
      for (double turn_deg = -kMaxDeg; turn_deg <= kMaxDeg; turn_deg += 2.0) {
        for (double rise_deg = -kMaxDeg; rise_deg <= kMaxDeg; rise_deg += 2.0) {
          const Vec3 direction = (pedicle.axis + std::tan(turn_deg * kDegree) * pedicle.width_axis +
                                  std::tan(rise_deg * kDegree) * pedicle.height_axis)
                                     .normalized();
          if (works(crossing_mm, direction)) return true;
        }
      }
    }
  }
  return false;
}

void expect_signed_for(const Bone& bone, const std::string& name, Level level) {
  AutoPlanOptions options;
  options.level = level;
  const std::vector<Suggestion> suggestions = bone.suggest(options);
  for (const Suggestion& suggestion : suggestions) {
    SCOPED_TRACE(name + ", " + suggestion.side);
    ASSERT_TRUE(suggestion.best) << suggestion.rejection;
    const SuggestedPath& best = *suggestion.best;
    const PedicleLandmarks& pedicle =
        best.grade.is_left ? bone.landmarks().left_pedicle : bone.landmarks().right_pedicle;
    const InstrumentContacts& behind = best.grade.instrument;
    std::printf(
        "%s %s: %s of %.1f mm, %s, %.1f degrees (axis %.1f), grade %c, outer %.2f, canal %.2f, facet %d, way in "
        "%.1f, head %.1f, slant %.0f, body %.0f %%\n",
        name.c_str(), suggestion.side.c_str(), best.path.screw->name.c_str(), pedicle.width_mm,
        name_of(best.technique).c_str(), best.angles.convergence_deg,
        path_angles(pedicle.axis, bone.landmarks().axes, best.grade.is_left).convergence_deg,
        letter_of(best.grade.grade), best.grade.outer.clearance_mm, best.grade.canal.clearance_mm, best.grade.facet,
        behind.cut_behind_mm, -behind.head_clearance_mm, best.grade.entry_slant_deg,
        100.0 *
            (bone.landmarks().to_own(bone.landmarks().body.centre_mm).y() + 0.5 * bone.landmarks().body.depth_mm -
             bone.landmarks().to_own(best.path.target_mm).y()) /
            bone.landmarks().body.depth_mm);
    std::string reasons;
    for (const std::string& reason : best.reasons) reasons += "    " + reason + "\n";
    std::printf("%s", reasons.c_str());
    EXPECT_FALSE(reasons.find("do too") < reasons.size() && reasons.find("no way") < reasons.size()) << "both";
    for (const Finding& finding : best.grade.findings) {
      std::printf("  %s %s\n", finding.is_warning ? "!" : ".", finding.words.c_str());
    }
    // Where less margin was taken, there was nothing with the next larger one, to a tenth of a millimetre.
    const std::vector<double> margins{1.0, 0.5, 0.35, 0.2, 0.1, 0.0};
    if (best.margin_mm < 0.5) {
      const auto larger = std::find(margins.begin(), margins.end(), best.margin_mm) - 1;
      EXPECT_FALSE(exhaustive_finds(bone, pedicle, 3.5, *larger + 0.1)) << "margin " << best.margin_mm;
    }
    // The thinnest screw of the table, 3.5 mm, with 0.5 mm to each side.
    if (pedicle.width_mm >= 3.5 + 2.0 * 0.5) {
      EXPECT_EQ(best.grade.grade, Grade::A);
    }
    EXPECT_LE(best.grade.grade, Grade::B);
    EXPECT_FALSE(best.grade.breaches_canal);
    EXPECT_LE(best.grade.facet, 1) << "no entry and no head on the joint";
    EXPECT_LT(behind.cut_behind_mm, 1.0);
    const ConvergenceRange range = published_convergence(level).value();
    EXPECT_GE(best.angles.convergence_deg, range.low_deg);
    EXPECT_LE(best.angles.convergence_deg, range.high_deg);
  }
}

class SuggestedForMeshes : public testing::TestWithParam<std::size_t> {};

WHOLE_RUNS("SuggestedForMeshes.*", "SuggestedForThoracicSpine.*");

TEST_P(SuggestedForMeshes, WouldBeSignedFor) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const std::unique_ptr<Solid> solid = make_mesh_solid(test::read_in_lps(real), {.voxel_mm = 0.25});
  const Bone bone(bake_solid(*solid, {}, 40.0));
  expect_signed_for(bone, real.name, real.level);
}

INSTANTIATE_TEST_SUITE_P(All, SuggestedForMeshes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

TEST(SuggestedForThoracicSpine, WouldBeSignedForFromT2ToT11) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_spine_ct")
  const CtVolume ct = read_ct(folder / "lidc-0314_spine.nii.gz");
  SpineSegmentation found = segment_spine(ct, {.names = {{level_from_name("T11").value(), Vec3(-9.0, 222.0, -638.0)}}});
  found.labels.names.clear();
  const int uppermost = level_rank(level_from_name("T2").value());
  const int lowermost = level_rank(level_from_name("T11").value());
  for (const LevelReport& report : found.levels) {
    const int rank = level_rank(report.level);
    if (rank >= uppermost && rank <= lowermost) found.labels.names[report.label] = {report.name, report.level};
  }
  BakeLevelsOptions options;
  options.finds_landmarks = false;
  const BakedLevels baked = bake_levels(ct, found.labels, options);
  ASSERT_EQ(baked.levels.size(), 10U);
  for (const BakedLevel& level : baked.levels) {
    expect_signed_for(Bone(level.baked.bone), level_name(level.level), level.level);
  }
}

}  // namespace
}  // namespace spinaltap
