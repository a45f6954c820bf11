// Predicted probabilities of grades against direct simulations, which share neither the draws' generator nor the fast
// breach with the prediction.

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/anatomy/landmarks.h"
#include "core/files/placement_errors_file.h"
#include "core/uncertainty/placement_probabilities.h"
#include "tests/support/planning_bones.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

constexpr std::size_t kSimulations = 20000;

/// Shares of grades of paths that err by a Mersenne twister's normal numbers, graded by breach_mm().
std::array<double, 5> simulated(const WallDistance& walls, const DrillPath& plan, const PlacementErrors& errors) {
  std::vector<DrillPath> paths;
  const ErrorFrame frame = error_frame(walls.landmarks(), plan);
  std::mt19937_64 generator(20261124);
  std::normal_distribution<double> normal;
  for (std::size_t n = 0; n < kSimulations; ++n) {
    std::array<double, 6> normals{};  // the last tells outliers, which these models have none of
    for (std::size_t k = 0; k < 5; ++k) normals[k] = normal(generator);
    paths.push_back(erred_path(plan, frame, error_of(errors, normals)));
  }
  std::vector<std::uint8_t> grades(paths.size());
  // Rings a millimetre apart, as the prediction is told to take.
  tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t n) {
    grades[n] = static_cast<std::uint8_t>(gertzbein_robbins(breach_mm(walls, paths[n], {.step_mm = 1.0})));
  });
  std::array<double, 5> shares{};
  for (const std::uint8_t grade : grades) shares[grade] += 1.0 / static_cast<double>(kSimulations);
  return shares;
}

WHOLE_RUNS("PlacementProbabilitiesOfThePhantom.*");

TEST(PlacementProbabilitiesOfThePhantom, HoldTheSharesOf20000SimulationsInTheirIntervals) {
  const test::PhantomBone phantom;
  const WallDistance walls(phantom.bone, phantom.landmarks);
  for (const char* model : {"robot_726", "freehand_experienced"}) {
    const PlacementErrors errors = placement_errors_of(model);
    for (const PedicleLandmarks& pedicle : {phantom.landmarks.left_pedicle, phantom.landmarks.right_pedicle}) {
      DrillPath plan{"", pedicle.isthmus_mm - 18.0 * pedicle.axis, pedicle.isthmus_mm + 27.0 * pedicle.axis, {}};
      plan.screw = PedicleScrew();
      const GradeProbabilities probabilities = grade_probabilities(walls, plan, errors, {.grade = {.step_mm = 1.0}});
      const std::array<double, 5> shares = simulated(walls, plan, errors);
      for (std::size_t n = 0; n < shares.size(); ++n) {
        const Probability& predicted = probabilities.grades[n];
        std::printf("%s, %c: predicted %.2f %% (%.2f to %.2f), simulated %.2f %%\n", model,
                    letter_of(static_cast<Grade>(n)), 100.0 * predicted.share, 100.0 * predicted.interval.low,
                    100.0 * predicted.interval.high, 100.0 * shares[n]);
        EXPECT_GE(shares[n], predicted.interval.low) << model << " " << n;
        EXPECT_LE(shares[n], predicted.interval.high) << model << " " << n;
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap
