#include "core/grading/neighbour_contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/grading/grade.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

BoneShape shape_of_ball(const test::Ball& ball) {
  const auto field =
      std::make_shared<test::FormulaField>([ball](const Vec3& p) { return ball.distance_mm(p); },
                                           [ball](const Vec3& p) -> Vec3 { return (p - ball.centre_mm).normalized(); });
  return {field, ball.bounds_mm(), 0.75};
}

/// A screw of 6 mm along y, from 0 to 40 mm; its head stands behind it.
DrillPath screw_path() {
  DrillPath path{"", Vec3::Zero(), Vec3(0.0, 40.0, 0.0), {3.0, 60.0, 1.0}};
  path.screw = PedicleScrew{"", 6.0, 40.0, 4.0};
  return path;
}

TEST(NeighbourContact, IsHowDeepABallLiesInTheScrew) {
  // Ten millimetres of radius beside the axis at 20 mm of depth: what is nearer to the axis than 3 mm lies in the
  // screw.
  for (const auto& [off_mm, expected_mm] : {std::pair{13.5, 0.0}, {12.0, 1.0}, {11.0, 2.0}, {10.0, 3.0}, {8.0, 3.0}}) {
    SCOPED_TRACE(off_mm);
    const BoneShape shape = shape_of_ball({Vec3(0.0, 20.0, off_mm), 10.0});
    const Neighbour neighbour{Level::kL5, &shape};
    const NeighbourContact contact = neighbour_contact({&neighbour, 1}, screw_path());
    // At the axis it hangs on how near to it a place of the surface is known.
    EXPECT_NEAR(contact.depth_mm, expected_mm, off_mm > 10.0 ? 0.1 : BoneShape::kSampleMm);
    if (expected_mm == 0.0) {
      EXPECT_EQ(contact.depth_mm, 0.0);
      continue;
    }
    EXPECT_EQ(contact.part, InstrumentPart::tool);
    EXPECT_EQ(contact.level, Level::kL5);
    // A ball that the axis leaves and enters is met at the axis.
    EXPECT_NEAR(contact.at_mm, 20.0, off_mm < 10.0 ? 6.3 : 1.0);
    EXPECT_NEAR(contact.place_mm.y(), contact.at_mm, 1e-9);
  }
}

TEST(NeighbourContact, IsOfTheDeepestNeighbourAndOfTheHeadToo) {
  const BoneShape beside = shape_of_ball({Vec3(12.5, 20.0, 0.0), 10.0});
  const DrillPath path = screw_path();
  const double head_mm = 0.5 * path.screw->head.diameter_mm;
  // Beside the head's middle, by 1 mm in it.
  const BoneShape behind = shape_of_ball({Vec3(0.0, -8.0, head_mm + 9.0), 10.0});
  const std::vector<Neighbour> both{{Level::kL5, &beside}, {Level::kT12, &behind}};
  const NeighbourContact contact = neighbour_contact(both, path);
  EXPECT_EQ(contact.level, Level::kT12);
  EXPECT_EQ(contact.part, InstrumentPart::head);
  EXPECT_NEAR(contact.depth_mm, 1.0, 0.1);
  EXPECT_LT(contact.at_mm, 0.0);
  const Finding finding = finding_of(contact, path);
  EXPECT_TRUE(finding.is_warning);
  EXPECT_THAT(finding.words, HasSubstr("the screw's head stands 1.0 mm in T12, "));
  EXPECT_THAT(finding.words, HasSubstr(" mm behind the entry"));
  EXPECT_NEAR(neighbour_contact({both.data(), 1}, path).depth_mm, 0.5, 0.1);
}

TEST(NeighbourContact, FollowsABitAlongACurve) {
  // A quarter of a circle of 40 mm from the origin along y: its middle is 11.7 mm off the straight way.
  constexpr double kBendMm = 40.0;
  const auto along_mm = [](double share) {
    const double angle = 0.5 * std::numbers::pi * share;
    return Vec3(0.0, kBendMm * std::sin(angle), kBendMm * (1.0 - std::cos(angle)));
  };
  DrillPath path{"", along_mm(0.0), along_mm(1.0), steerable_head()};
  path.via_mm = {along_mm(0.25), along_mm(0.5), along_mm(0.75)};
  const double half = std::sqrt(0.5);
  const Vec3 out(0.0, half, -half);  // from the circle's middle through the middle of the way
  const BoneShape shape = shape_of_ball({path.via_mm[1] + 11.0 * out, 10.0});
  const Neighbour neighbour{Level::kT12, &shape};
  EXPECT_NEAR(neighbour_contact({&neighbour, 1}, path).depth_mm, 0.5, 0.15);
  path.via_mm.clear();
  EXPECT_EQ(neighbour_contact({&neighbour, 1}, path).depth_mm, 0.0);
}

TEST(NeighbourContact, OfABitBeginsAtTheEntry) {
  const BoneShape behind = shape_of_ball({Vec3(0.0, -11.0, 0.0), 10.0});
  const Neighbour neighbour{Level::kT12, &behind};
  DrillPath path = screw_path();
  path.screw.reset();
  EXPECT_EQ(neighbour_contact({&neighbour, 1}, path).depth_mm, 0.0);
  EXPECT_EQ(neighbour_contact({}, path).depth_mm, 0.0);
  path.target_mm.x() = std::nan("");
  EXPECT_THROW(neighbour_contact({&neighbour, 1}, path), Error);
}

TEST(NeighbourContact, IsNotedInAGradeAmongItsWarnings) {
  const BoneShape shape = shape_of_ball({Vec3(0.0, 20.0, 11.0), 10.0});
  const Neighbour neighbour{Level::kL5, &shape};
  PathGrade grade;
  grade.findings.resize(2);
  grade.findings[0].is_warning = true;
  note_neighbours({&neighbour, 1}, screw_path(), grade);
  ASSERT_EQ(grade.findings.size(), 3U);
  EXPECT_EQ(grade.findings[1].structure, VertebraPart::other_vertebra);
  EXPECT_THAT(grade.findings[1].words, HasSubstr("the screw stands 2.0 mm in L5, "));
  // What is beside it is known, and is none.
  PathGrade untouched;
  const BoneShape far = shape_of_ball({Vec3(0.0, 20.0, 15.0), 10.0});
  const Neighbour other{Level::kL5, &far};
  note_neighbours({&other, 1}, screw_path(), untouched);
  ASSERT_TRUE(untouched.neighbour.has_value());
  EXPECT_EQ(untouched.neighbour->depth_mm, 0.0);
  EXPECT_TRUE(untouched.findings.empty());
}

}  // namespace
}  // namespace spinaltap
