// Real lumbar vertebrae from a CT to landmarks by our own segmentation: each scanned alone, and stacked. Everything is
// compared with the meshes that were scanned. SPINALTAP_SPINES=1 takes all meshes, and larger stacks too. See
// tests/support/test_data.h for where they lie.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/base/error.h"
#include "core/phantom/scanner.h"
#include "core/phantom/spine.h"
#include "core/phantom/true_labels.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/mesh_landmarks.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "tests/support/true_mask.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bake_levels.h"

namespace spinaltap {
namespace {

// A voxel's outer half more or less all over these bones is Dice 0.94.
constexpr double kMinDice = 0.95;

/// A mesh as a part of a spine.
SpinePart part_of(const TriangleMesh& mesh, Level level) {
  SpinePart part;
  part.label = static_cast<std::uint8_t>(level);
  part.solid = make_mesh_solid(mesh, {.voxel_mm = 0.3});
  return part;
}

/// In soft tissue of 40 HU, as the phantom command scans meshes; air and other bone are not near.
CtVolume scan_coarsely(const Spine& spine) {
  constexpr double kMarginMm = 15.0;
  ScanOptions options;
  options.pixel_mm = 0.7;
  options.slice_step_mm = 1.0;
  options.slice_width_mm = 1.0;
  options.samples_per_pixel = 1;
  Box3 box = spine.bounds_mm();
  box.min() -= Vec3::Constant(kMarginMm);
  box.max() += Vec3::Constant(kMarginMm);
  return scan(spine, scan_of_box(box, options));
}

BakeCtOptions coarse_bake() {
  BakeCtOptions options;
  options.rbf.spacing_mm = 1.2;
  options.bake.voxel_mm = 0.5;
  return options;
}

Landmarks landmarks_of(const BoneModel& bone) {
  return find_landmarks(BoneShape(std::make_shared<BoneField>(bone), bone.bounds_mm(), bone.voxel_mm()));
}

void print(const BoneMask& found, const BoneMask& ground_truth, const LevelReport& report) {
  std::printf("  Dice %.3f, surface %.2f mm, severity %.2f; body %.1f x %.1f x %.1f mm\n",
              test::dice(found, ground_truth), test::mean_surface_distance_mm(found, ground_truth), report.severity,
              report.body_size_mm.x(), report.body_size_mm.y(), report.body_size_mm.z());
  for (const LevelWarning& warning : report.warnings) {
    std::printf("    %.2f: %s\n", warning.severity, warning.text.c_str());
  }
}

bool all_asked_for() { return std::getenv("SPINALTAP_SPINES") != nullptr; }

WHOLE_RUNS("SegmentRealMeshes.*");

class SegmentRealMeshes : public testing::TestWithParam<std::size_t> {};

TEST_P(SegmentRealMeshes, AloneGiveTheirLandmarks) {
  constexpr std::size_t kOneIn = 4;  // each takes ten seconds
  if (GetParam() % kOneIn != 0 && !all_asked_for()) GTEST_SKIP() << "set SPINALTAP_SPINES to take all ten";
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const TriangleMesh mesh = test::read_in_lps(real);
  std::vector<SpinePart> parts;
  parts.push_back(part_of(mesh, real.level));
  const Spine spine(std::move(parts));
  const CtVolume ct = scan_coarsely(spine);
  const Segmentation found = segment_vertebra(ct);
  std::printf("%s, alone\n", real.name);
  const BoneMask ground_truth = test::true_mask(spine, 0, ct.geometry);
  print(found.mask, ground_truth, found.report);
  EXPECT_GE(test::dice(found.mask, ground_truth), kMinDice);
  EXPECT_FALSE(found.report.is_cut);
  EXPECT_FALSE(found.report.reaches_border);
  const BakedCt baked = bake_mask(ct, {found.mask, "found", real.level, std::nullopt}, coarse_bake());
  const Landmarks landmarks = landmarks_of(baked.bone);
  test::expect_landmarks_of(mesh, landmarks);
  test::expect_usual(landmarks);
}

INSTANTIATE_TEST_SUITE_P(All, SegmentRealMeshes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

TriangleMesh moved(TriangleMesh mesh, const Vec3& by_mm) {
  for (Eigen::Vector3f& p : mesh.vertices_mm) p += by_mm.cast<float>();
  return mesh;
}

/// Meshes above each other, under the names of levels.
struct Stack {
  std::vector<test::RealMesh> real;
  std::vector<TriangleMesh> meshes;  ///< where they were scanned
  std::unique_ptr<Spine> spine;
};

/// From L1 down. `gap_mm`: between each two; nothing: as they stand in their files.
Stack stack_of(const std::vector<std::string>& names, const std::optional<double>& gap_mm) {
  Stack stack;
  std::vector<SpinePart> parts;
  std::vector<Vec3> stood_mm;
  Level level = Level::kL1;
  for (const std::string& name : names) {
    for (const test::RealMesh& real : test::real_meshes()) {
      if (real.name != name) continue;
      stack.real.push_back(real);
      stack.meshes.push_back(test::read_in_lps(real));
      parts.push_back(part_of(stack.meshes.back(), level));
      stood_mm.push_back(parts.back().solid->bounds_mm().min());
    }
    level = level_below(level);
  }
  stack.spine = std::make_unique<Spine>(gap_mm ? stacked_spine(std::move(parts), *gap_mm) : Spine(std::move(parts)));
  for (std::size_t n = 0; n < stack.meshes.size(); ++n) {
    stack.meshes[n] = moved(stack.meshes[n], stack.spine->part(n).solid->bounds_mm().min() - stood_mm[n]);
  }
  return stack;
}

/// The found levels under the names of the vertebrae that most of them belongs to, as a user would name them.
LabelVolume named_by_ground_truth(const SpineSegmentation& found, const LabelVolume& ground_truth) {
  LabelVolume named{found.labels.geometry, std::vector<std::uint8_t>(found.labels.labels.size(), 0), {}};
  for (const LevelReport& report : found.levels) {
    std::array<std::size_t, 256> counts{};
    for (std::size_t v = 0; v < ground_truth.labels.size(); ++v) {
      if (found.labels.labels[v] == report.label) ++counts[ground_truth.labels[v]];
    }
    const auto max = std::max_element(counts.begin() + 1, counts.end());
    const int label = static_cast<int>(max - counts.begin());
    if (*max == 0 || named.names.contains(label)) continue;
    named.names[label] = ground_truth.names.at(label);
    for (std::size_t v = 0; v < ground_truth.labels.size(); ++v) {
      if (found.labels.labels[v] == report.label) named.labels[v] = static_cast<std::uint8_t>(label);
    }
  }
  return named;
}

const LevelReport* report_near(const SpineSegmentation& found, const LabelVolume& named, int label) {
  for (const LevelReport& report : found.levels) {
    for (std::size_t v = 0; v < named.labels.size(); ++v) {
      if (named.labels[v] == label && found.labels.labels[v] == report.label) return &report;
    }
  }
  return nullptr;
}

/// How many come out right, with their landmarks. The others must be told.
std::size_t right_of(const Stack& stack) {
  const CtVolume ct = scan_coarsely(*stack.spine);
  const SpineSegmentation found = segment_spine(ct);
  const LabelVolume named = named_by_ground_truth(found, true_labels(*stack.spine, ct.geometry));
  const BakedLevels baked = bake_levels(ct, named, {.bake = coarse_bake(), .warnings = {}, .finds_landmarks = false});
  const bool any_suspect =
      std::any_of(found.levels.begin(), found.levels.end(), [](const LevelReport& r) { return r.is_suspect(); });
  EXPECT_LE(found.levels.size(), stack.meshes.size());
  std::size_t right = 0;
  for (std::size_t n = 0; n < stack.meshes.size(); ++n) {
    const int label = stack.spine->part(n).label;
    const std::string name = level_name(static_cast<Level>(label));
    SCOPED_TRACE(name);
    std::printf("%s, stacked as %s\n", stack.real[n].name, name.c_str());
    const LevelReport* const report = report_near(found, named, label);
    const auto bone = std::find_if(baked.levels.begin(), baked.levels.end(),
                                   [&](const BakedLevel& one) { return static_cast<int>(one.level) == label; });
    if (report == nullptr || bone == baked.levels.end()) {
      std::printf("  missing\n");
      EXPECT_TRUE(any_suspect) << "missing, and nothing says so";
      continue;
    }
    const BoneMask mask = mask_of(named, label), ground_truth = test::true_mask(*stack.spine, n, ct.geometry);
    print(mask, ground_truth, *report);
    if (test::dice(mask, ground_truth) < kMinDice) {
      EXPECT_TRUE(report->is_suspect()) << "wrong, and nothing says so";
      continue;
    }
    Landmarks landmarks;
    try {
      landmarks = landmarks_of(bone->baked.bone);
    } catch (const Error& error) {  // which a user sees too
      std::printf("    %s\n", error.what());
      continue;
    }
    ++right;
    test::expect_landmarks_of(stack.meshes[n], landmarks);
    for (const std::string& warning : landmarks.warnings) std::printf("    %s\n", warning.c_str());
  }
  return right;
}

WHOLE_RUNS("SegmentStackedMeshes.*");

TEST(SegmentStackedMeshes, OfOnePersonGiveTheirLandmarks) {
  if (!all_asked_for()) GTEST_SKIP() << "set SPINALTAP_SPINES; by default they are taken as they stand";
  SPINALTAP_NEED_TEST_DATA(folder, "lumbar_meshes")
  EXPECT_EQ(right_of(stack_of({"L1 of VHM", "L2 of VHM"}, 1.0)), 2U);
}

TEST(SegmentStackedMeshes, OfOnePersonAsTheyStandGiveTheirLandmarks) {
  SPINALTAP_NEED_TEST_DATA(folder, "lumbar_meshes")
  EXPECT_EQ(right_of(stack_of({"L1 of VHM", "L2 of VHM"}, std::nullopt)), 2U);
}

// Not reached: L4's canal is 2.8 mm narrower than its mesh's; all else is.
TEST(SegmentStackedMeshes, DISABLED_OfAWholeLumbarSpineAsItStandsGiveTheirLandmarks) {
  SPINALTAP_NEED_TEST_DATA(folder, "lumbar_meshes")
  EXPECT_EQ(right_of(stack_of({"L1 of VHM", "L2 of VHM", "L3 of VHM", "L4 of VHM", "L5 of VHM"}, std::nullopt)), 5U);
}

// Arches that do not belong together keep bodies apart by more than discs do, and one row of bodies does not reach
// across: what is beyond is missing.
TEST(SegmentStackedMeshes, ThatStandFarApartAreRightOrTold) {
  SPINALTAP_NEED_TEST_DATA(folder, "lumbar_meshes")
  EXPECT_GE(right_of(stack_of({"L1 of 010", "L1 of 013"}, 1.0)), 1U);
  if (!all_asked_for()) return;
  EXPECT_GE(right_of(stack_of({"L1 of 010", "L1 of 013", "L1 of 016", "L1 of 018", "L1 of 022"}, 1.0)), 1U);
  EXPECT_GE(right_of(stack_of({"L1 of VHM", "L2 of VHM", "L4 of VHM", "L5 of VHM"}, 1.0)), 1U);
}

}  // namespace
}  // namespace spinaltap
