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
constexpr float kFarthestMm = 1e6F;

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
    return distance_mm < static_cast<double>(kFarthestMm) ? static_cast<float>(distance_mm) : kNoWall;
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

bool WallLattice::node_at(const Vec3& p_path, Node& node) const noexcept {
  const double x = (p_path.x() - low_mm_.x()) * per_mm_;
  const double y = (p_path.y() - low_mm_.y()) * per_mm_;
  const double z = (p_path.z() - low_mm_.z()) * per_mm_;
  // Also what is not a number has no distance.
  if (!(x >= 0.0 && y >= 0.0 && z >= 0.0 && x < last_.x() && y < last_.y() && z < last_.z())) return false;
  const int i = static_cast<int>(x), j = static_cast<int>(y), k = static_cast<int>(z);
  const auto share_x = static_cast<float>(x - i), share_y = static_cast<float>(y - j),
             share_z = static_cast<float>(z - k);
  const std::ptrdiff_t next_y = count_.z(), next_x = next_y * count_.y();
  const Node* const c00 = nodes_.data() + i * next_x + j * next_y + k;
  const auto along_z = [&](const Node* of) -> Node { return of[0] + share_z * (of[1] - of[0]); };
  const auto along_y = [&](const Node* of) -> Node {
    const Node at = along_z(of);
    return at + share_y * (along_z(of + next_y) - at);
  };
  const Node low = along_y(c00);
  node = low + share_x * (along_y(c00 + next_x) - low);
  return true;
}

double WallLattice::distance_mm(const Vec3& p_path, WallKind wall) const noexcept {
  constexpr double kNoDistance = std::numeric_limits<double>::infinity();
  Node value;
  if (!node_at(p_path, value)) return kNoDistance;
  // The nearer wall is the bone's surface; the other one is ahead, wherever the place is.
  const bool is_canal_nearer = value[2] < value[1];
  const bool is_nearer = is_canal_nearer == (wall == WallKind::canal);
  const float distance_mm = is_nearer ? value[0] : value[wall == WallKind::canal ? 2 : 1];
  return distance_mm < kFarthestMm ? static_cast<double>(distance_mm) : kNoDistance;
}

double WallLattice::inside_mm(const Vec3& p_path) const noexcept {
  Node value;
  if (!node_at(p_path, value) || !(value[0] < kFarthestMm)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(value[0]);
}

}  // namespace spinaltap
