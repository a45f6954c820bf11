#include "core/plan/point_tree.h"

#include <cmath>
#include <nanoflann.hpp>
#include <optional>

#include "core/base/error.h"

namespace spinaltap {

struct PointTree::Tree {
  // Names as nanoflann asks for them.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const { return points[n][static_cast<Eigen::Index>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3>;

  explicit Tree(std::vector<Vec3> points_mm) : points(std::move(points_mm)) {
    for (const Vec3& p : points) {
      if (!p.allFinite()) fail("point tree: expected finite positions");
    }
    if (!points.empty()) index.emplace(3, *this, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  ~Tree() = default;

  std::vector<Vec3> points;
  std::optional<Index> index;
};

PointTree::PointTree(std::vector<Vec3> points_mm) : tree_(std::make_unique<const Tree>(std::move(points_mm))) {}
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;
PointTree::~PointTree() = default;

const std::vector<Vec3>& PointTree::points_mm() const { return tree_->points; }

PointTree::Nearest PointTree::nearest(const Vec3& p_mm) const {
  Nearest found;
  if (!tree_->index || !p_mm.allFinite()) return found;
  double squared_mm2 = 0.0;
  nanoflann::KNNResultSet<double> result(1);
  result.init(&found.index, &squared_mm2);
  tree_->index->findNeighbors(result, p_mm.data(), nanoflann::SearchParams());
  found.distance_mm = std::sqrt(squared_mm2);
  return found;
}

}  // namespace spinaltap
