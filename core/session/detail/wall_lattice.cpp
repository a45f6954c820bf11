#include "core/session/detail/wall_lattice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

/// Stands for no wall and for nodes out of reach; what it is mixed into is no distance any more.
constexpr float kNoWall = 1e12F;

/// `beside`: the walls of each bone at a place close by; becomes those of this one.
Eigen::Array4f node_of(std::span<const WallDistance* const> bones, const Vec3& p_mm,
                       std::vector<WallDistance::Walls>& beside) {
  constexpr double kNowhereMm = std::numeric_limits<double>::infinity();
  double surface_mm = -kNowhereMm, outer_mm = kNowhereMm, canal_mm = kNowhereMm;
  for (std::size_t n = 0; n < bones.size(); ++n) {
    const WallDistance::Walls walls = beside[n] = bones[n]->walls(p_mm, beside[n]);
    surface_mm = std::max(surface_mm, walls.nearer_mm());
    outer_mm = std::min(outer_mm, std::abs(walls.outer.distance_mm));
    canal_mm = std::min(canal_mm, std::abs(walls.canal.distance_mm));
  }
  const auto kept = [](double distance_mm) {
    return distance_mm < static_cast<double>(WallLattice::kFarthestMm) ? static_cast<float>(distance_mm) : kNoWall;
  };
  return {kept(surface_mm), kept(outer_mm), kept(canal_mm), 0.0F};
}

}  // namespace

WallLattice::WallLattice(std::span<const WallDistance* const> walls, const DrillPath& path, double spacing_mm,
                         double reach_mm, double behind_mm, double beyond_mm, const Progress& progress)
    : per_mm_(1.0 / spacing_mm) {
  constexpr double kLongestMm = 200.0;
  check_path(path);
  for (const double range_mm : {reach_mm, behind_mm, beyond_mm}) {
    if (!(range_mm >= 0.0 && range_mm <= kLongestMm)) {
      fail("clearances: expected ranges around the path from 0 to ", kLongestMm, " mm, found ", range_mm, " mm");
    }
  }
  frame_ = PathFrame(path.entry_mm, path.direction());
  const PathCurve curve(path);
  low_mm_ = Vec3(-reach_mm, -reach_mm, -behind_mm);
  Vec3 high_mm(reach_mm, reach_mm, curve.length_mm() + beyond_mm);
  if (!curve.is_straight()) {
    // Along the chord; ends of the way may be turned from it.
    const PathCurve::AboutChord about = curve.about_chord(-behind_mm, curve.length_mm() + beyond_mm);
    const double aside_mm = reach_mm + about.off_mm;
    low_mm_ = Vec3(-aside_mm, -aside_mm, about.low_mm - reach_mm);
    high_mm = Vec3(aside_mm, aside_mm, about.high_mm + reach_mm);
  }
  count_ = ((high_mm - low_mm_) * per_mm_).array().ceil().cast<int>() + 1;
  last_ = (count_ - 1).cast<double>();
  next_y_ = count_.z();
  next_x_ = next_y_ * count_.y();
  nodes_.resize(static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
                    static_cast<std::size_t>(count_.z()),
                Node(kNoWall, kNoWall, kNoWall, 0.0F));
  // Cells that the cylinder passes need all their nodes.
  const double widest_mm = reach_mm + 1.5 * spacing_mm;
  const int columns = count_.x() * count_.y();
  ProgressCounter counter(progress, "clearances", static_cast<std::size_t>(columns));
  tbb::parallel_for(0, columns, [&](int column) {
    counter.add();
    const int i = column / count_.y();
    const Vec3 foot_mm = low_mm_ + spacing_mm * Vec3(i, column - i * count_.y(), 0.0);
    if (curve.is_straight() && std::hypot(foot_mm.x(), foot_mm.y()) > widest_mm) return;
    std::vector<WallDistance::Walls> beside(walls.size());
    for (int k = 0; k < count_.z(); ++k) {
      const Vec3 p_path = foot_mm + spacing_mm * k * Vec3::UnitZ();
      if (!curve.is_straight()) {
        const Vec3 p_mm = frame_.to_patient(p_path);
        const double at_mm = std::clamp(curve.nearest_mm(p_mm), -behind_mm, curve.length_mm() + beyond_mm);
        if ((curve.at_mm(at_mm) - p_mm).norm() > widest_mm) continue;
      }
      nodes_[static_cast<std::size_t>(column) * static_cast<std::size_t>(count_.z()) + static_cast<std::size_t>(k)] =
          node_of(walls, frame_.to_patient(p_path), beside);
    }
  });
}

}  // namespace spinaltap
