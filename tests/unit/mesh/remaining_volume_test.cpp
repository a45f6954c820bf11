#include <gtest/gtest.h>

#include <cmath>

#include "core/engine/drill_engine.h"
#include "core/session/operator/path_motion.h"
#include "core/tool/swept_bit.h"
#include "tests/support/drilled_ball.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

using test::ball_to_drill;
using test::kDrilledBall;

double volume_mm3(const RemainingSurface& surface) { return measure_mesh(test::joined(surface)).volume_mm3; }

/// An operator at 4 mm/s with the workloads' tremor.
PathMotionOptions trembling(std::uint64_t seed) {
  return {.feed = {.steps = {{0.0, 4.0}}}, .tremor_mm = 0.1, .seed = seed};
}

/// A short bit that fits into the ball.
std::array<DrillBit, 3> short_bits() {
  return {DrillBit{3.0, 9.0, 3.0}, DrillBit{4.0, 9.0, 1.0, BitShape::round_burr, 0.0, 2.0},
          DrillBit{3.6, 9.0, 4.0, BitShape::conical_burr, 1.0, 2.0}};
}

double profile_volume_mm3(const BitProfile& profile) {
  double sum = 0.0;
  for (const ProfilePiece& piece : profile.pieces()) {
    const auto integral = [&](double w) {
      return w * (piece.square[0] + w * (piece.square[1] / 2.0 + w * piece.square[2] / 3.0));
    };
    sum += std::numbers::pi * (integral(piece.end_mm) - integral(piece.begin_mm));
  }
  return sum;
}

TEST(RemainingVolume, IsTheBitsInSolid) {
  const Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  for (const DrillBit& bit : short_bits()) {
    RemainingBone bone(ball_to_drill());
    RemainingSurface surface(bone);
    const double before_mm3 = volume_mm3(surface);
    const Pose pose{kDrilledBall.centre_mm + 4.0 * axis, axis};
    bone.drill(bit, {&pose, 1});
    surface.update();
    const double expected_mm3 = profile_volume_mm3(BitProfile(bit));
    EXPECT_NEAR(before_mm3 - volume_mm3(surface), expected_mm3, 0.005 * expected_mm3);
  }
}

TEST(RemainingVolume, IsWhatAnOperatorSweptInSolid) {
  RELEASE_ONLY();
  for (const DrillBit& bit : short_bits()) {
    const DrillPath path{"tremor", kDrilledBall.centre_mm + Vec3(1.0, 1.0, 0.0),
                         kDrilledBall.centre_mm + Vec3(2.5, 3.0, 1.0), bit};
    const PathMotion tool_operator(path, trembling(3));
    std::vector<Pose> poses;
    for (std::size_t n = 0; n <= tool_operator.cycle_count(); ++n) poses.push_back(tool_operator.pose(n));
    RemainingBone bone(ball_to_drill());
    RemainingSurface surface(bone);
    const double before_mm3 = volume_mm3(surface);
    for (std::size_t n = 0; n + 1 < poses.size(); n += 16) {
      bone.drill(bit, std::span(poses).subspan(n, std::min<std::size_t>(17, poses.size() - n)));
    }
    surface.update();
    // Middles of cubes of 0.08 mm: errors at the wall even out to well under 0.1%.
    const SweepProfile profile{BitProfile(bit)};
    std::vector<SweptBit> moves;
    constexpr std::size_t kStride = 4;  // 16 um apart, chords of tremor that part by a tenth of a um
    for (std::size_t n = 0; n + 1 < poses.size(); n += kStride) {
      moves.emplace_back(profile, poses[n], poses[std::min(n + kStride, poses.size() - 1)]);
    }
    constexpr double kStepMm = 0.08;
    std::size_t inside = 0;
    Box3 box(path.target_mm);
    box.extend(path.entry_mm - bit.length_mm * path.direction());
    const Vec3 low = box.min() - Vec3::Constant(3.0);
    const Eigen::Array3i size = ((box.sizes() + Vec3::Constant(6.0)) / kStepMm).array().ceil().cast<int>();
    std::size_t last = 0;
    for (int i = 0; i < size.x(); ++i) {
      for (int j = 0; j < size.y(); ++j) {
        for (int k = 0; k < size.z(); ++k) {
          const Vec3 p = low + kStepMm * Vec3(i + 0.5, j + 0.5, k + 0.5);
          const Vec3 from_entry = p - path.entry_mm;
          const double along = from_entry.dot(path.direction());
          if ((from_entry - along * path.direction()).norm() > bit.radius_mm() + 0.5) continue;
          if (kDrilledBall.distance_mm(p) >= 0.0) continue;
          // The move that held the last point likely holds this one.
          bool is_swept = moves[last].contains(p);
          for (std::size_t n = 0; n < moves.size() && !is_swept; ++n) {
            is_swept = moves[n].contains(p);
            if (is_swept) last = n;
          }
          inside += is_swept ? 1U : 0U;
        }
      }
    }
    const double expected_mm3 = static_cast<double>(inside) * std::pow(kStepMm, 3);
    EXPECT_NEAR(before_mm3 - volume_mm3(surface), expected_mm3, 0.005 * expected_mm3);
    std::printf("volume: mesh %.3f, swept %.3f mm3\n", before_mm3 - volume_mm3(surface), expected_mm3);
  }
}

TEST(RemainingVolume, IsThatOfThePointsWhichTheEngineRemoved) {
  const DrillBit bit{3.0, 50.0, 5.0};
  const Vec3 direction = Vec3(0.6, -0.64, 0.48);
  const DrillPath path{"points", kDrilledBall.centre_mm - 7.0 * direction, kDrilledBall.centre_mm + 5.0 * direction,
                       bit};
  PointVolume points(path, {.radius_mm = 3.0, .spacing_mm = 0.05, .lead_in_mm = 3.0});
  const BoneModel& model = ball_to_drill();
  fill_volume(points,
              [&](std::span<const Vec3> p, std::span<float> d, std::span<float> hu) { model.sample(p, d, hu); });
  const std::size_t occupied = points.occupied_count();
  const auto engine = make_ring_engine(points, bit, Material{});
  const PathMotion tool_operator(path, trembling(4));
  RemainingBone bone(model);
  RemainingSurface surface(bone);
  const double before_mm3 = volume_mm3(surface);
  std::vector<Pose> poses;
  for (std::size_t n = 0; n <= tool_operator.cycle_count(); ++n) {
    poses.push_back(tool_operator.pose(n));
    engine->step(poses.back());
  }
  bone.drill(bit, poses);
  surface.update();
  // The 6 k points of ring k share the area between (k - 1/2) and (k + 1/2) spacings: pi / 3 spacings² each.
  const double expected_mm3 =
      std::numbers::pi / 3.0 * std::pow(0.05, 3) * static_cast<double>(occupied - points.occupied_count());
  EXPECT_NEAR(before_mm3 - volume_mm3(surface), expected_mm3, 0.01 * expected_mm3);

  // Half a voxel: no point that is left lies deeper in the hole's voxels, none that went lies deeper in the bone.
  const double voxel_mm = bone.voxel_mm();
  for (int disc = 0; disc < points.disc_count(); disc += 3) {
    for (std::size_t n = 0; n < points.pattern().point_count(); n += 7) {
      const Vec3 p = points.frame().to_patient(points.point_in_path_mm(disc, n));
      if (kDrilledBall.distance_mm(p) > -2.0 * voxel_mm) continue;
      const Vec3 at = p / voxel_mm;
      const std::array<int, 3> nearest{static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                                       static_cast<int>(std::lround(at.z()))};
      const double off_mm = (p - voxel_mm * Vec3(nearest[0], nearest[1], nearest[2])).norm();
      const auto hole_mm = static_cast<double>(bone.hole_mm(nearest));
      if (points.is_occupied(disc, n)) {
        ASSERT_GT(hole_mm + off_mm, -0.5 * voxel_mm);
      } else {
        ASSERT_LT(hole_mm - off_mm, 0.5 * voxel_mm);
      }
    }
  }
}

TEST(RemainingSurface, LiesOnTheExactCutAwayFromTheRim) {
  const Vec3 axis = Vec3(-0.7, 0.2, -0.4).normalized();
  for (const double voxel_mm : {0.2, 0.1}) {
    RemainingBone bone(ball_to_drill(), {.voxel_mm = voxel_mm});
    RemainingSurface surface(bone);
    const DrillBit bit = test::paper_drill();
    const std::array poses{Pose{kDrilledBall.centre_mm - 12.0 * axis, axis},
                           Pose{kDrilledBall.centre_mm + 4.0 * axis, axis}};
    bone.drill(bit, poses);
    surface.update();
    const BitProfile swept = BitProfile(bit).lengthened(16.0);
    double sum_mm = 0.0;
    double max_mm = 0.0;
    double max_at_rim_mm = 0.0;
    std::size_t count = 0;
    const TriangleMesh mesh = test::joined(surface);
    for (const auto& triangle : mesh.triangles) {
      Vec3 p = Vec3::Zero();
      for (const std::uint32_t corner : triangle) p += mesh.vertices_mm[corner].cast<double>() / 3.0;
      const double to_ball_mm = std::abs(kDrilledBall.distance_mm(p));
      const double to_bit_mm = std::abs(bit_distance_mm(swept, poses[1], p));
      if (std::max(to_ball_mm, to_bit_mm) < 2.0 * voxel_mm) {
        max_at_rim_mm = std::max(max_at_rim_mm, std::min(to_ball_mm, to_bit_mm));
        continue;
      }
      const double off_mm = std::min(to_ball_mm, to_bit_mm);
      sum_mm += off_mm;
      max_mm = std::max(max_mm, off_mm);
      ++count;
    }
    ASSERT_GT(count, 1000U);
    EXPECT_LE(sum_mm / static_cast<double>(count), 0.05 * voxel_mm);
    EXPECT_LE(max_mm, 0.5 * voxel_mm);
    EXPECT_LE(max_at_rim_mm, voxel_mm);
    RecordProperty("mean_um", static_cast<int>(1e3 * sum_mm / static_cast<double>(count)));
    std::printf("voxel %.1f mm: mean %.2f um, max %.1f um, at the rim %.1f um\n", voxel_mm,
                1e3 * sum_mm / static_cast<double>(count), 1e3 * max_mm, 1e3 * max_at_rim_mm);
  }
}

}  // namespace
}  // namespace spinaltap
