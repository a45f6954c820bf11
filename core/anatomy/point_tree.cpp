#include "core/anatomy/point_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <numeric>
#include <optional>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// The nearest point so far; of several as near the one that was met first.
class NearestSoFar {
 public:
  NearestSoFar() = default;
  /// Looks for points nearer than this only.
  explicit NearestSoFar(double squared_mm2) : squared_mm2_(squared_mm2) {}

  // Names as nanoflann asks for them; sort() since its version 1.6.
  using DistanceType = double;
  double worstDist() const { return squared_mm2_; }
  bool full() const { return true; }
  void sort() {}
  bool addPoint(double squared_mm2, std::size_t leaf_place) {
    if (squared_mm2 < squared_mm2_) {
      squared_mm2_ = squared_mm2;
      leaf_place_ = leaf_place;
    }
    return true;  // there may be nearer ones
  }

  static constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
  std::size_t leaf_place() const { return leaf_place_; }

 private:
  double squared_mm2_ = std::numeric_limits<double>::max();
  std::size_t leaf_place_ = kNowhere;
};

/// The points' numbers in the order of the tree's leaves: `vAcc` up to nanoflann 1.4, `vAcc_` since.
template <class Index>
auto& leaf_order(Index& index) {
  if constexpr (requires { index.vAcc_; }) {
    return index.vAcc_;
  } else {
    return index.vAcc;
  }
}

}  // namespace

struct PointTree::Tree {
  // Names as nanoflann asks for them.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const { return seen[n][static_cast<Eigen::Index>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3, std::uint32_t>;

  explicit Tree(std::vector<Vec3> points_mm) : points(std::move(points_mm)), seen(points.data()) {
    for (const Vec3& p : points) {
      if (!p.allFinite()) fail("point tree: expected finite positions");
    }
    if (points.empty()) return;
    index.emplace(3, *this, nanoflann::KDTreeSingleIndexAdaptorParams(12));
    // The points of a leaf side by side: a search spends most of its time on fetching them.
    auto& order = leaf_order(*index);
    originals.assign(order.begin(), order.end());
    std::iota(order.begin(), order.end(), 0U);
    in_leaves.reserve(points.size());
    for (const std::uint32_t original : originals) in_leaves.push_back(points[original]);
    seen = in_leaves.data();
    for (std::size_t first = 0; first < in_leaves.size(); first += kGroup) groups.push_back(group_at(first));
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  ~Tree() = default;

  /// In the order of the leaves what follows each other lies side by side.
  static constexpr std::size_t kGroup = 64;
  Group group_at(std::size_t first) const {
    const std::size_t count = std::min(in_leaves.size() - first, kGroup);
    Box3 box;
    for (std::size_t n = 0; n < count; ++n) box.extend(in_leaves[first + n]);
    return {box.center(), 0.5 * box.diagonal().norm(), std::span(originals).subspan(first, count)};
  }

  Nearest search(const Vec3& p_mm, NearestSoFar result) const {
    Nearest found;
    if (!index || !p_mm.allFinite()) return found;
    index->findNeighbors(result, p_mm.data(), {});
    if (result.leaf_place() == NearestSoFar::kNowhere) return found;
    found.index = originals[result.leaf_place()];
    found.distance_mm = std::sqrt(result.worstDist());
    return found;
  }

  std::vector<Vec3> points;
  std::vector<Vec3> in_leaves;           ///< the same points in the order of the tree's leaves
  std::vector<std::uint32_t> originals;  ///< of each of in_leaves, its place in points
  const Vec3* seen;                      ///< what the index numbers its points by
  std::vector<Group> groups;             ///< of in_leaves
  std::optional<Index> index;
};

PointTree::PointTree(std::vector<Vec3> points_mm) : tree_(std::make_unique<const Tree>(std::move(points_mm))) {}
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;
PointTree::~PointTree() = default;

const std::vector<Vec3>& PointTree::points_mm() const { return tree_->points; }

PointTree::Nearest PointTree::nearest(const Vec3& p_mm) const { return tree_->search(p_mm, NearestSoFar()); }

PointTree::Nearest PointTree::nearest(const Vec3& p_mm, std::size_t guess) const {
  if (guess >= tree_->points.size()) return nearest(p_mm);
  // The tree goes the same way with any bound and only passes over more: it meets the guess itself, or one as near that
  // comes first, just within this.
  constexpr double kJustBeyond = 1.0 + 1e-12;
  const double squared_mm2 = (p_mm - tree_->points[guess]).squaredNorm();
  return tree_->search(p_mm, NearestSoFar(squared_mm2 * kJustBeyond + std::numeric_limits<double>::min()));
}

const std::vector<PointTree::Group>& PointTree::groups() const { return tree_->groups; }

std::vector<std::size_t> PointTree::along(const Stretch& stretch) const {
  std::vector<std::size_t> found;
  for (const Group& group : groups()) {
    const Vec3 way_mm = group.middle_mm - stretch.origin_mm;
    const double along_mm = way_mm.dot(stretch.direction);
    if (along_mm < stretch.from_mm - group.radius_mm || along_mm > stretch.to_mm + group.radius_mm) continue;
    const double near_mm = stretch.reach_mm + group.radius_mm;
    if (way_mm.squaredNorm() - along_mm * along_mm > near_mm * near_mm + 1e-6) continue;
    found.insert(found.end(), group.points.begin(), group.points.end());
  }
  return found;
}

}  // namespace spinaltap
