#include "core/plan/rod.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kStepMm = 30.0;

/// A path forward whose head's middle is at `head_mm`.
SuggestedPath path_with_head(const Vec3& head_mm, double score) {
  SuggestedPath one;
  PedicleScrew screw;
  const double behind_mm = screw.length_mm + 0.5 * screw.head.length_mm;
  one.path = {"left", head_mm - (behind_mm - screw.length_mm) * Vec3::UnitY(), head_mm - behind_mm * Vec3::UnitY(), {}};
  one.path.screw = screw;
  one.score = score;
  return one;
}

RodHead head_at(const Vec3& p_mm) { return {"", p_mm, Vec3::UnitY()}; }

TEST(Rod, LiesStraightInHeadsOfALine) {
  std::vector<RodHead> heads;
  for (int n = 0; n < 5; ++n) heads.push_back(head_at(Vec3(20.0 + n, 60.0, -kStepMm * n)));
  const RodFit fit = fit_rod(heads);
  EXPECT_NEAR(fit.max_offset_mm(), 0.0, 1e-9);
  EXPECT_GT(fit.min_bend_radius_mm, 1e9);
  ASSERT_EQ(fit.spacing_mm.size(), 4U);
  for (const double mm : fit.spacing_mm) EXPECT_NEAR(mm, std::hypot(1.0, kStepMm), 1e-9);
  for (const double deg : fit.angle_deg) EXPECT_NEAR(deg, 0.0, 1e-5);
}

TEST(Rod, IsBentToTheCircleThatHeadsLieOn) {
  const double radius_mm = 300.0;
  std::vector<RodHead> heads;
  for (int n = -3; n <= 3; ++n) {
    const double angle = 0.06 * n;
    heads.push_back({"", Vec3(20.0, radius_mm * std::cos(angle), -radius_mm * std::sin(angle)),
                     Vec3(0.0, std::cos(angle), -std::sin(angle))});
  }
  const RodFit fit = fit_rod(heads);
  // A parabola instead of a circle: over +-0.18 rad 3 % of its curvature, and the fourth order of 300 mm as offset.
  EXPECT_NEAR(fit.min_bend_radius_mm, radius_mm, 0.03 * radius_mm);
  EXPECT_LT(fit.max_offset_mm(), 0.02);
  for (const double deg : fit.angle_deg) EXPECT_NEAR(deg, 0.06 / kDegree, 1e-6);
}

TEST(Rod, SaysHowFarAHeadStandsAside) {
  std::vector<RodHead> heads;
  for (int n = 0; n < 9; ++n) heads.push_back(head_at(Vec3(20.0, 60.0, -kStepMm * n)));
  heads[4].centre_mm.x() += 5.0;
  const RodFit fit = fit_rod(heads);
  EXPECT_EQ(std::max_element(fit.offset_mm.begin(), fit.offset_mm.end()) - fit.offset_mm.begin(), 4);
  // The leverage of the middle of nine places in a fit of second order is 0.255.
  EXPECT_NEAR(fit.offset_mm[4], 5.0 * (1.0 - 0.2554), 0.01);
}

TEST(Rod, ChoosesTheHeadsThatLieInLineAsBruteForceDoes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> aside(-6.0, 6.0), worth(0.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<std::vector<SuggestedPath>> paths;
    for (int level = 0; level < 5; ++level) {
      paths.emplace_back();
      for (int choice = 0; choice < 3; ++choice) {
        paths.back().push_back(path_with_head(Vec3(aside(random), aside(random), -kStepMm * level), worth(random)));
      }
    }
    std::vector<RodLevel> levels;
    for (const auto& of_level : paths) {
      levels.push_back({"", {}});
      for (const SuggestedPath& one : of_level) levels.back().choices.push_back(&one);
    }
    const auto value = [&](const std::vector<std::size_t>& chosen) {
      double sum = 0.0;
      for (std::size_t n = 0; n < 5; ++n) sum += paths[n][chosen[n]].score;
      for (std::size_t n = 1; n < 4; ++n) {
        const Vec3 a = rod_head(paths[n - 1][chosen[n - 1]].path, "").centre_mm;
        const Vec3 b = rod_head(paths[n][chosen[n]].path, "").centre_mm;
        const Vec3 c = rod_head(paths[n + 1][chosen[n + 1]].path, "").centre_mm;
        sum -= 0.1 * (b - a).cross(c - a).norm() / (c - a).norm();
      }
      return sum;
    };
    double best = -1e9;
    for (std::size_t code = 0; code < 243; ++code) {
      std::vector<std::size_t> chosen;
      for (std::size_t n = 0, rest = code; n < 5; ++n, rest /= 3) chosen.push_back(rest % 3);
      best = std::max(best, value(chosen));
    }
    EXPECT_NEAR(value(choose_for_rod(levels, 0.1)), best, 1e-9) << trial;
  }
}

TEST(Rod, RejectsHeadsThatMakeNone) {
  EXPECT_THROW(fit_rod(std::vector<RodHead>{head_at(Vec3::Zero())}), Error);
  EXPECT_THROW(fit_rod(std::vector<RodHead>{head_at(Vec3::Zero()), head_at(Vec3::Zero())}), Error);
  SuggestedPath headless = path_with_head(Vec3::Zero(), 0.0);
  headless.path.screw->head.diameter_mm = 0.0;
  EXPECT_THROW(rod_head(headless.path, "L1"), Error);
  EXPECT_THROW(choose_for_rod(std::vector<RodLevel>{{"L1", {}}}), Error);
}

}  // namespace
}  // namespace spinaltap
