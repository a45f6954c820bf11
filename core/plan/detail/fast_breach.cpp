#include "core/plan/detail/fast_breach.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "core/plan/detail/inside_bone.h"
#include "core/plan/instrument.h"

namespace spinaltap {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

}  // namespace

FastBreach::FastBreach(const WallDistance& walls, const DrillPath& path, const GradeOptions& options)
    : walls_(walls), tool_(path), sides_(walls.landmarks(), path), ring_points_(options.ring_points) {
  const double length_mm = tool_.length_mm();
  const auto add = [&](double depth_mm) {
    rows_.push_back({depth_mm, tool_.radius_mm(depth_mm), walls.bone().lattice_mm(tool_.axis_mm(depth_mm))});
  };
  for (int n = 0; options.step_mm * n < length_mm - 1e-6; ++n) add(options.step_mm * n);
  add(length_mm);
  find_opening();
}

bool FastBreach::is_in(const Row& row) const {
  if (std::abs(row.lattice_mm) > kSureLatticeMm) return row.lattice_mm < 0.0;
  return walls_.bone().is_inside(tool_.axis_mm(row.depth_mm));
}

bool FastBreach::is_whole(const Row& row) const {
  if (row.lattice_mm < -row.radius_mm - kSureLatticeMm) return true;
  if (!is_in(row)) return false;
  const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
  const Vec3 towards = SideNames::towards(centre_mm, walls_.outer(centre_mm));
  const std::vector<Vec3> ring = ring_mm(tool_, row.depth_mm, row.radius_mm, towards, ring_points_);
  const auto is_out = [&](const Vec3& p_mm) { return walls_.bone().lattice_mm(p_mm) > kSureLatticeMm; };
  if (std::any_of(ring.begin(), ring.end(), is_out)) return false;
  const std::vector<std::uint8_t> inside = inside_bone(walls_.bone(), ring);
  return std::all_of(inside.begin(), inside.end(), [](std::uint8_t one) { return one != 0; });
}

void FastBreach::find_opening() {
  first_in_ = 0;
  while (first_in_ < rows_.size() && !is_in(rows_[first_in_])) ++first_in_;
  opening_rows_ = 0;
  if (first_in_ == rows_.size()) return;
  const double end_mm = rows_[first_in_].depth_mm + opening_limit_mm(tool_.widest_mm());
  opening_rows_ = first_in_;
  while (opening_rows_ < rows_.size() && rows_[opening_rows_].depth_mm < end_mm && !is_whole(rows_[opening_rows_])) {
    ++opening_rows_;
  }
}

std::vector<double> FastBreach::least_canal_mm() const {
  constexpr std::size_t kApart = 8;
  std::vector<double> least_mm(rows_.size(), 0.0);
  for (std::size_t first = 0; first < rows_.size(); first += kApart) {
    // Between two places the distance cannot change by more than the way.
    const std::size_t end = std::min(rows_.size(), first + kApart);
    const std::size_t middle = first + (end - first) / 2;
    const double seen_mm = std::abs(walls_.canal(tool_.axis_mm(rows_[middle].depth_mm)).distance_mm);
    for (std::size_t n = first; n < end; ++n) {
      least_mm[n] = seen_mm - std::abs(rows_[n].depth_mm - rows_[middle].depth_mm) - BoneShape::kSampleMm;
    }
  }
  return least_mm;
}

FastBreach::Breaches FastBreach::breaches() const {
  // As find_breaches(): the ring with the largest possible breach first. What is possible is known from the lattice,
  // and better from the walls as seen from the axis, which are asked for when it is a row's turn.
  struct Candidate {
    double max_mm;
    std::size_t row;
    bool is_exact;
    WallDistance::Walls axis;

    bool operator<(const Candidate& other) const {
      if (max_mm != other.max_mm) return max_mm < other.max_mm;
      return row > other.row;
    }
  };
  std::priority_queue<Candidate> queue;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const double lattice_mm = rows_[n].lattice_mm;
    // Outside, the lattice has no more than the sign.
    const double max_mm = lattice_mm > -kSureLatticeMm ? kUnbounded : rows_[n].radius_mm + lattice_mm + kSureLatticeMm;
    if (max_mm > 0.0) queue.push({max_mm, n, false, {}});
  }
  Breaches best;
  if (queue.empty()) return best;
  const std::vector<double> least_mm = least_canal_mm();
  while (!queue.empty()) {
    Candidate top = queue.top();
    queue.pop();
    if (!(top.max_mm > std::min(best.outer_mm, best.canal_mm))) break;
    const Row& row = rows_[top.row];
    const bool is_opening = top.row < opening_rows_;
    const double canal_mm = top.is_exact ? std::abs(top.axis.canal.distance_mm) : std::max(0.0, least_mm[top.row]);
    const bool may_be_outer = !is_opening && top.max_mm > best.outer_mm;
    const bool may_be_canal = top.max_mm > best.canal_mm && canal_mm <= row.radius_mm + top.max_mm;
    if (!may_be_outer && !may_be_canal) continue;
    const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
    if (!top.is_exact) {
      top.axis = walls_.walls(centre_mm);
      top.max_mm = row.radius_mm - top.axis.nearer_mm();
      top.is_exact = true;
      if (top.max_mm > 0.0) queue.push(top);
      continue;
    }
    const bool nearer_is_canal = top.axis.canal.distance_mm < top.axis.outer.distance_mm;
    const Vec3 towards = SideNames::towards(centre_mm, nearer_is_canal ? top.axis.canal : top.axis.outer);
    for (const Vec3& p_mm : ring_mm(tool_, row.depth_mm, row.radius_mm, towards, ring_points_)) {
      if (walls_.bone().lattice_mm(p_mm) < -kSureLatticeMm) continue;
      const WallDistance::Beyond beyond = walls_.beyond(p_mm);
      if (is_opening && !beyond.is_canal) continue;
      double& of_wall_mm = beyond.is_canal ? best.canal_mm : best.outer_mm;
      of_wall_mm = std::max(of_wall_mm, beyond.distance_mm);
    }
  }
  return best;
}

double FastBreach::clearance_mm() const {
  constexpr double kBeforeIsthmusMm = 4.0;
  const double latest_mm = tool_.along_mm(sides_.pedicle().isthmus_mm) - kBeforeIsthmusMm;
  std::size_t bearing = opening_rows_;
  while (bearing < rows_.size() && rows_[bearing].depth_mm < latest_mm && !is_whole(rows_[bearing])) ++bearing;
  std::size_t first = bearing;
  for (; first < rows_.size() && rows_[first].depth_mm < latest_mm; ++first) {
    const Vec3 nearest_mm = walls_.outer(tool_.axis_mm(rows_[first].depth_mm)).nearest_mm;
    if (tool_.along_mm(nearest_mm) >= rows_[bearing].depth_mm) break;
  }
  double clearance_mm = kUnbounded;
  for (std::size_t n = first; n < rows_.size(); ++n) {
    clearance_mm = std::min(clearance_mm, -rows_[n].lattice_mm - rows_[n].radius_mm);
  }
  return std::max(0.0, clearance_mm);
}

}  // namespace spinaltap
