// Compiled with optimisation: long loops of its own.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/base/statistics.h"
#include "core/tool/plate.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/drilled_ball.h"
#include "tests/support/test_kind.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {
namespace {

/// An even block of bone, flat on top, to be sawn from above.
const Box3 kSawnBlock{Vec3(-4.0, -6.1, 50.3), Vec3(14.3, 9.2, 62.6)};
constexpr double kSawnVoxelMm = 0.2;

double from_block_mm(const Vec3& p) {
  const Vec3 out = (p - kSawnBlock.center()).cwiseAbs() - 0.5 * kSawnBlock.sizes();
  return out.cwiseMax(0.0).norm() + std::min(0.0, out.maxCoeff());
}

BoneModel bake_block(double voxel_mm) {
  const test::FormulaField field(from_block_mm, [](const Vec3& p) {
    constexpr double kStepMm = 1e-6;
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStepMm * Vec3::Unit(axis);
      slope[axis] = (from_block_mm(p + step) - from_block_mm(p - step)) / (2.0 * kStepMm);
    }
    return slope;
  });
  const Vec3 middle = kSawnBlock.center();
  const std::vector<Vec3> seeds{{middle.x(), middle.y(), kSawnBlock.max().z()}};
  return bake_bone(field, seeds, test::even_ct(kSawnBlock, 1.0, 300), {.voxel_mm = voxel_mm}, {});
}

const BoneModel& sawn_block() {
  static const BoneModel bone = bake_block(kSawnVoxelMm);
  return bone;
}

/// The middle of the top.
Vec3 on_top() { return {kSawnBlock.center().x(), kSawnBlock.center().y(), kSawnBlock.max().z()}; }

/// Askew to the voxels, as nearly along x as can be.
Pose sawing_pose(const Vec3& tip_mm, const Vec3& axis, const Vec3& towards = Vec3(0.9, 0.4, 0.2)) {
  const Vec3 down = axis.normalized();
  return {tip_mm, down, (towards - towards.dot(down) * down).normalized()};
}

struct Sawn {
  TriangleMesh mesh;
  double taken_mm3 = 0.0;
};

Sawn saw(const DrillBit& plate, std::span<const Pose> poses) {
  RemainingBone bone(sawn_block(), {.voxel_mm = kSawnVoxelMm});
  RemainingSurface surface(bone);
  const double before_mm3 = measure_mesh(test::joined(surface)).volume_mm3;
  bone.drill(plate, poses);
  surface.update();
  Sawn sawn{test::joined(surface)};
  const MeshQuality quality = measure_mesh(sawn.mesh);
  EXPECT_TRUE(quality.closed()) << quality.boundary_edges << " border edges, " << quality.rejected_faces << " rejected";
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, 2);
  sawn.taken_mm3 = before_mm3 - quality.volume_mm3;
  return sawn;
}

/// What a saw takes that is driven `deep` from the top on, along its middle line, within the block's sides: width x
/// thickness x depth, since the top cuts it in a plane.
constexpr double kDeepMm = 7.3;
const Vec3 kDown = Vec3(0.12, -0.21, -1.0).normalized();
const DrillBit kSaw = plate_bit(8.0, 1.0, 30.0);

std::vector<Pose> plunge(const Vec3& down, double deep_mm) {
  return {sawing_pose(on_top() - 3.0 * down, down), sawing_pose(on_top() + deep_mm * down, down)};
}

SLOW_TESTS("Kerf.OfAHandIsClosedAndTheSameAtOneThreadAndTwoWholeAndInParts");

TEST(Kerf, OfAPlungeIsWidthTimesThicknessTimesDepth) {
  const double expected_mm3 = kSaw.diameter_mm * kSaw.thickness_mm * kDeepMm;
  const Sawn sawn = saw(kSaw, plunge(kDown, kDeepMm));
  EXPECT_NEAR(sawn.taken_mm3, expected_mm3, 0.002 * expected_mm3);
  std::printf("plunge: %.4f of %.4f mm3\n", sawn.taken_mm3, expected_mm3);
  // The same by small steps of a hand.
  std::vector<Pose> steps;
  const std::vector<Pose> ends = plunge(kDown, kDeepMm);
  for (int n = 0; n <= 100; ++n) {
    Pose pose = ends[0];
    pose.tip_mm += 0.01 * n * (ends[1].tip_mm - ends[0].tip_mm);
    steps.push_back(pose);
  }
  EXPECT_NEAR(saw(kSaw, steps).taken_mm3, expected_mm3, 0.002 * expected_mm3);
}

TEST(Kerf, CutSidewaysIsAsMuchLonger) {
  constexpr double kAsideMm = 4.4;
  std::vector<Pose> poses = plunge(kDown, kDeepMm);
  // Along the top, so that the tip is everywhere as deep.
  const Pose in = poses.back();
  const double rise = in.side.z() / kDown.z();
  const Vec3 way = kAsideMm * (in.side - rise * kDown);
  poses.push_back({in.tip_mm + way, in.axis, in.side});
  // In the plate's plane the top rises by `rise` a mm along the edge. The plate that stands takes width x depth, and
  // what it goes on by is as deep as its deeper corner.
  const double corner_mm = kDeepMm + 0.5 * kSaw.diameter_mm * std::abs(rise);
  const double expected_mm3 = kSaw.thickness_mm * (kSaw.diameter_mm * kDeepMm + kAsideMm * corner_mm);
  const Sawn sawn = saw(kSaw, poses);
  std::printf("sideways: %.4f of %.4f mm3\n", sawn.taken_mm3, expected_mm3);
  EXPECT_NEAR(sawn.taken_mm3, expected_mm3, 0.002 * expected_mm3);
}

TEST(Kerf, ThatTurnsAboutTheAxisIsWhatTheSectionSweeps) {
  constexpr double kTurnRad = 0.6;
  const Vec3 down = -Vec3::UnitZ();
  std::vector<Pose> poses;
  const Pose in = sawing_pose(on_top() + kDeepMm * down, down);
  const auto turned = [&](double angle) {
    Pose pose = in;
    pose.side = Eigen::AngleAxisd(angle, down) * in.side;
    return pose;
  };
  for (const Pose& pose : {in, turned(0.5 * kTurnRad), turned(kTurnRad)}) poses.push_back(pose);
  // In polar coordinates the section reaches as far as the furthest of its turns.
  const double half_width_mm = 0.5 * kSaw.diameter_mm, half_mm = 0.5 * kSaw.thickness_mm;
  const auto reach_mm = [&](double angle) {
    return std::min(half_width_mm / std::abs(std::cos(angle)), half_mm / std::abs(std::sin(angle)));
  };
  const double corner = std::atan2(half_mm, half_width_mm);
  double area_mm2 = 0.0;
  constexpr int kSteps = 40'000;
  for (int n = 0; n < kSteps; ++n) {
    const double angle = 2.0 * std::numbers::pi * (n + 0.5) / kSteps;
    // Seen from the section the angle runs from `angle` back by the turn; the furthest is at an end or at a corner.
    double max_mm = std::max(reach_mm(angle), reach_mm(angle - kTurnRad));
    for (const double at : {corner, -corner, std::numbers::pi + corner, std::numbers::pi - corner,
                            2.0 * std::numbers::pi - corner, -std::numbers::pi + corner}) {
      if (at <= angle && at >= angle - kTurnRad) max_mm = std::max(max_mm, reach_mm(at));
    }
    area_mm2 += 0.5 * max_mm * max_mm * 2.0 * std::numbers::pi / kSteps;
  }
  const double expected_mm3 = area_mm2 * kDeepMm;
  const Sawn sawn = saw(kSaw, poses);
  std::printf("turned: %.4f of %.4f mm3\n", sawn.taken_mm3, expected_mm3);
  EXPECT_NEAR(sawn.taken_mm3, expected_mm3, 0.002 * expected_mm3);
}

TEST(Kerf, OfAHoleCutterIsWidthTimesThicknessTimesDepth) {
  const double expected_mm3 = kSaw.diameter_mm * kSaw.thickness_mm * kDeepMm;
  const DrilledHole hole{kSaw, {plunge(kDown, kDeepMm)}};
  // Slopes are found from the grid's values: a kerf's edges are as round as its voxels.
  const BoneModel block = bake_block(0.15);
  const double before_mm3 = measure_mesh(sharp_surface(block)).volume_mm3;
  const TriangleMesh mesh = sharp_surface(without_holes(block, {&hole, 1}));
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.pieces, 1U);
  std::printf("hole cutter: %.4f of %.4f mm3\n", before_mm3 - quality.volume_mm3, expected_mm3);
  EXPECT_NEAR(before_mm3 - quality.volume_mm3, expected_mm3, 0.002 * expected_mm3);
}

/// Where two triangles meet at an angle.
struct MeshEdge {
  Vec3 from, to;
  double angle_deg = 0.0;
};

std::vector<MeshEdge> sharp_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Vec3>> normals;
  const auto at = [&](std::uint32_t n) -> Vec3 { return mesh.vertices_mm[n].cast<double>(); };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 normal = (at(b) - at(a)).cross(at(c) - at(a));
    // Of slivers a normal is rounding.
    if (normal.norm() < 1e-5) continue;
    for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      normals[std::minmax(u, v)].push_back(normal.normalized());
    }
  }
  std::vector<MeshEdge> edges;
  for (const auto& [ends, pair] : normals) {
    if (pair.size() != 2) continue;
    const double angle = std::acos(std::clamp(pair[0].dot(pair[1]), -1.0, 1.0)) / kDegree;
    if (angle > 45.0) edges.push_back({at(ends.first), at(ends.second), angle});
  }
  return edges;
}

double from_stretch_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

TEST(Kerf, HasSharpEdgesAndFlatFacesAtRightAngles) {
  const std::vector<Pose> poses = plunge(kDown, kDeepMm);
  const TriangleMesh mesh = saw(kSaw, poses).mesh;
  // The kerf's edges: four of its floor, four up to the top, four of its rim.
  const Pose& pose = poses.back();
  const Vec3 thick = pose.axis.cross(pose.side);
  std::array<Vec3, 4> low, high;
  for (std::size_t n = 0; n < 4; ++n) {
    constexpr std::array<std::array<double, 2>, 4> kAround{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    low[n] = pose.tip_mm + 0.5 * kAround[n][0] * kSaw.diameter_mm * pose.side +
             0.5 * kAround[n][1] * kSaw.thickness_mm * thick;
    high[n] = low[n] + (kSawnBlock.max().z() - low[n].z()) / pose.axis.z() * pose.axis;
  }
  std::vector<std::pair<Vec3, Vec3>> edges;
  for (std::size_t n = 0; n < 4; ++n) {
    edges.emplace_back(low[n], low[(n + 1) % 4]);
    edges.emplace_back(low[n], high[n]);
    edges.emplace_back(high[n], high[(n + 1) % 4]);
  }
  const auto from_edges_mm = [&](const Vec3& p) {
    double min_mm = 1e9;
    for (const auto& [a, b] : edges) min_mm = std::min(min_mm, from_stretch_mm(p, a, b));
    return min_mm;
  };
  const auto is_of_block = [](const Vec3& p) {
    // The block's own edges, which lie well away from the kerf.
    const Vec3 out = (p - kSawnBlock.center()).cwiseAbs() - 0.5 * kSawnBlock.sizes();
    return (out.array() > -0.4).count() >= 2;
  };
  const std::vector<MeshEdge> sharp = sharp_edges(mesh);
  std::vector<double> off_mm, angles_deg;
  for (const MeshEdge& edge : sharp) {
    if (is_of_block(edge.from) || is_of_block(edge.to)) continue;
    for (const Vec3& p : {edge.from, edge.to}) off_mm.push_back(from_edges_mm(p));
    angles_deg.push_back(edge.angle_deg);
  }
  ASSERT_GT(angles_deg.size(), 200U);
  const auto quantile = [](std::vector<double>& values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  // Where a voxel edge passes through the kerf's own edge with both ends in the bone, nothing tells of that: there a
  // notch of up to half a voxel is left.
  EXPECT_LT(quantile(off_mm, 0.95), 0.05);
  EXPECT_LT(quantile(off_mm, 1.0), 0.6 * kSawnVoxelMm);
  double max_gap_mm = 0.0;
  for (const auto& [a, b] : edges) {
    for (double t = 0.0; t <= 1.0; t += 0.01) {
      const Vec3 p = a + t * (b - a);
      double min_mm = 1e9;
      for (const MeshEdge& edge : sharp) min_mm = std::min(min_mm, from_stretch_mm(p, edge.from, edge.to));
      max_gap_mm = std::max(max_gap_mm, min_mm);
    }
  }
  EXPECT_LT(max_gap_mm, 0.5 * kSawnVoxelMm);
  // Faces of the kerf: every triangle that does not touch an edge lies flat; all others nearly all of their area.
  double max_off_face_mm = 0.0, askew_mm2 = 0.0, all_mm2 = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) corners[n] = mesh.vertices_mm[triangle[n]].cast<double>();
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const Vec3 seen(pose.side.dot(middle - pose.tip_mm), thick.dot(middle - pose.tip_mm),
                    -pose.axis.dot(middle - pose.tip_mm));
    const bool is_of_kerf = std::abs(seen.x()) < 4.2 && std::abs(seen.y()) < 0.7 && seen.z() > -0.2;
    if (!is_of_kerf || middle.z() > kSawnBlock.max().z() - 1e-3) continue;
    const Vec3 out(std::abs(seen.x()) - 4.0, std::abs(seen.y()) - 0.5, -seen.z());
    max_off_face_mm = std::max(max_off_face_mm, std::abs(out.maxCoeff()));
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double cosine =
        std::max({std::abs(normal.dot(pose.side)), std::abs(normal.dot(thick)), std::abs(normal.dot(pose.axis))});
    all_mm2 += 0.5 * normal.norm();
    if (cosine < std::cos(5.0 * kDegree) * normal.norm()) askew_mm2 += 0.5 * normal.norm();
  }
  EXPECT_LT(max_off_face_mm, 0.05);
  EXPECT_LT(askew_mm2, 0.02 * all_mm2);
  std::printf("edges: off 95 %% %.4f, max %.4f, gaps %.4f mm; angles %.2f to %.2f, median %.2f; faces off %.4f mm\n",
              quantile(off_mm, 0.95), quantile(off_mm, 1.0), max_gap_mm, quantile(angles_deg, 0.05),
              quantile(angles_deg, 0.95), quantile(angles_deg, 0.5), max_off_face_mm);
  EXPECT_NEAR(quantile(angles_deg, 0.5), 90.0, 0.5);
}

/// A hand that saws, rocks and turns the blade, and withdraws.
std::vector<Pose> sawing_hand() {
  std::vector<Pose> poses;
  for (int n = 0; n <= 240; ++n) {
    const double phase = 2.0 * std::numbers::pi * n / 60.0;
    const Vec3 down = (kDown + 0.03 * Vec3(std::sin(0.7 * phase), std::cos(phase), 0.0)).normalized();
    const double deep_mm = n <= 200 ? 0.03 * n : 6.0 - 0.1 * (n - 200);
    Pose pose = sawing_pose(on_top() + deep_mm * down, down, Vec3(0.9, 0.4 + 0.05 * std::sin(0.3 * phase), 0.2));
    pose.tip_mm += 0.8 * std::sin(phase) * pose.side;
    poses.push_back(pose);
  }
  return poses;
}

TEST(Kerf, OfAHandIsClosedAndTheSameAtOneThreadAndTwoWholeAndInParts) {
  const std::vector<Pose> poses = sawing_hand();
  const auto sawn = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    RemainingBone bone(sawn_block(), {.voxel_mm = kSawnVoxelMm});
    RemainingSurface surface(bone);
    for (std::size_t n = 0; n + 1 < poses.size(); n += 16) {
      bone.drill(kSaw, std::span(poses).subspan(n, std::min<std::size_t>(17, poses.size() - n)));
      surface.update();
    }
    const auto updated = test::triangle_set(test::joined(surface));
    surface.rebuild();
    EXPECT_EQ(updated, test::triangle_set(test::joined(surface)));
    return test::joined(surface);
  };
  const TriangleMesh one = sawn(1), two = sawn(2);
  EXPECT_EQ(one.vertices_mm, two.vertices_mm);
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_TRUE(measure_mesh(one).closed());
  EXPECT_EQ(measure_mesh(one).pieces, 1U);
}

TEST(Kerf, HoldsTheLeastDistanceToAllThatThePlateSwept) {
  const std::vector<Pose> poses = sawing_hand();
  RemainingBone bone(sawn_block(), {.voxel_mm = 0.6});
  for (std::size_t n = 0; n + 1 < poses.size(); n += 8) {
    bone.drill(kSaw, std::span(poses).subspan(n, std::min<std::size_t>(9, poses.size() - n)));
  }
  const PlateSweep plate(kSaw);
  std::vector<Mat3> rows;
  std::vector<Vec3> tips;
  for (std::size_t n = 0; n + 1 < poses.size(); ++n) {
    const PlateMotion motion(plate, poses[n], poses[n + 1]);
    for (int step = 0; step < 20; ++step) {
      const Pose pose = motion.pose_at(0.05 * step);
      rows.push_back(plate_rows(pose));
      tips.push_back(pose.tip_mm);
    }
  }
  const auto low = bone.first_voxel(), high = bone.last_voxel();
  std::size_t near = 0;
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        const Vec3 p = 0.6 * Vec3(x, y, z);
        if (from_block_mm(p) > 0.0) continue;
        double min_mm = bone.band_mm();
        for (std::size_t n = 0; n < rows.size(); ++n) {
          min_mm = std::min(min_mm, plate.box.sample(rows[n] * (p - tips[n])).distance_mm);
        }
        const auto hole_mm = static_cast<double>(bone.hole_mm({x, y, z}));
        near += min_mm < bone.band_mm() ? 1U : 0U;
        // A hundredth of a voxel for poses left out and one for turns; samples are up to 6 um apart.
        if (min_mm > 0.0) {
          ASSERT_NEAR(hole_mm, min_mm, 0.012 + 0.003) << x << " " << y << " " << z;
        } else {
          ASSERT_LE(hole_mm, 0.012) << x << " " << y << " " << z;
        }
      }
    }
  }
  EXPECT_GT(near, 1000U);
}

TEST(Kerf, NeedsSoundPoses) {
  RemainingBone bone(sawn_block(), {.voxel_mm = 0.6});
  Pose pose = sawing_pose(on_top(), kDown);
  pose.side = pose.axis;
  EXPECT_THROW(bone.drill(kSaw, {&pose, 1}), Error);
  EXPECT_EQ(bone.holes_to_undo(), 0U);
  // Without a side it is held as the plate says.
  DrillBit along_y = kSaw;
  along_y.width_along = Vec3::UnitY();
  const Pose unsaid{on_top() - 2.0 * Vec3::UnitZ(), -Vec3::UnitZ()};
  bone.drill(along_y, {&unsaid, 1});
  const Vec3 seen = on_top() - 1.0 * Vec3::UnitZ();
  const auto hole_at = [&](const Vec3& p) {
    const Vec3 at = p / 0.6;
    return bone.hole_mm({static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                         static_cast<int>(std::lround(at.z()))});
  };
  EXPECT_LT(hole_at(seen + 3.0 * Vec3::UnitY()), 0.2F);
  EXPECT_GT(hole_at(seen + 3.0 * Vec3::UnitX()), 0.5F);
}

}  // namespace
}  // namespace spinaltap
