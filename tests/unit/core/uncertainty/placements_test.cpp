// Compiled with optimisation: long loops of its own.
// Screws placed by hand in bones of boxes and capsules, where breaches, contacts and grades follow from geometry.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/grading/grade.h"
#include "core/points/material.h"
#include "tests/support/planning_bones.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using test::Block;

constexpr double kPlacedMm = 0.05;
constexpr double kThreadRadiusMm = 3.0;
constexpr double kCapsuleMm = 3.0, kRidgeMm = 2.0;
const Vec3 kProcess(18.0, 23.0, 29.0);  // the upper end of the articular process' middle line; its tip is 3 mm higher
const Vec3 kRidge(18.0, 60.0, -8.0);    // behind the screw's head, along x

/// The block with articular processes, which stand behind its back, and ridges in the way of what comes from behind.
double with_processes_mm(const Vec3& p) {
  double value_mm = Block::value_mm(p);
  for (const double side : {1.0, -1.0}) {
    const Vec3 mirror(side, 1.0, 1.0);
    value_mm = std::min(value_mm, test::capsule_distance_mm(p, mirror.cwiseProduct(Vec3(18.0, 23.0, 10.0)),
                                                            mirror.cwiseProduct(kProcess), kCapsuleMm));
    value_mm =
        std::min(value_mm, test::capsule_distance_mm(p, mirror.cwiseProduct(kRidge) - 8.0 * Vec3::UnitX(),
                                                     mirror.cwiseProduct(kRidge) + 8.0 * Vec3::UnitX(), kRidgeMm));
  }
  return value_mm;
}

/// The block with its back edges cut off: 4 mm from each side, 6 mm deep.
double notched_mm(const Vec3& p) {
  const double notch_mm =
      test::box_distance_mm(Vec3(std::abs(p.x()), p.y(), p.z()), Vec3(36.0, 24.0, 0.0), Vec3(10.0, 10.0, 40.0));
  return std::max(Block::value_mm(p), -notch_mm);
}

struct Bones {
  Block block;
  test::FormulaBone processes{with_processes_mm, Box3(Vec3(-31, -21, -19), Vec3(31, 63, 33)), Block::kHoleMm,
                              Block::kPedicleMm};
  test::FormulaBone notched{notched_mm, Box3(-Block::half(), Block::half()), Block::kHoleMm, Block::kPedicleMm};
  WallDistance in_block{block.bone(), block.landmarks()};
  WallDistance in_processes{processes.bone(), processes.landmarks()};
  WallDistance in_notched{notched.bone(), notched.landmarks()};
};

class Placements : public ::testing::Test {
 protected:
  static const Bones& bones() {
    static const Bones made;
    return made;
  }

  /// Straight forward from the back at x and z to y. A screw of 6 mm whose head does not count.
  static DrillPath placed(double x_mm, double z_mm, double to_y_mm = -12.0) {
    DrillPath path{"", Vec3(x_mm, Block::kHalfDepthMm, z_mm), Vec3(x_mm, to_y_mm, z_mm), {}};
    path.screw = PedicleScrew{"", 2.0 * kThreadRadiusMm, path.length_mm(), 4.0};
    path.screw->head = {0.0, 0.0, 0.0, 0.0, 0.0};
    return path;
  }
  static PathGrade grade(const WallDistance& walls, const DrillPath& path) {
    const HuSampler hu = [](std::span<const Vec3>, std::span<float> values) {
      std::fill(values.begin(), values.end(), 300.0F);
    };
    return grade_path(walls, hu, Material(), path);
  }
  static const Finding* of_part(const PathGrade& graded, InstrumentPart part) {
    for (const Finding& finding : graded.instrument.findings) {
      if (finding.part == part) return &finding;
    }
    return nullptr;
  }
};

SLOW_TESTS("Placements.*");

TEST_F(Placements, BreachToAllSidesByAllGrades) {
  struct Expected {
    double breach_mm;
    Grade grade;
    char rampersaud;
  };
  const std::vector<Expected> steps{{-0.4, Grade::A, 'A'}, {0.4, Grade::B, 'B'}, {1.9, Grade::B, 'B'},
                                    {2.1, Grade::C, 'C'},  {3.8, Grade::C, 'C'}, {4.2, Grade::D, 'D'},
                                    {6.2, Grade::E, 'D'}};
  int placements = 0;
  for (const double side : {1.0, -1.0}) {
    for (const auto& [breach_mm, letter, scale] : steps) {
      struct Case {
        DrillPath path;
        PathSide side;
        bool is_canal;
        Heary heary;
      };
      const double inward_mm = Block::kHoleMm + kThreadRadiusMm - breach_mm;  // the canal is met at y = 0
      std::vector<Case> cases{
          {placed(side * (Block::kHalfWidthMm - kThreadRadiusMm + breach_mm), 0.0), PathSide::lateral, false,
           breach_mm < kThreadRadiusMm ? Heary::II : Heary::III},
          {placed(side * 18.0, Block::kHalfHeightMm - kThreadRadiusMm + breach_mm), PathSide::cranial, false,
           Heary::IV},
          {placed(side * 18.0, -(Block::kHalfHeightMm - kThreadRadiusMm + breach_mm)), PathSide::caudal, false,
           Heary::IV},
          {placed(side * 18.0, 0.0, -(Block::kHalfDepthMm + breach_mm)), PathSide::anterior, false, Heary::III},
          {placed(side * inward_mm, 0.0), PathSide::medial, true, breach_mm >= 4.0 ? Heary::V : Heary::IV}};
      for (const Case& one : cases) {
        const PathGrade graded = grade(bones().in_block, one.path);
        SCOPED_TRACE(std::string(name_of(one.side)) + " by " + std::to_string(breach_mm) +
                     (side > 0.0 ? "" : ", right"));
        ++placements;
        EXPECT_NEAR(graded.breach_mm, std::max(0.0, breach_mm), kPlacedMm);
        EXPECT_EQ(graded.grade, letter);
        EXPECT_EQ(graded.rampersaud, scale);
        // The block's back above its pedicles is that of its articular processes; the highest screws do not touch it.
        EXPECT_EQ(graded.facet, one.side == PathSide::cranial && breach_mm < 6.0 ? 1 : 0);
        const Approach& approach = one.is_canal ? graded.canal : graded.outer;
        EXPECT_NEAR(approach.clearance_mm, -breach_mm, kPlacedMm);
        if (breach_mm < 0.0) {
          EXPECT_EQ(graded.heary, Heary::I);
          EXPECT_TRUE(graded.findings.empty());
          continue;
        }
        EXPECT_EQ(graded.heary, one.heary);
        EXPECT_EQ(graded.breach_side, one.side);
        EXPECT_EQ(graded.breaches_canal, one.is_canal);
        ASSERT_FALSE(graded.findings.empty());
        EXPECT_TRUE(graded.findings.front().is_warning);
        EXPECT_NE(graded.findings.front().words.find(name_of(one.side)), std::string::npos);
      }
    }
  }
  EXPECT_EQ(placements, 70);
}

TEST_F(Placements, CountWhatStandsOutBeyondTheEntryOpening) {
  // Beside the cut-off edge the screw stands 2 mm out of bone until the edge's front, 6 mm deep. The opening of a screw
  // of 3 mm radius ends at 4.1 mm, the next section is at 4.25 mm: 1.75 mm from the front.
  for (const double side : {1.0, -1.0}) {
    const PathGrade graded = grade(bones().in_notched, placed(side * 25.0, 0.0));
    EXPECT_EQ(graded.grade, Grade::B);
    EXPECT_NEAR(graded.breach_mm, 1.5, kPlacedMm);
    EXPECT_NEAR(graded.opening_end_mm, 4.5, 1e-9);
    EXPECT_NEAR(graded.bearing_mm, 6.25, 0.26);
    EXPECT_LT(graded.outer.clearance_mm, 0.0);
  }
}

TEST_F(Placements, ForgiveTheOpeningOfASurfaceThatSlants) {
  // Into the block's back at an angle: the section's last place enters at r tan(angle).
  for (const double slant_deg : {20.0, 35.0, 48.0}) {
    DrillPath path = placed(18.0, 0.0);
    const double angle = slant_deg * kDegree;
    path.entry_mm.z() = 14.0;
    path.target_mm = path.entry_mm + 26.0 * Vec3(0.0, -std::cos(angle), -std::sin(angle));
    const PathGrade graded = grade(bones().in_block, path);
    EXPECT_EQ(graded.grade, Grade::A) << slant_deg;
    EXPECT_NEAR(graded.entry_slant_deg, slant_deg, 1.0);
    EXPECT_NEAR(graded.bearing_mm, kThreadRadiusMm * std::tan(angle), 0.26);
    const bool is_said = slant_deg > 30.0;
    EXPECT_EQ(graded.findings.size(), is_said ? 1U : 0U);
    if (is_said) {
      EXPECT_EQ(graded.findings.front().is_warning, slant_deg > 45.0);
    }
  }
}

TEST_F(Placements, MeasureAHeadInTheArticularProcess) {
  // Below the process the head's ball, whose middle is 6.25 mm behind the entry, comes as near as the process' lower
  // end lets it: a ball of 3 mm about (18, 23, 10).
  for (const double z_mm : {0.0, 1.5, 3.0, 4.5}) {
    for (const double side : {1.0, -1.0}) {
      DrillPath path = placed(side * 18.0, z_mm);
      path.screw->head = {12.5, 15.0, 0.0, 0.0, 0.0};
      const PathGrade graded = grade(bones().in_processes, path);
      const double clearance_mm = std::hypot(10.0 - z_mm, 3.25) - kCapsuleMm - 6.25;
      SCOPED_TRACE(z_mm);
      // The head also rests on the block's back, which its underside touches.
      EXPECT_NEAR(graded.instrument.head_clearance_mm, std::min(0.0, clearance_mm), kPlacedMm);
      const Finding* found = of_part(graded, InstrumentPart::head);
      if (clearance_mm > -kTouchMm) {
        EXPECT_EQ(found, nullptr);
      } else {
        ASSERT_NE(found, nullptr);
        EXPECT_NEAR(found->depth_mm, -clearance_mm, kPlacedMm);
        EXPECT_EQ(found->is_warning, -clearance_mm > kSeatMm);
        EXPECT_EQ(found->structure, VertebraPart::superior_articular_process);
      }
      // From z = 3 mm on the block's back is its articular processes', which the thread pierces.
      EXPECT_EQ(graded.facet, z_mm > 0.0 ? 1 : 0);
      EXPECT_EQ(graded.grade, Grade::A);
    }
  }
}

TEST_F(Placements, MeasureAHeadOnTheJoint) {
  // The joint's lowest place behind the process: 11 mm from its tip.
  const double lowest_mm = kProcess.z() + kCapsuleMm - std::sqrt(11.0 * 11.0 - kCapsuleMm * kCapsuleMm);
  for (const double z_mm : {14.0, 15.7, 16.7, 17.2}) {
    DrillPath path = placed(18.0, z_mm);
    path.screw->diameter_mm = 2.0;
    path.screw->head = {12.5, 15.0, 0.0, 0.0, 0.0};
    const PathGrade graded = grade(bones().in_processes, path);
    const double depth_mm = 6.25 - std::hypot(lowest_mm - z_mm, 0.25);
    SCOPED_TRACE(z_mm);
    // The joint's border is known to a sample, 0.25 mm.
    EXPECT_NEAR(graded.instrument.joint_depth_mm, std::max(0.0, depth_mm), 0.26);
    EXPECT_EQ(graded.facet, depth_mm > 1.0 ? 3 : depth_mm > 0.0 ? 2 : 1);
  }
}

TEST_F(Placements, MeasureTheWayInThroughBoneBehindTheEntry) {
  // The ridge lies 40 mm behind; its lower and upper edges are 2 mm from its middle at z = -8.
  for (const double off_mm : {4.4, 4.0, 3.0, 2.0, 0.0, -4.0, -5.5}) {
    const PathGrade graded = grade(bones().in_processes, placed(18.0, kRidge.z() + off_mm));
    const double cut_mm = std::min(kThreadRadiusMm, kThreadRadiusMm + kRidgeMm - std::abs(off_mm));
    SCOPED_TRACE(off_mm);
    EXPECT_NEAR(graded.instrument.cut_behind_mm, std::max(0.0, cut_mm), kPlacedMm);
    const Finding* found = of_part(graded, InstrumentPart::way_in);
    if (cut_mm < kTouchMm) {
      EXPECT_EQ(found, nullptr);
      continue;
    }
    ASSERT_NE(found, nullptr);
    EXPECT_TRUE(found->is_warning);
    EXPECT_NEAR(found->depth_mm, cut_mm, kPlacedMm);
    EXPECT_NEAR(found->at_mm, Block::kHalfDepthMm - kRidge.y(), kRidgeMm + 0.1);
    EXPECT_EQ(graded.grade, Grade::A) << "the bone around the thread is whole";
  }
}

TEST_F(Placements, MeasureTheDriversCone) {
  // From the tulip's end, 15 mm behind the entry, 5 mm wide to each side, it widens by 4 degrees.
  for (const double off_mm : {10.0, 8.0, 7.0, -8.2}) {
    DrillPath path = placed(18.0, kRidge.z() + off_mm);
    path.screw->head = {12.5, 15.0, 10.0, 4.0, 80.0};
    const PathGrade graded = grade(bones().in_processes, path);
    const double along_mm = kRidge.y() - Block::kHalfDepthMm - 15.0;
    const double angle = 4.0 * kDegree;
    const double depth_mm = (5.0 + along_mm * std::tan(angle) - std::abs(off_mm)) * std::cos(angle) + kRidgeMm;
    SCOPED_TRACE(off_mm);
    if (depth_mm > -20.0) {
      EXPECT_NEAR(graded.instrument.driver_clearance_mm, -depth_mm, kPlacedMm);
    }
    const Finding* found = of_part(graded, InstrumentPart::driver);
    EXPECT_EQ(found != nullptr, depth_mm > kTouchMm);
    if (found != nullptr) {
      EXPECT_NEAR(found->depth_mm, depth_mm, kPlacedMm);
    }
  }
}

TEST_F(Placements, TellAScrewThatCrossesTheCanal) {
  DrillPath across{"", Vec3(18.0, 20.0, 0.0), Vec3(-14.0, -16.0, 0.0), {}};
  across.screw = PedicleScrew{"", 6.0, 40.0, 4.0};
  const PathGrade graded = grade(bones().in_block, across);
  EXPECT_EQ(graded.grade, Grade::E);
  EXPECT_TRUE(graded.breaches_canal);
  EXPECT_EQ(graded.heary, Heary::V);
  EXPECT_LT(graded.canal.clearance_mm, 0.0);
}

}  // namespace
}  // namespace spinaltap
