#include "core/grading/path_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr double kBandMm = 0.75;  // as grids of 0.25 mm keep it

/// As a baked grid tells it: clamped at the band.
PathCheckBone checked(const ScalarField& solid, const Box3& bounds_mm) {
  return {[&solid](std::span<const Vec3> points_mm, std::span<float> distance_mm) {
            std::vector<double> values(points_mm.size());
            solid.evaluate(points_mm, values, {});
            std::ranges::transform(values, distance_mm.begin(), [](double value) {
              return static_cast<float>(std::clamp(value, -kBandMm, kBandMm));
            });
          },
          kBandMm, bounds_mm};
}

/// A block of bone: its distance is right outside its edges' corners, and its faces are plane.
class SolidBlock final : public ScalarField {
 public:
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    std::ranges::transform(points_mm, values_mm.begin(), [](const Vec3& p) {
      return std::max({std::abs(p.x()) - 20.0, std::abs(p.y() - 50.0) - 20.0, std::abs(p.z()) - 20.0});
    });
  }
  static Box3 bounds_mm() { return {Vec3(-20.0, 30.0, -20.0), Vec3(20.0, 70.0, 20.0)}; }
};

/// The phantom's L3 with the paths along its pedicles' axes.
class PathOnVertebra : public ::testing::Test {
 protected:
  Vertebra vertebra_;
  VertebraGroundTruth truth_ = vertebra_ground_truth(vertebra_);
  DrillPath left_{"left", truth_.left.entry_mm, truth_.left.target_mm, {}};
  DrillPath right_{"right", truth_.right.entry_mm, truth_.right.target_mm, {}};
  Landmarks marks_;
  int asked_ = 0;

  PathCheckBone bone() {
    PathCheckBone bone = checked(vertebra_, vertebra_.bounds_mm());
    bone.landmarks = [this] {
      ++asked_;
      return &marks_;
    };
    return bone;
  }
  PathCheck check(const DrillPath& path, const PathCheckOptions& options = {}) {
    return check_path_on_bone(path, bone(), options);
  }
  static DrillPath changed(DrillPath path, const std::function<Vec3(const Vec3&)>& change) {
    path.entry_mm = change(path.entry_mm);
    path.target_mm = change(path.target_mm);
    return path;
  }
};

TEST_F(PathOnVertebra, SaysNothingOfPathsThatFitAndAsksForNoLandmarks) {
  for (const DrillPath& path : {left_, right_}) EXPECT_THAT(check(path).faults, IsEmpty()) << path.name;
  EXPECT_EQ(asked_, 0);
}

TEST_F(PathOnVertebra, KnowsALineFromTheTargetToTheEntry) {
  DrillPath path = left_;
  std::swap(path.entry_mm, path.target_mm);
  const PathCheck found = check(path);
  ASSERT_FALSE(found.fits());
  EXPECT_THAT(found.faults.front(), HasSubstr("inside the bone"));
  EXPECT_THAT(found.likely_cause, HasSubstr("swapped"));
  EXPECT_THAT(found.words(path), StartsWith("path \"left\": "));
}

TEST_F(PathOnVertebra, KnowsRasTypedForLps) {
  for (const DrillPath& path : {left_, right_}) {
    const PathCheck found = check(changed(path, [](const Vec3& p) { return Vec3(-p.x(), -p.y(), p.z()); }));
    ASSERT_FALSE(found.fits()) << path.name;
    EXPECT_THAT(found.likely_cause, HasSubstr("RAS")) << path.name;
    EXPECT_THAT(found.likely_cause, HasSubstr("x and y negated")) << path.name;
  }
}

TEST_F(PathOnVertebra, KnowsRasThatIsSwappedTooAndOtherUnitsAndOrders) {
  DrillPath both = changed(left_, [](const Vec3& p) { return Vec3(-p.x(), -p.y(), p.z()); });
  std::swap(both.entry_mm, both.target_mm);
  EXPECT_THAT(check(both).likely_cause, HasSubstr("swapped"));
  EXPECT_THAT(check(both).likely_cause, HasSubstr("RAS"));
  EXPECT_THAT(check(changed(left_, [](const Vec3& p) { return Vec3(0.1 * p); })).likely_cause, HasSubstr("cm"));
  EXPECT_THAT(check(changed(left_, [](const Vec3& p) { return Vec3(p.z(), p.y(), p.x()); })).likely_cause,
              HasSubstr("z, y, x"));
}

TEST_F(PathOnVertebra, NamesNoCauseForAPathOfAnotherLevel) {
  const PathCheck found = check(changed(left_, [](const Vec3& p) { return Vec3(p + Vec3(0.0, 0.0, 120.0)); }));
  ASSERT_FALSE(found.fits());
  EXPECT_THAT(found.faults.front(), HasSubstr("misses the bone"));
  EXPECT_THAT(found.words(left_), HasSubstr("another level"));
  EXPECT_THAT(found.likely_cause, IsEmpty());
}

TEST_F(PathOnVertebra, TakesAPathFromTheFrontOnlyWhereThatIsMeant) {
  // Straight back through the front of the body, from its surface: what is in front of the target on the axis.
  DrillPath path = left_;
  path.entry_mm = path.target_mm;
  marks_.origin_mm = path.target_mm + Vec3(0.0, 20.0, 0.0);
  const PathCheckBone whole = bone();
  float value = -1.0F;
  while (value < 0.0F) {
    path.entry_mm.y() -= 0.25;
    whole.distance({&path.entry_mm, 1}, {&value, 1});
  }
  const PathCheck found = check(path);
  ASSERT_EQ(found.faults.size(), 1U) << path.entry_mm.transpose();
  EXPECT_THAT(found.faults.front(), HasSubstr("from its front"));
  EXPECT_TRUE(check(path, {.from_the_front = true}).fits());
  path.bit = plate_bit(10.0, 1.0, 40.0);
  EXPECT_TRUE(check(path).fits());  // plates cut from any side
}

TEST(PathOnBlock, AllowsTwoMillimetresOffTheSurfaceToEitherSide) {
  const SolidBlock block;
  const PathCheckBone bone = checked(block, SolidBlock::bounds_mm());
  const auto off = [&](double outward_mm) {
    const DrillPath path{"p", Vec3(3.0, 70.0 + outward_mm, -2.0), Vec3(3.0, 45.0, -2.0), {}};
    return check_path_on_bone(path, bone);
  };
  for (const double mm : {-1.9, -1.0, -0.3, 0.0, 0.3, 1.0, 1.9}) EXPECT_TRUE(off(mm).fits()) << mm;
  for (const double mm : {-2.2, -5.0, 2.2, 5.0, 25.0}) EXPECT_FALSE(off(mm).fits()) << mm;
  EXPECT_THAT(off(-5.0).faults.front(), HasSubstr("inside the bone, 5"));
  EXPECT_THAT(off(5.0).faults.front(), HasSubstr("lies 5"));
}

TEST(PathOnBlock, AllowsBurrsAndPlatesWhatTheyReachBesideTheirAxes) {
  const SolidBlock block;
  const PathCheckBone bone = checked(block, SolidBlock::bounds_mm());
  DrillPath path{"p", Vec3(3.0, 74.0, -2.0), Vec3(3.0, 45.0, -2.0), {}};
  EXPECT_FALSE(check_path_on_bone(path, bone).fits());
  path.bit = {6.0, 20.0, 3.0, BitShape::round_burr};
  EXPECT_TRUE(check_path_on_bone(path, bone).fits());
  path.bit = plate_bit(12.0, 1.0, 40.0);
  EXPECT_TRUE(check_path_on_bone(path, bone).fits());
}

TEST(PathOnBlock, SaysWhereAPathLeadsOutOfTheBone) {
  const SolidBlock block;
  const DrillPath path{"out", Vec3(0.0, 50.0, 0.0), Vec3(0.0, 80.0, 0.0), {}};
  const PathCheck found = check_path_on_bone(path, checked(block, SolidBlock::bounds_mm()));
  ASSERT_FALSE(found.fits());
  EXPECT_THAT(found.faults.front(), HasSubstr("leads out of the bone"));
}

}  // namespace
}  // namespace spinaltap
