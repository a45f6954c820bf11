#include "mesh/cut_out.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "core/base/error.h"
#include "core/tool/drill_path.h"
#include "mesh/remaining_mesh.h"
#include "vdb/remaining/remaining_bone.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {
namespace {

/// Vertices at edges that belong to one triangle only.
std::vector<bool> on_edge(const TriangleMesh& mesh) {
  std::map<std::array<std::uint32_t, 2>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = t[c];
      const std::uint32_t b = t[(c + 1) % 3];
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  }
  std::vector<bool> result(mesh.vertices_mm.size(), false);
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    for (const std::uint32_t vertex : edge) result[vertex] = true;
  }
  return result;
}

/// The place on the cylinder's wall and on the bone's surface that a place near both goes to, by Newton's method along
/// the wall; frame of the path.
Vec3 on_cylinder(const BoneModel& bone, const PathFrame& frame, double radius_mm, const Vec3& near) {
  constexpr int kMaxSteps = 5;
  constexpr double kMinSlope = 0.1;  // flatter surfaces run along the wall
  const auto to_wall = [&](Vec3 p) {
    p.head<2>() *= radius_mm / p.head<2>().norm();
    return p;
  };
  Vec3 start = to_wall(near);
  Vec3 p = start;
  for (int n = 0; n < kMaxSteps; ++n) {
    const Vec3 p_mm = frame.to_patient(p);
    float distance_mm = 0.0F;
    Vec3 gradient;
    bone.distance({&p_mm, 1}, {&distance_mm, 1}, {&gradient, 1}, Interpolation::quadratic);
    Vec3 slope = frame.to_path(Vec3(p_mm + gradient)) - p;
    const Vec3 outward = Vec3(p.x(), p.y(), 0.0) / radius_mm;
    slope -= slope.dot(outward) * outward;
    if (slope.norm() < kMinSlope) break;
    p = to_wall(p - static_cast<double>(distance_mm) / slope.squaredNorm() * slope);
    if ((p - start).norm() > bone.voxel_mm()) return start;
  }
  return p;
}

}  // namespace

TriangleMesh cut_out_cylinder(const BoneModel& bone, const DrillPath& path, double radius_mm, double lead_in_mm) {
  check_path(path);
  check_straight(path, "a cylinder cut out");
  if (!(radius_mm > 0.0) || !(lead_in_mm >= 0.0)) {
    fail("cutting out: expected a radius above 0 mm and a lead-in of 0 mm or more, found ", radius_mm, " and ",
         lead_in_mm);
  }
  const double length_mm = lead_in_mm + path.length_mm();
  const PathFrame frame(path.entry_mm - lead_in_mm * path.direction(), path.direction());
  const double voxel_mm = bone.voxel_mm();
  RemainingBone remaining(bone, {.voxel_mm = voxel_mm});
  // A tool with a flat end.
  const DrillBit cylinder{.diameter_mm = 2.0 * radius_mm,
                          .length_mm = length_mm,
                          .tip_length_mm = 1e-3 * length_mm,
                          .shape = BitShape::drill,
                          .tip_diameter_mm = 2.0 * radius_mm};
  remaining.drill(cylinder, std::array{Pose{path.target_mm, path.direction()}});
  TriangleMesh mesh = join_blocks(RemainingSurface(remaining).blocks(), SurfacePart::bone);
  const std::vector<bool> is_on_edge = on_edge(mesh);
  for (std::size_t n = 0; n < mesh.vertices_mm.size(); ++n) {
    if (!is_on_edge[n]) continue;
    const Vec3 p = frame.to_path(mesh.vertices_mm[n].cast<double>());
    // Where the cylinder's flat end comes out of the bone the edge lies on that.
    const bool is_at_end = std::abs(p.z() - length_mm) < std::abs(p.head<2>().norm() - radius_mm);
    const Vec3 moved = is_at_end ? Vec3(p.x(), p.y(), length_mm) : on_cylinder(bone, frame, radius_mm, p);
    mesh.vertices_mm[n] = frame.to_patient(moved).cast<float>();
  }
  return mesh;
}

}  // namespace spinaltap
