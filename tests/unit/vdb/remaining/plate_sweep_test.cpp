#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/tool/plate.h"
#include "tests/unit/core/engine/askew_block.h"
#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap {
namespace {

using test::Draw;

/// A saw's blade, a thin osteotome, and a rod that is as thick as wide.
std::array<DrillBit, 3> some_plates() {
  return {plate_bit(3.0, 0.8, 5.0), plate_bit(4.0, 0.3, 2.0), plate_bit(1.5, 1.5, 4.0)};
}

Pose plate_pose(const Vec3& tip_mm, const Vec3& axis, const Vec3& towards) {
  return {tip_mm, axis, (towards - towards.dot(axis) * axis).normalized()};
}

Pose any_plate_pose(Draw& draw) {
  const Vec3 axis = draw.direction();
  return plate_pose(draw.within(-Vec3::Ones(), Vec3::Ones()), axis, axis.cross(draw.direction()));
}

/// Small moves with turns of both axis and side.
std::vector<Pose> small_plate_way(Draw& draw, std::size_t count, double turn_rad) {
  std::vector<Pose> poses{any_plate_pose(draw)};
  while (poses.size() < count) {
    const Pose& from = poses.back();
    const Mat3 turn = Eigen::AngleAxisd(turn_rad, draw.direction()).toRotationMatrix();
    poses.push_back(
        plate_pose(from.tip_mm + 0.2 * draw.direction(), (turn * from.axis).normalized(), turn * from.side));
  }
  return poses;
}

/// Of the box's six faces, without PlateBox: outside from the place of the box that is nearest, inside from the faces.
double plate_distance_mm(const DrillBit& plate, const Pose& pose, const Vec3& p) {
  const Vec3 from_tip = p - pose.tip_mm, thick = pose.axis.cross(pose.side);
  const double x = from_tip.dot(pose.side), y = from_tip.dot(thick), z = -from_tip.dot(pose.axis);
  const double dx = std::abs(x) - 0.5 * plate.diameter_mm, dy = std::abs(y) - 0.5 * plate.thickness_mm;
  const double dz = std::max(-z, z - plate.length_mm);
  if (dx <= 0.0 && dy <= 0.0 && dz <= 0.0) return std::max({dx, dy, dz});
  return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0), std::max(dz, 0.0));
}

Vec3 point_near_plate(const DrillBit& plate, const Pose& pose, Draw& draw) {
  const double across_mm = draw(-1.0, 1.0) * plate.diameter_mm;
  const double thick_mm = draw(-2.0, 2.0) * plate.thickness_mm;
  const double back_mm = draw(-0.3, 1.2) * plate.length_mm;
  return pose.tip_mm + across_mm * pose.side + thick_mm * pose.axis.cross(pose.side) - back_mm * pose.axis;
}

std::shared_ptr<const detail::BitOutline> outline_of(const DrillBit& plate) {
  return std::make_shared<const detail::BitOutline>(PlateBox(plate));
}

TEST(PlateSweep, FindsTheLeastDistanceOverTheWay) {
  constexpr double kTurnRad = 0.002;
  Draw draw(15);
  for (const DrillBit& plate : some_plates()) {
    const auto outline = outline_of(plate);
    for (int way = 0; way < 20; ++way) {
      const std::vector<Pose> poses = small_plate_way(draw, 4, kTurnRad);
      const detail::BitSweep sweep(outline, poses);
      const PlateSweep turning(plate);
      for (int n = 0; n < 100; ++n) {
        const Vec3 p = point_near_plate(plate, poses[1], draw);
        double min_mm = 1e9;
        constexpr int kSteps = 200;
        for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
          const PlateMotion motion(turning, poses[k], poses[k + 1]);
          for (int step = 0; step <= kSteps; ++step) {
            const Pose between = motion.pose_at(static_cast<double>(step) / kSteps);
            min_mm = std::min(min_mm, plate_distance_mm(plate, between, p));
          }
        }
        const detail::SweepSample sample = sweep.nearest(p);
        // Chord and arc part by angle (angle r + 2 way) / 8 at most; 200 steps of 0.2 mm miss a vertex of the distance,
        // which the points pass at up to 1 mm a mm, by half a step.
        const double off_mm = kTurnRad * (kTurnRad * 5.5 + 2.0 * 0.2) / 8.0;
        if (min_mm > 0.0) {
          ASSERT_NEAR(sample.distance_mm, min_mm, off_mm + 0.5 * 0.22 / kSteps) << p.transpose();
          ASSERT_LE(sample.distance_mm, min_mm + off_mm);
          ASSERT_NEAR(sample.gradient.norm(), 1.0, 1e-6);
          // Back along it the distance shrinks as fast as the way. Forth it may grow less: past a ridge another part of
          // the way is nearer.
          const double back_mm = std::min(1e-4, 0.5 * sample.distance_mm);
          const double nearer_mm = sweep.nearest(p - back_mm * sample.gradient).distance_mm;
          ASSERT_NEAR(sample.distance_mm - nearer_mm, back_mm, 2e-6) << p.transpose();
        } else {
          ASSERT_LE(sample.distance_mm, off_mm) << p.transpose();
        }
      }
    }
  }
}

TEST(PlateSweep, BoundsHowDistancesChangeByTheTurnOfTheSideToo) {
  Draw draw(16);
  for (const DrillBit& plate : some_plates()) {
    const auto outline = outline_of(plate);
    for (int way = 0; way < 200; ++way) {
      // From hardly any turn to most of a half.
      const double turn_rad = std::pow(10.0, draw(-3.0, 0.3));
      const std::vector<Pose> poses = small_plate_way(draw, 3, turn_rad);
      Pose from = poses[1];
      if (way % 2 == 0) from = any_plate_pose(draw);
      // About its own axis alone.
      if (way % 4 == 1)
        from = plate_pose(from.tip_mm, from.axis, from.side + draw(0.0, 0.5) * from.axis.cross(from.side));
      const detail::BitSweep sweep(outline, poses);
      const Vec3 middle = point_near_plate(plate, from, draw);
      const double around_mm = draw(0.0, 0.5);
      const double bound_mm = sweep.change_mm(from, middle, around_mm, 0.3);
      std::vector<double> changes_mm;
      const double from_middle_mm = sweep.changes_from_middle_mm(middle, around_mm, 0.3, changes_mm);
      ASSERT_EQ(from_middle_mm, *std::max_element(changes_mm.begin(), changes_mm.end()));
      for (int n = 0; n < 20; ++n) {
        const Vec3 p = middle + draw(0.0, around_mm) * draw.direction();
        const double before_mm = plate_distance_mm(plate, from, p);
        const double at_middle_mm = sweep.middle_distance_mm(p);
        ASSERT_NEAR(at_middle_mm, plate_distance_mm(plate, sweep.middle(), p), 1e-12);
        for (std::size_t k = 0; k < poses.size(); ++k) {
          const double now_mm = plate_distance_mm(plate, poses[k], p);
          ASSERT_LE(std::abs(now_mm - before_mm), bound_mm + 1e-9);
          ASSERT_LE(std::abs(now_mm - at_middle_mm), changes_mm[k] + 1e-9);
        }
      }
    }
  }
}

TEST(PlateSweep, LiesInItsBounds) {
  Draw draw(17);
  for (const DrillBit& plate : some_plates()) {
    for (int way = 0; way < 30; ++way) {
      const std::vector<Pose> poses = small_plate_way(draw, 3, 0.1);
      const Box3 box = detail::BitSweep(outline_of(plate), poses).bounds_mm(0.2);
      Box3 corners;
      for (const Pose& pose : poses) {
        const Vec3 thick = pose.axis.cross(pose.side);
        for (int n = 0; n < 8; ++n) {
          const double x = (n & 1) != 0 ? 0.5 : -0.5, y = (n & 2) != 0 ? 0.5 : -0.5, z = (n & 4) != 0 ? 1.0 : 0.0;
          corners.extend(Vec3(pose.tip_mm + x * plate.diameter_mm * pose.side + y * plate.thickness_mm * thick -
                              z * plate.length_mm * pose.axis));
        }
      }
      EXPECT_LT((box.min() - (corners.min() - Vec3::Constant(0.2))).norm(), 1e-9);
      EXPECT_LT((box.max() - (corners.max() + Vec3::Constant(0.2))).norm(), 1e-9);
    }
  }
}

TEST(PlateSweep, PassesEveryPoseOfAHandThatTurnsItWithinTheTolerance) {
  constexpr double kToleranceMm = 0.001;
  Draw draw(18);
  const DrillBit plate = plate_bit(10.0, 1.0, 30.0);
  std::vector<Pose> poses;
  const Vec3 axis = Vec3(0.2, -0.5, 0.8).normalized();
  for (int n = 0; n < 200; ++n) {
    const double phase = 2.0 * std::numbers::pi * 0.01 * n;
    const Vec3 tilted = (axis + 1e-3 * Vec3(std::sin(phase), 0.0, 0.0)).normalized();
    // The side alone turns by 20 degrees.
    poses.push_back(plate_pose(Vec3(0.1 * std::sin(phase), 0.1 * std::cos(1.1 * phase), 0.001 * n), tilted,
                               Vec3(1.0, 0.3 + 0.002 * n, 0.0)));
  }
  const auto sweeps = detail::cut_into_sweeps(plate, poses, kToleranceMm, 1.0);
  std::size_t moments = 0;
  for (const auto& sweep : sweeps) moments += sweep.moment_count();
  EXPECT_LT(moments, poses.size());
  for (const Pose& pose : poses) {
    for (int n = 0; n < 10; ++n) {
      const Vec3 p = point_near_plate(plate, pose, draw);
      double min_mm = 1e9;
      for (const auto& sweep : sweeps) min_mm = std::min(min_mm, sweep.nearest(p).distance_mm);
      ASSERT_LE(min_mm, plate_distance_mm(plate, pose, p) + 2.0 * kToleranceMm);
    }
  }
}

TEST(PlateSweep, OfALongPlungeIsOneLongerPlate) {
  const DrillBit plate = plate_bit(8.0, 1.0, 30.0);
  const Pose start = plate_pose(Vec3::Zero(), Vec3::UnitX(), Vec3(0.0, 1.0, 1.0));
  Pose end = start;
  end.tip_mm.x() = 20.0;
  for (const auto& way : {std::vector{start, end}, std::vector{end, start}}) {
    const auto sweeps = detail::cut_into_sweeps(plate, way, 0.001, 1.0);
    ASSERT_EQ(sweeps.size(), 1U);
    EXPECT_EQ(sweeps[0].moment_count(), 1U);
    Draw draw(19);
    for (int n = 0; n < 500; ++n) {
      const Vec3 p = point_near_plate(plate, {draw(0.0, 20.0) * Vec3::UnitX(), start.axis, start.side}, draw);
      DrillBit longer = plate;
      longer.length_mm = 50.0;
      ASSERT_NEAR(sweeps[0].nearest(p).distance_mm, plate_distance_mm(longer, end, p), 1e-12);
    }
  }
  // One that turns about its axis meanwhile is not.
  end = plate_pose(end.tip_mm, end.axis, Vec3(0.0, 1.0, 1.1));
  EXPECT_GT(detail::cut_into_sweeps(plate, std::array{start, end}, 0.001, 1.0).size(), 10U);
}

}  // namespace
}  // namespace spinaltap
