#include "core/grading/detail/graded_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/anatomy/inside_bone.h"
#include "core/grading/path_side.h"

namespace spinaltap {
namespace {

BitProfile profile_of(const DrillPath& path) {
  check_path(path);
  return BitProfile(path.screw ? path.screw->outline() : path.bit);
}

}  // namespace

GradedTool::GradedTool(const DrillPath& path)
    : profile_(profile_of(path)), name_(path.screw ? "screw" : "bit"), curve_(path) {}

Vec3 GradedTool::across_at(double depth_mm) const {
  return curve_.is_straight() ? any_perpendicular(direction_at(depth_mm)) : Vec3(curve_.axes_at(depth_mm).col(0));
}

double GradedTool::radius_mm(double depth_mm) const {
  // Whatever has passed a depth has cut it as wide as its widest part: a burr's hole does not narrow to its shank.
  return std::max(0.0, profile_.widest_mm(0.0, length_mm() - depth_mm));
}

RingTurns::RingTurns(int count) {
  for (int n = 0; n < count; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / count;
    cosines.push_back(std::cos(angle));
    sines.push_back(std::sin(angle));
  }
}

ToolRing::ToolRing(const GradedTool& tool, double depth_mm, double radius_mm, const Vec3& towards)
    : centre_mm_(tool.axis_mm(depth_mm)), radius_mm_(radius_mm) {
  const Vec3 axis = tool.direction_at(depth_mm);
  first_ = towards - towards.dot(axis) * axis;
  first_ = first_.norm() > 1e-3 ? Vec3(first_.normalized()) : any_perpendicular(axis);
  second_ = axis.cross(first_);
}

Vec3 ToolRing::place_mm(double cosine, double sine) const {
  return centre_mm_ + radius_mm_ * (cosine * first_ + sine * second_);
}

std::vector<Vec3> ring_mm(const GradedTool& tool, double depth_mm, double radius_mm, const Vec3& towards, int count) {
  if (!(radius_mm > 0.0)) return {tool.axis_mm(depth_mm)};
  const ToolRing circle(tool, depth_mm, radius_mm, towards);
  const RingTurns turns(count);
  std::vector<Vec3> ring;
  ring.reserve(turns.cosines.size());
  for (std::size_t n = 0; n < turns.cosines.size(); ++n) {
    ring.push_back(circle.place_mm(turns.cosines[n], turns.sines[n]));
  }
  return ring;
}

void sharpen_breach(const BoneShape& bone, FoundBreach& breach) {
  constexpr int kRounds = 6;
  if (!(breach.breach_mm > bone.trusted_band_mm())) return;
  Vec3 at_mm = bone.points_mm()[breach.wall.sample];  // the nearest
  Vec3 normal = bone.normals()[breach.wall.sample];
  const Vec3 to_sample_mm = breach.place_mm - at_mm;
  // In the order in which PointTree sums.
  double nearest_mm = std::sqrt(to_sample_mm.x() * to_sample_mm.x() + to_sample_mm.y() * to_sample_mm.y() +
                                to_sample_mm.z() * to_sample_mm.z());
  for (int round = 0; round < kRounds; ++round) {
    // Half-way only: across an edge the whole step would overshoot.
    const Vec3 way_mm = breach.place_mm - at_mm;
    const Vec3 step_mm = 0.5 * (way_mm - way_mm.dot(normal) * normal);
    const Vec3 next_mm = at_mm + (step_mm.norm() > 0.25 ? Vec3(0.25 * step_mm.normalized()) : step_mm);
    double value_mm = 0.0;
    Vec3 gradient = Vec3::Zero();
    bone.surface().evaluate({&next_mm, 1}, {&value_mm, 1}, {&gradient, 1});
    if (!(gradient.squaredNorm() > 0.01)) break;
    at_mm = next_mm - value_mm / gradient.squaredNorm() * gradient;
    normal = gradient.normalized();
    nearest_mm = std::min(nearest_mm, (breach.place_mm - at_mm).norm());
  }
  breach.breach_mm = nearest_mm;
  breach.wall.distance_mm = -nearest_mm;
}

FoundBreaches find_breaches(const WallDistance& walls, const GradedTool& tool, std::span<const GradeRow> rows,
                            std::span<const WallDistance::Walls> axis, int ring_points) {
  // A place of the ring is beyond the bone by at most the radius less what its centre lies in it. The most promising
  // rings come first, and those that cannot beat the best are left out.
  struct Candidate {
    double max_mm;
    std::size_t row;
  };
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const double max_mm = rows[n].radius_mm - axis[n].nearer_mm();
    if (max_mm > 0.0) candidates.push_back({max_mm, n});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.max_mm > b.max_mm; });
  FoundBreaches best;
  WallDistance::Beyond beyond;
  for (const Candidate& candidate : candidates) {
    const GradeRow& row = rows[candidate.row];
    const WallDistance::Walls& seen = axis[candidate.row];
    const double within_mm = row.radius_mm + candidate.max_mm;
    const bool may_be_outer =
        !row.is_opening && candidate.max_mm > best.outer.breach_mm && std::abs(seen.outer.distance_mm) <= within_mm;
    const bool may_be_canal = candidate.max_mm > best.canal.breach_mm && std::abs(seen.canal.distance_mm) <= within_mm;
    if (!may_be_outer && !may_be_canal) continue;
    const bool nearer_is_canal = seen.canal.distance_mm < seen.outer.distance_mm;
    const Vec3 towards = SideNames::towards(tool.axis_mm(row.depth_mm), nearer_is_canal ? seen.canal : seen.outer);
    for (const Vec3& p_mm : ring_mm(tool, row.depth_mm, row.radius_mm, towards, ring_points)) {
      if (walls.bone().lattice_mm(p_mm) < -kSureLatticeMm) continue;
      constexpr double kNever = std::numeric_limits<double>::infinity();
      const double least_mm = std::min(may_be_outer ? best.outer.breach_mm : kNever,  //
                                       may_be_canal ? best.canal.breach_mm : kNever);
      beyond = walls.beyond(p_mm, beyond, least_mm);
      if (row.is_opening && !beyond.is_canal) continue;
      FoundBreach& of_wall = beyond.is_canal ? best.canal : best.outer;
      if (!(beyond.distance_mm > of_wall.breach_mm)) continue;
      of_wall = {beyond.distance_mm, row.depth_mm, beyond.is_canal, p_mm, beyond.wall};
    }
  }
  sharpen_breach(walls.bone(), best.outer);
  sharpen_breach(walls.bone(), best.canal);
  return best;
}

std::array<double, 5> side_breaches(const WallDistance& walls, const GradedTool& tool, const SideNames& sides,
                                    std::span<const GradeRow> rows, std::span<const WallDistance::Walls> axis,
                                    const FoundBreaches& found) {
  std::array<double, 5> breach_mm{};
  if (!(found.larger().breach_mm > 0.0)) return breach_mm;
  const auto add = [&](double mm, const Vec3& place_mm, const WallDistance::Wall& wall) {
    double& side_mm = breach_mm[static_cast<std::size_t>(sides.of(place_mm, wall))];
    side_mm = std::max(side_mm, mm);
  };
  for (const FoundBreach& known : {found.outer, found.canal}) {
    if (known.breach_mm > 0.0) add(known.breach_mm, known.place_mm, known.wall);
  }
  double next_mm = 0.0;
  WallDistance::Beyond beyond;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (rows[n].depth_mm < next_mm && n + 1 < rows.size()) continue;
    next_mm = rows[n].depth_mm + kSideRingsApartMm - 1e-9;
    if (!(rows[n].radius_mm - axis[n].nearer_mm() > 0.0)) continue;
    const bool nearer_is_canal = axis[n].canal.distance_mm < axis[n].outer.distance_mm;
    const Vec3 towards =
        SideNames::towards(tool.axis_mm(rows[n].depth_mm), nearer_is_canal ? axis[n].canal : axis[n].outer);
    for (const Vec3& p_mm : ring_mm(tool, rows[n].depth_mm, rows[n].radius_mm, towards, kSideRingPoints)) {
      if (walls.bone().lattice_mm(p_mm) < -kSureLatticeMm) continue;
      beyond = walls.beyond(p_mm, beyond);
      if (!(beyond.distance_mm > 0.0) || (rows[n].is_opening && !beyond.is_canal)) continue;
      add(beyond.distance_mm, p_mm, beyond.wall);
    }
  }
  return breach_mm;
}

}  // namespace spinaltap
