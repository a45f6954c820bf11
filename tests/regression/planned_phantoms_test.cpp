// Phantoms of all kinds through the whole chain: a noisy CT of each is scanned, cut out and baked; landmarks found and
// paths suggested on the baked grids are compared with what the phantom is known to be. Two by default;
// SPINALTAP_PHANTOMS=50 takes fifty, as docs/planning.md does.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "core/phantom/scanner.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/tool/bit_profile.h"
#include "tests/support/random_vertebra.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

int phantoms() {
  const char* const asked = std::getenv("SPINALTAP_PHANTOMS");
  return asked != nullptr ? std::max(1, std::atoi(asked)) : 2;
}

/// The paper's pixels, in a field of view that holds the bone with tissue around it.
CtVolume noisy_ct(const Vertebra& vertebra, std::uint64_t seed) {
  ScanOptions options;
  options.seed = seed;
  const Vec3 size_mm = vertebra.bounds_mm().sizes() + Vec3(16.0, 16.0, 8.0);
  options.columns = static_cast<int>(size_mm.x() / options.pixel_mm);
  options.rows = static_cast<int>(size_mm.y() / options.pixel_mm);
  options.slices = static_cast<int>(size_mm.z() / options.slice_step_mm);
  return scan(vertebra, options);
}

struct PedicleError {
  double isthmus_mm, axis_deg, width_mm;
};

PedicleError error_of(const PedicleLandmarks& found, const PedicleGroundTruth& ground_truth) {
  return {(found.isthmus_mm - ground_truth.isthmus_mm).norm(),
          std::acos(std::clamp(found.axis.dot(ground_truth.axis), -1.0, 1.0)) / kDegree,
          std::abs(found.width_mm - ground_truth.width_mm)};
}

/// How far a screw comes to the ground truth's own surface, beyond its entry opening: least of the solid's value over
/// its thread. Below 0 it breaches.
double min_clearance_mm(const Vertebra& vertebra, const DrillPath& path, double from_mm) {
  constexpr int kAround = 48;
  const Vec3 direction = path.direction();
  const Vec3 beside = any_perpendicular(direction);
  const Vec3 above = direction.cross(beside);
  const BitProfile outline(path.screw->outline());
  double min_mm = std::numeric_limits<double>::infinity();
  for (double depth_mm = from_mm; depth_mm <= path.length_mm(); depth_mm += 0.1) {
    const double back_mm = path.length_mm() - depth_mm;
    const double radius_mm = outline.widest_mm(back_mm, back_mm);
    for (int n = 0; n < kAround; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kAround;
      const Vec3 p =
          path.entry_mm + depth_mm * direction + radius_mm * (std::cos(angle) * beside + std::sin(angle) * above);
      double value_mm = 0.0;
      vertebra.evaluate({&p, 1}, {&value_mm, 1}, {});
      min_mm = std::min(min_mm, -value_mm);
    }
  }
  return min_mm;
}

WHOLE_RUNS("PlannedPhantoms.*");

TEST(PlannedPhantoms, HaveTheirPediclesFoundAndSafePathsSuggested) {
  PedicleError worst{};
  int paths = 0;
  int of_grade_a = 0;
  for (int seed = 1; seed <= phantoms(); ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const Vertebra vertebra(test::random_anatomy(number));
    const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
    const Bone bone(bake_ct(noisy_ct(vertebra, number)).bone);
    for (const bool is_left : {true, false}) {
      const PedicleGroundTruth& pedicle = is_left ? ground_truth.left : ground_truth.right;
      const PedicleError error =
          error_of(is_left ? bone.landmarks().left_pedicle : bone.landmarks().right_pedicle, pedicle);
      worst = {std::max(worst.isthmus_mm, error.isthmus_mm), std::max(worst.axis_deg, error.axis_deg),
               std::max(worst.width_mm, error.width_mm)};
      EXPECT_LE(error.isthmus_mm, 0.5) << "seed " << seed;
      EXPECT_LE(error.axis_deg, 2.0) << "seed " << seed;
      EXPECT_LE(error.width_mm, 0.3) << "seed " << seed;

      // A screw of 80 % of the pedicle's true width, as long as fits.
      std::vector<PedicleScrew> screws;
      for (const double length_mm : {30.0, 35.0, 40.0, 45.0, 50.0}) {
        screws.push_back({"80 %", 0.8 * pedicle.width_mm, length_mm, 4.0});
      }
      SuggestOptions options;
      options.margin_mm = 0.3;
      options.widest_share = 0.85;  // of the width as it was found
      const std::vector<Suggestion> suggestions = suggest_paths(bone.walls(), bone.hu_sampler(), {}, screws, options);
      const Suggestion& suggestion = suggestions[is_left ? 0 : 1];
      ++paths;
      if (!suggestion.best) {
        std::printf("seed %d %s: %s\n", seed, suggestion.side.c_str(), suggestion.rejection.c_str());
        continue;
      }
      const SuggestedPath& best = *suggestion.best;
      const double min_mm = min_clearance_mm(vertebra, best.path, best.grade.entry_end_mm);
      of_grade_a += min_mm >= 0.0 ? 1 : 0;
      std::printf(
          "seed %2d %-5s isthmus %.2f mm, axis %.2f deg, width %.2f mm; screw %.1f x %.0f mm, "
          "clearance found %.2f mm, to the ground truth %.2f mm, canal %.2f mm\n",
          seed, suggestion.side.c_str(), error.isthmus_mm, error.axis_deg, error.width_mm, best.path.screw->diameter_mm,
          best.path.screw->length_mm, best.grade.outer.clearance_mm, min_mm, best.grade.canal.clearance_mm);
      EXPECT_GT(best.grade.canal.clearance_mm, 0.0) << "seed " << seed;
    }
  }
  std::printf("%d phantoms: worst isthmus %.2f mm, axis %.2f degrees, width %.2f mm; %d of %d paths are of grade A\n",
              phantoms(), worst.isthmus_mm, worst.axis_deg, worst.width_mm, of_grade_a, paths);
  EXPECT_GE(of_grade_a, 0.98 * paths);
}

}  // namespace
}  // namespace spinaltap
