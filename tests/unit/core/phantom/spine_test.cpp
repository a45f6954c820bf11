#include "core/phantom/spine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "tests/support/error_of.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

Level named(const char* name) { return level_from_name(name).value(); }

double spine_value(const Spine& spine, const Vec3& p) {
  double value = 0.0;
  spine.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

Vec3 place_in(const Box3& box, std::uint64_t seed, std::uint64_t n) {
  return box.min() + box.sizes().cwiseProduct(Vec3(random_uniform(seed, 3 * n), random_uniform(seed, 3 * n + 1),
                                                   random_uniform(seed, 3 * n + 2)));
}

/// Pieces of a part, and the Euler number of the union of cubes around its samples (Serra 1982).
struct Topology {
  int pieces = 0;
  long euler = 0;
};

Topology topology_of(const Spine& spine, std::size_t part, double step) {
  const Box3 box = spine.part(part).solid->bounds_mm();
  const Eigen::Vector3i size = (box.sizes() / step).array().ceil().cast<int>().matrix() + Eigen::Vector3i::Constant(3);
  const auto at = [&](int i, int j, int k) { return static_cast<std::size_t>((k * size.y() + j) * size.x() + i); };
  std::vector<char> inside(static_cast<std::size_t>(size.prod()), 0);
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i)
        inside[at(i, j, k)] = spine.part_value_mm(part, box.min() + step * Vec3(i - 1.0, j - 1.0, k - 1.0)) < 0.0;
  Topology found;
  const auto any = [&](int i, int j, int k, int di, int dj, int dk) {
    for (int c = 0; c <= dk; ++c)
      for (int b = 0; b <= dj; ++b)
        for (int a = 0; a <= di; ++a)
          if (inside[at(i - a, j - b, k - c)] != 0) return 1L;
    return 0L;
  };
  for (int k = 1; k < size.z(); ++k)
    for (int j = 1; j < size.y(); ++j)
      for (int i = 1; i < size.x(); ++i)
        found.euler += any(i, j, k, 1, 1, 1) - any(i, j, k, 0, 1, 1) - any(i, j, k, 1, 0, 1) - any(i, j, k, 1, 1, 0) +
                       any(i, j, k, 1, 0, 0) + any(i, j, k, 0, 1, 0) + any(i, j, k, 0, 0, 1) - any(i, j, k, 0, 0, 0);
  const std::array<std::ptrdiff_t, 6> ways{1, -1, size.x(), -size.x(), size.x() * size.y(), -size.x() * size.y()};
  for (std::size_t start = 0; start < inside.size(); ++start) {
    if (inside[start] == 0) continue;
    ++found.pieces;
    std::vector<std::size_t> open{start};
    inside[start] = 0;
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      for (const std::ptrdiff_t way : ways) {  // a layer of outside is all around
        const std::size_t next = cell + static_cast<std::size_t>(way);
        if (inside[next] == 0) continue;
        inside[next] = 0;
        open.push_back(next);
      }
    }
  }
  return found;
}

/// Least sum of two parts' values at places between them, which bounds their distance from below and comes near it.
double sampled_gap_mm(const Spine& spine, std::size_t a, std::size_t b, int count) {
  Box3 box = spine.part(a).solid->bounds_mm();
  const Box3 other = spine.part(b).solid->bounds_mm();
  box = box.intersection(Box3(other.min() - Vec3::Constant(3.0), other.max() + Vec3::Constant(3.0)));
  double min = 1e9;
  if (box.isEmpty()) return min;
  for (int n = 0; n < count; ++n) {
    const Vec3 p = place_in(box, 91, static_cast<std::uint64_t>(n));
    const double first = spine.part_value_mm(a, p), second = spine.part_value_mm(b, p);
    EXPECT_FALSE(first < 0.0 && second < 0.0) << "parts " << a << " and " << b << " overlap at " << p.transpose();
    if (first > 0.0 && second > 0.0) min = std::min(min, first + second);
  }
  return min;
}

SpineOptions whole_spine() {
  SpineOptions options;
  options.first = Level::kT1;
  options.sacrum = true;
  return options;
}

TEST(Spine, HasEachLevelInOnePieceWithOneHole) {
  RELEASE_ONLY();
  SpineOptions options = whole_spine();
  options.ribs = false;
  const Spine spine(options);
  for (std::size_t n = 0; n + 1 < spine.part_count(); ++n) {
    const Topology topology = topology_of(spine, n, 0.75);
    EXPECT_EQ(topology.pieces, 1) << level_name(spine.placed()[n].level);
    EXPECT_EQ(topology.euler, 0) << level_name(spine.placed()[n].level);
  }
}

TEST(Spine, HasEachPedicleExactlyAsWideAndHighAsItsLevelsMeasures) {
  const Spine spine(whole_spine());
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  ASSERT_EQ(ground_truth.levels.size(), 17U);
  for (std::size_t n = 0; n < ground_truth.levels.size(); ++n) {
    const LevelMeasures& m = level_measures(ground_truth.levels[n].level);
    for (const PedicleGroundTruth& side :
         {ground_truth.levels[n].pedicles.left, ground_truth.levels[n].pedicles.right}) {
      EXPECT_EQ(side.width_mm, m.pedicle_width_mm);
      for (const auto& [axis, size_mm] :
           {std::pair(side.width_axis, side.width_mm), {side.height_axis, side.height_mm}}) {
        for (const double sign : {1.0, -1.0}) {
          EXPECT_NEAR(spine.part_value_mm(n, side.isthmus_mm + 0.5 * sign * size_mm * axis), 0.0, 1e-6)
              << level_name(ground_truth.levels[n].level);
        }
      }
    }
  }
}

TEST(Spine, HasLumbarPediclesAmidThePublishedSeries) {
  // Least and greatest means of 13 series of transverse pedicle width, 1987 to 2025 (Makino's endosteal one left out).
  const std::array<std::array<double, 2>, 5> published{
      {{5.76, 10.3}, {6.34, 10.3}, {8.1, 13.0}, {9.3, 16.3}, {11.8, 21.6}}};
  for (int n = 0; n < 5; ++n) {
    const auto level = static_cast<Level>(static_cast<int>(Level::kL1) + n);
    const auto& range = published[static_cast<std::size_t>(n)];
    EXPECT_GT(level_measures(level).pedicle_width_mm, range[0]) << level_name(level);
    EXPECT_LT(level_measures(level).pedicle_width_mm, range[1]) << level_name(level);
  }
}

TEST(Spine, HasTheWidthsOfLevelsAmidThoseMeasuredInCts) {
  // 5th and 95th percentiles of 730 to 800 CTs at each level, T11 to L5: endplate, canal, tip to tip.
  struct Range {
    double low, high;
  };
  const std::array<std::array<Range, 3>, 7> measured{{{{{30.4, 45.4}, {16.4, 24.5}, {44.2, 64.0}}},
                                                      {{{32.9, 48.8}, {19.2, 27.5}, {43.0, 60.2}}},
                                                      {{{34.4, 49.1}, {20.2, 28.2}, {59.4, 87.4}}},
                                                      {{{36.1, 50.4}, {20.5, 28.4}, {68.8, 96.1}}},
                                                      {{{37.2, 53.1}, {21.1, 29.3}, {76.3, 106.2}}},
                                                      {{{38.5, 56.0}, {21.9, 31.6}, {73.1, 102.7}}},
                                                      {{{38.3, 64.8}, {24.2, 36.5}, {79.9, 107.7}}}}};
  SpineOptions options;
  options.first = named("T11");
  options.ribs = false;
  const SpineGroundTruth ground_truth = spine_ground_truth(Spine(options));
  ASSERT_EQ(ground_truth.levels.size(), measured.size());
  for (std::size_t n = 0; n < measured.size(); ++n) {
    const LevelGroundTruth& level = ground_truth.levels[n];
    const PedicleGroundTruth& left = level.pedicles.left;
    const double tips = (level.left_transverse_tip_mm - level.right_transverse_tip_mm).norm();
    const double canal = (left.isthmus_mm - level.pedicles.right.isthmus_mm).norm() - left.width_mm;
    const std::array<double, 3> found{level_measures(level.level).body_width_mm, canal, tips};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GT(found[k], measured[n][k].low) << level_name(level.level) << ", measure " << k;
      EXPECT_LT(found[k], measured[n][k].high) << level_name(level.level) << ", measure " << k;
    }
    EXPECT_NEAR(tips, level_measures(level.level).transverse_span_mm, 2.0) << level_name(level.level);
  }
}

TEST(Spine, KeepsNeighboursApartByTheGapAskedFor) {
  for (const double gap_mm : {0.5, 1.5}) {
    SpineOptions options;
    options.first = named("T10");
    options.facet_gap_mm = gap_mm;
    options.ribs = false;
    const Spine spine(options);
    for (std::size_t n = 0; n + 1 < spine.part_count(); ++n) {
      const double found = sampled_gap_mm(spine, n, n + 1, 60000);
      EXPECT_GE(found, gap_mm - 0.02) << "below " << level_name(spine.placed()[n].level);
      EXPECT_LE(found, gap_mm + 0.4) << "the facets below " << level_name(spine.placed()[n].level) << " do not meet";
    }
  }
}

TEST(Spine, KeepsRibsOffTheVertebraeButNearTheirBodiesAndTransverseProcesses) {
  SpineOptions options;
  options.first = named("T6");
  options.last = named("T9");  // T6 to T9
  options.rib_gap_mm = 0.7;
  const Spine spine(options);
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  for (std::size_t rib = 4; rib < spine.part_count(); ++rib) {
    ASSERT_EQ(spine.part(rib).label, kRibLabel);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_GE(sampled_gap_mm(spine, rib, n, 20000), 0.68);
    const LevelGroundTruth& own = ground_truth.levels[(rib - 4) / 2];
    const Vec3 tip_mm = rib % 2 == 0 ? own.left_transverse_tip_mm : own.right_transverse_tip_mm;
    EXPECT_LT(spine.part_value_mm(rib, tip_mm), 4.0);
    // Out to 60 mm from the midline.
    const Box3 box = spine.part(rib).solid->bounds_mm();
    EXPECT_GT(std::max(std::fabs(box.min().x()), std::fabs(box.max().x())), 60.0);
  }
}

TEST(Spine, HasTheTwelfthRibsOfTheLengthAskedFor) {
  for (const double length_mm : {30.0, 120.0}) {
    SpineOptions options;
    options.first = options.last = Level::kT12;
    options.rib12_mm = length_mm;
    const Spine spine(options);
    ASSERT_EQ(spine.part_count(), 3U);
    // Along a gentle curve the ends lie a little nearer than the length; round ends add half the width.
    const double reach = spine.part(1).solid->bounds_mm().diagonal().norm();
    EXPECT_GT(reach, 0.85 * length_mm);
    EXPECT_LT(reach, length_mm + 22.0);
  }
}

/// Cobb's angle between two levels: between the upper endplate of the one above and the lower one of the other, seen
/// from the front of the upright patient. Above 0: convex to the right.
double cobb_deg(const LevelGroundTruth& above, const LevelGroundTruth& below) {
  const auto tilt_deg = [](const Vec3& normal) {
    return std::atan2(normal.x(), normal.z()) * 180.0 / std::numbers::pi;
  };
  return tilt_deg(above.superior_normal) - tilt_deg(below.inferior_normal);
}

TEST(Spine, BendsByTheCobbAngleAskedFor) {
  for (const double angle_deg : {-25.0, 0.0, 40.0}) {
    SpineOptions options = whole_spine();
    options.ribs = false;
    options.scoliosis_deg = angle_deg;
    const SpineGroundTruth ground_truth = spine_ground_truth(Spine(options));
    // Endplates tilt forward as well, which the view from the front shows by up to a degree and a half.
    EXPECT_NEAR(cobb_deg(ground_truth.levels.front(), ground_truth.levels.back()), angle_deg,
                0.05 * std::fabs(angle_deg) + 0.01);
    // Above 0: the middle stands to the right, which is -x.
    const double middle = ground_truth.levels[8].body_centre_mm.x();
    const double ends =
        0.5 * (ground_truth.levels.front().body_centre_mm.x() + ground_truth.levels.back().body_centre_mm.x());
    if (angle_deg > 0.0) {
      EXPECT_LT(middle, ends - 5.0);
    }
    if (angle_deg < 0.0) {
      EXPECT_GT(middle, ends + 5.0);
    }
  }
}

TEST(Spine, HasTheDiscsAskedFor) {
  SpineOptions options;
  options.first = Level::kL1;
  options.lordosis_deg = 0.0;
  options.lumbar_disc_mm = 6.0;
  for (const DiscGroundTruth& disc : spine_ground_truth(Spine(options)).discs) EXPECT_NEAR(disc.height_mm, 6.0, 0.3);
}

TEST(Spine, HangsItsThoracicSpinousProcessesOverTheNextLevel) {
  const SpineGroundTruth ground_truth = spine_ground_truth(Spine(whole_spine()));
  for (const LevelGroundTruth& level : ground_truth.levels) {
    const Vec3 up = (level.superior_normal + level.inferior_normal).normalized();
    const double drop = up.dot(level.body_centre_mm - level.spinous_tip_mm);
    const int number = static_cast<int>(level.level);
    if (number >= 12 && number <= 16) {
      EXPECT_GT(drop, 25.0) << level_name(level.level);
    }
    if (number >= 20) {
      EXPECT_LT(drop, 25.0) << level_name(level.level);
    }
  }
}

TEST(Spine, GivesTheSameForTheSameSeedAndAnotherForAnother) {
  SpineOptions range;
  range.first = named("T10");
  const Spine a(random_spine_options(5, range)), b(random_spine_options(5, range)), c(random_spine_options(6, range));
  int differ = 0;
  for (std::uint64_t n = 0; n < 500; ++n) {
    const Vec3 p = place_in(a.bounds_mm(), 7, n);
    ASSERT_EQ(spine_value(a, p), spine_value(b, p));
    if (spine_value(a, p) != spine_value(c, p)) ++differ;
  }
  EXPECT_GT(differ, 400);
}

TEST(Spine, MakesRandomPatientsWithExactPedicles) {
  SpineOptions range;
  range.first = Level::kT1;
  // The constructor rejects a spine whose isthmuses are not exact.
  for (std::uint64_t seed = 0; seed < 20; ++seed) EXPECT_NO_THROW(Spine(random_spine_options(seed, range))) << seed;
}

TEST(Spine, ChangesByAtMostOneMillimetrePerMillimetre) {
  SpineOptions options;
  options.first = named("T10");
  options.osteophyte_mm = 4.0;
  options.osteophyte_gap_mm = 0.0;
  const Spine spine(options);
  Box3 box = spine.bounds_mm();
  for (std::uint64_t n = 0; n < 20000; ++n) {
    const Vec3 p = place_in(box, 11, 2 * n);
    const Vec3 direction = (place_in(box, 11, 2 * n + 1) - p).normalized();
    const double step = 0.5 * std::pow(100.0, random_uniform(12, n));
    ASSERT_LE(std::fabs(spine_value(spine, p) - spine_value(spine, p + step * direction)), step * (1.0 + 1e-6))
        << p.transpose();
  }
}

TEST(Spine, BridgesADiscWithSpursThatLeaveNoGap) {
  SpineOptions options;
  options.first = named("L2");
  options.last = named("L3");
  options.osteophyte_mm = 5.0;
  options.osteophyte_share = 1.0;
  options.ribs = false;
  const auto bone_in_disc = [](const SpineOptions& given) {
    const Spine spine(given);
    const DiscGroundTruth disc = spine_ground_truth(spine).discs.front();
    int count = 0;
    for (int step = 0; step < 360; ++step) {
      const double angle = step * kDegree;
      const Vec3 side(0.5 * disc.width_mm * std::cos(angle), 0.5 * disc.depth_mm * std::sin(angle), 0.0);
      if (spine_value(spine, disc.centre_mm + side - side.dot(disc.normal) * disc.normal) < 0.05) ++count;
    }
    return count;
  };
  options.osteophyte_gap_mm = 0.0;
  EXPECT_GT(bone_in_disc(options), 30);
  options.osteophyte_gap_mm = 3.0;
  EXPECT_EQ(bone_in_disc(options), 0);
}

TEST(Spine, HasMetalInThePediclesOfLevelsWithScrews) {
  SpineOptions options;
  options.first = options.last = named("L3");
  options.screws = {named("L3")};
  const Spine spine(options);
  const PedicleGroundTruth pedicle = spine_ground_truth(spine).levels.front().pedicles.left;
  EXPECT_GE(spine.hu(pedicle.isthmus_mm, spine_value(spine, pedicle.isthmus_mm), 0.3), 3000.0);
  EXPECT_EQ(spine.label_at(pedicle.isthmus_mm), static_cast<std::uint8_t>(named("L3")));
}

TEST(Spine, RejectsOptionsWithoutSense) {
  const auto rejection = [](const SpineOptions& options) {
    return test::error_of([&] { const Spine spine(options); });
  };
  SpineOptions options;
  options.first = Level::kL5;
  options.last = Level::kT1;
  EXPECT_NE(rejection(options).find("first must lie above last"), std::string::npos) << rejection(options);
  options = {};
  options.last = named("L3");
  options.sacrum = true;
  EXPECT_NE(rejection(options).find("a sacrum needs L5"), std::string::npos) << rejection(options);
  options = {};
  options.facet_gap_mm = std::nan("");
  EXPECT_NE(rejection(options).find("facet_gap_mm"), std::string::npos) << rejection(options);
}

TEST(TrueLabels, AreThoseOfTheBodyThatHoldsEachVoxel) {
  SpineOptions options;
  options.first = named("T11");
  options.last = Level::kL1;
  const Spine spine(options);
  // A coarse grid, turned, that cuts the ends.
  GridGeometry geometry;
  geometry.size = {40, 36, 30};
  geometry.spacing_mm = Vec3(2.5, 2.5, 3.0);
  geometry.directions = rotation_from_degrees(Vec3(5.0, -8.0, 12.0));
  geometry.origin_mm = spine.bounds_mm().center() - geometry.directions * Vec3(48.0, 40.0, 43.0);
  const LabelVolume volume = true_labels(spine, geometry);
  std::size_t inside = 0;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 36; ++j)
      for (int i = 0; i < 40; ++i) {
        const Vec3 p = geometry.to_patient(Vec3(i, j, k));
        int expected = 0;
        for (std::size_t n = 0; n < spine.part_count(); ++n) {
          if (spine.part_value_mm(n, p) < 0.0) expected = spine.part(n).label;
        }
        ASSERT_EQ(volume.labels[geometry.offset(i, j, k)], expected) << p.transpose();
        inside += expected != 0 ? 1U : 0U;
      }
  EXPECT_GT(inside, 1000U);
  EXPECT_EQ(volume.names.at(19).name, "T12");
  EXPECT_EQ(volume.names.at(kRibLabel).name, "rib");
  const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(true_labels(spine, geometry).labels, volume.labels);
}

TEST(StackedSpine, PutsBodiesAboveEachOtherWithTheGapAskedFor) {
  std::vector<SpinePart> parts;
  for (int n = 0; n < 2; ++n) {
    SpinePart part;
    part.label = static_cast<std::uint8_t>(22 + n);
    part.solid = std::make_shared<const Vertebra>();
    parts.push_back(std::move(part));
  }
  const Spine spine = stacked_spine(std::move(parts), 1.0);
  const double found = sampled_gap_mm(spine, 0, 1, 100000);
  // Surfaces are seen at points 1.5 mm apart.
  EXPECT_GT(found, 0.6);
  EXPECT_LT(found, 1.6);
  EXPECT_GT(spine.part(0).solid->bounds_mm().center().z(), spine.part(1).solid->bounds_mm().center().z() + 20.0);
}

/// A ball that, as a mesh's grid does, knows distances of up to 2.5 mm only.
class NearBall final : public Solid {
 public:
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = std::clamp(points_mm[n].norm() - kRadiusMm, -2.5, 2.5);
      if (!gradients.empty()) gradients[n] = points_mm[n].normalized();
    }
  }
  // Wider than the ball: the gap is not that of bounds.
  Box3 bounds_mm() const override { return {Vec3::Constant(-kRadiusMm - 6.0), Vec3::Constant(kRadiusMm + 6.0)}; }
  double hu(const Vec3&, double, double) const override { return 300.0; }

  static constexpr double kRadiusMm = 12.0;
};

TEST(StackedSpine, KeepsAGapThatIsWiderThanTheReachOfTheBodiesDistances) {
  for (const double gap_mm : {1.0, 4.0, 8.0}) {
    std::vector<SpinePart> parts(2);
    for (std::uint8_t n = 0; n < 2; ++n) {
      parts[n].label = static_cast<std::uint8_t>(22 + n);
      parts[n].solid = std::make_shared<const NearBall>();
    }
    const Spine spine = stacked_spine(std::move(parts), gap_mm);
    const Vec3 step_mm = spine.part(0).solid->bounds_mm().center() - spine.part(1).solid->bounds_mm().center();
    // Surfaces are seen at points 1.5 mm apart.
    EXPECT_NEAR(step_mm.norm(), 2.0 * NearBall::kRadiusMm + gap_mm, 0.3) << gap_mm << " mm asked for";
  }
}

}  // namespace
}  // namespace spinaltap
