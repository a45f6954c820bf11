#include "core/plan/detail/graded_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/plan/detail/inside_bone.h"

namespace spinaltap {
namespace {

BitProfile profile_of(const DrillPath& path) {
  check_path(path);
  return BitProfile(path.screw ? path.screw->outline() : path.bit);
}

}  // namespace

GradedTool::GradedTool(const DrillPath& path)
    : profile_(profile_of(path)),
      entry_mm_(path.entry_mm),
      target_mm_(path.target_mm),
      direction_(path.direction()),
      length_mm_(path.length_mm()) {}

double GradedTool::radius_mm(double depth_mm) const {
  // Whatever has passed a depth has cut it as wide as its widest part: a burr's hole does not narrow to its shank.
  return std::max(0.0, profile_.widest_mm(0.0, length_mm_ - depth_mm));
}

std::vector<Vec3> ring_mm(const GradedTool& tool, double depth_mm, double radius_mm, const Vec3& towards, int count) {
  const Vec3 centre_mm = tool.axis_mm(depth_mm);
  if (!(radius_mm > 0.0)) return {centre_mm};
  const Vec3& axis = tool.direction();
  Vec3 first = towards - towards.dot(axis) * axis;
  first = first.norm() > 1e-3 ? Vec3(first.normalized()) : any_perpendicular(axis);
  const Vec3 second = axis.cross(first);
  std::vector<Vec3> ring;
  for (int n = 0; n < count; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / count;
    ring.push_back(centre_mm + radius_mm * (std::cos(angle) * first + std::sin(angle) * second));
  }
  return ring;
}

FoundBreach find_breach(const WallDistance& walls, const GradedTool& tool, std::span<const GradeRow> rows,
                        std::span<const WallDistance::Walls> axis, int ring_points) {
  // A place of the ring is beyond the bone by at most the radius less what its centre lies in it. The most promising
  // rings come first, and those that cannot beat the best are left out.
  struct Candidate {
    double max_mm;
    std::size_t row;
  };
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const double radius_mm = rows[n].radius_mm;
    const double max_mm = radius_mm - axis[n].nearer_mm();
    if (!(max_mm > 0.0)) continue;
    if (rows[n].is_entry && std::abs(axis[n].canal.distance_mm) > radius_mm + max_mm) continue;
    candidates.push_back({max_mm, n});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.max_mm > b.max_mm; });
  FoundBreach best;
  for (const Candidate& candidate : candidates) {
    if (!(candidate.max_mm > best.breach_mm)) break;
    const GradeRow& row = rows[candidate.row];
    const WallDistance::Walls& seen = axis[candidate.row];
    const bool nearer_is_canal = seen.canal.distance_mm < seen.outer.distance_mm;
    const Vec3 towards = SideNames::towards(tool.axis_mm(row.depth_mm), nearer_is_canal ? seen.canal : seen.outer);
    for (const Vec3& p_mm : ring_mm(tool, row.depth_mm, row.radius_mm, towards, ring_points)) {
      if (walls.bone().lattice_mm(p_mm) < -kSureLatticeMm) continue;
      const WallDistance::Beyond beyond = walls.beyond(p_mm);
      if (!(beyond.distance_mm > best.breach_mm) || (row.is_entry && !beyond.is_canal)) continue;
      best = {beyond.distance_mm, row.depth_mm, beyond.is_canal, p_mm, beyond.wall};
    }
  }
  return best;
}

}  // namespace spinaltap
