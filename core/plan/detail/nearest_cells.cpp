#include "core/plan/detail/nearest_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace spinaltap {
namespace {

/// What `make` makes, once for all threads: of several that make it at the same time one is kept.
template <class T, class Make>
T& made_once(std::atomic<T*>& place, const Make& make) {
  T* found = place.load(std::memory_order_acquire);
  if (found != nullptr) return *found;
  auto made = make();
  if (place.compare_exchange_strong(found, made.get(), std::memory_order_acq_rel)) return *made.release();
  return *found;
}

}  // namespace

void NearestCells::Points::add(const Vec3& p_mm, std::uint32_t place) {
  x.push_back(p_mm.x());
  y.push_back(p_mm.y());
  z.push_back(p_mm.z());
  index.push_back(place);
}

std::vector<double> NearestCells::Points::squared_mm2(const Vec3& p_mm) const {
  std::vector<double> squared(size());
  for (std::size_t n = 0; n < size(); ++n) {
    const double dx = p_mm.x() - x[n], dy = p_mm.y() - y[n], dz = p_mm.z() - z[n];
    squared[n] = dx * dx + dy * dy + dz * dz;
  }
  return squared;
}

std::size_t NearestCells::Points::nearest(const Vec3& p_mm) const {
  const std::vector<double> squared = squared_mm2(p_mm);
  return static_cast<std::size_t>(std::min_element(squared.begin(), squared.end()) - squared.begin());
}

NearestCells::Block::~Block() {
  for (std::atomic<const Points*>& cell : cells) delete cell.load();
}

NearestCells::NearestCells(const PointTree& tree) : tree_(tree) {
  constexpr double kAroundMm = 8.0;  // further away the tree is asked
  const Box3 bounds_mm = bounds_of(tree.points_mm());
  if (bounds_mm.isEmpty()) return;
  low_mm_ = bounds_mm.min() - Vec3::Constant(kAroundMm);
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kAroundMm;
    size_[axis] = static_cast<int>(std::ceil(side_mm / kBlockMm));
    count *= static_cast<std::size_t>(size_[axis]);
  }
  blocks_ = std::vector<std::atomic<Block*>>(count);
}

NearestCells::~NearestCells() {
  for (std::atomic<Block*>& block : blocks_) delete block.load();
}

NearestCells::Points NearestCells::can_be_nearest(const Points& around, const Vec3& middle_mm, double half_mm) {
  // Nearest to a corner of the cell, or to its middle: what is further than any of them from all of the cell is out.
  std::vector<double> squared = around.squared_mm2(middle_mm);
  const double nearest_mm = std::sqrt(*std::min_element(squared.begin(), squared.end()));
  const double furthest_mm = nearest_mm + 2.0 * std::numbers::sqrt3 * half_mm + 1e-6;
  Points near;
  for (std::size_t n = 0; n < around.size(); ++n) {
    if (squared[n] > furthest_mm * furthest_mm) continue;
    near.add(Vec3(around.x[n], around.y[n], around.z[n]), around.index[n]);
  }
  struct Rival {
    Vec3 from_middle_mm;
    double squared_mm2;
  };
  std::array<Rival, 9> rivals;
  for (std::size_t corner = 0; corner < rivals.size(); ++corner) {
    const Vec3 away = corner == 8 ? Vec3(Vec3::Zero())
                                  : Vec3(Vec3((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                                              (corner & 4) != 0 ? 1.0 : -1.0));
    const std::size_t n = near.nearest(middle_mm + half_mm * away);
    const Vec3 from_middle_mm = Vec3(near.x[n], near.y[n], near.z[n]) - middle_mm;
    rivals[corner] = {from_middle_mm, from_middle_mm.squaredNorm()};
  }
  Points left;
  for (std::size_t n = 0; n < near.size(); ++n) {
    const Vec3 p_mm(near.x[n], near.y[n], near.z[n]);
    const Vec3 from_middle_mm = p_mm - middle_mm;
    const double squared_mm2 = from_middle_mm.squaredNorm();
    // The difference of squared distances is linear in the position: at most this in the cell.
    const bool is_beaten = std::any_of(rivals.begin(), rivals.end(), [&](const Rival& rival) {
      return rival.squared_mm2 - squared_mm2 +
                 2.0 * half_mm * (rival.from_middle_mm - from_middle_mm).cwiseAbs().sum() <
             -1e-9;
    });
    if (!is_beaten) left.add(p_mm, near.index[n]);
  }
  return left;
}

NearestCells::Points NearestCells::block_points(const Vec3& middle_mm) const {
  const double half_mm = 0.5 * kBlockMm;
  const double furthest_mm = tree_.nearest(middle_mm).distance_mm + 2.0 * std::numbers::sqrt3 * half_mm + 1e-6;
  Points around;
  for (const PointTree::Group& group : tree_.groups()) {
    const double reach_mm = furthest_mm + group.radius_mm;
    if ((group.middle_mm - middle_mm).squaredNorm() > reach_mm * reach_mm) continue;
    for (const std::uint32_t n : group.points) around.add(tree_.points_mm()[n], n);
  }
  return can_be_nearest(around, middle_mm, half_mm);
}

std::size_t NearestCells::nearest(const Vec3& p_mm) const {
  const Vec3 at_mm = p_mm - low_mm_;
  constexpr auto kASide = static_cast<std::size_t>(kCellsASide);
  std::array<std::size_t, 3> cell{}, of_blocks{}, in_block{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double in_cells = at_mm[static_cast<Eigen::Index>(axis)] / kCellMm;
    if (!(in_cells >= 0.0 && in_cells < static_cast<double>(size_[axis] * kCellsASide))) {
      return tree_.nearest(p_mm).index;
    }
    cell[axis] = static_cast<std::size_t>(in_cells);
    of_blocks[axis] = cell[axis] / kASide;
    in_block[axis] = cell[axis] % kASide;
  }
  const auto middle_of = [this](const std::array<std::size_t, 3>& place, double side_mm) {
    const Vec3 first(static_cast<double>(place[0]), static_cast<double>(place[1]), static_cast<double>(place[2]));
    return Vec3(low_mm_ + side_mm * (first + Vec3::Constant(0.5)));
  };
  const std::size_t columns = static_cast<std::size_t>(size_[0]), rows = static_cast<std::size_t>(size_[1]);
  Block& block = made_once(blocks_[(of_blocks[2] * rows + of_blocks[1]) * columns + of_blocks[0]], [&] {
    auto made = std::make_unique<Block>();
    made->points = block_points(middle_of(of_blocks, kBlockMm));
    return made;
  });
  const std::size_t cell_at = (in_block[2] * kASide + in_block[1]) * kASide + in_block[0];
  const Points& points = made_once(block.cells[cell_at], [&] {
    const Vec3 middle_mm = middle_of(cell, kCellMm);
    // A little larger: which cell a position on its border lies in is rounded.
    return std::unique_ptr<const Points>(
        std::make_unique<Points>(can_be_nearest(block.points, middle_mm, 0.5 * kCellMm + 1e-6)));
  });

  constexpr std::size_t kAtOnce = 64;
  std::array<double, kAtOnce> squared;
  double best_squared = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  bool is_tie = false;
  for (std::size_t first = 0; first < points.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, points.size() - first);
    const double *x = points.x.data() + first, *y = points.y.data() + first, *z = points.z.data() + first;
    // As PointTree sums it, bit for bit.
    for (std::size_t n = 0; n < count; ++n) {
      const double dx = p_mm.x() - x[n], dy = p_mm.y() - y[n], dz = p_mm.z() - z[n];
      squared[n] = dx * dx + dy * dy + dz * dz;
    }
    for (std::size_t n = 0; n < count; ++n) {
      if (squared[n] > best_squared) continue;
      is_tie = squared[n] == best_squared;
      best_squared = squared[n];
      best = first + n;
    }
  }
  // Of several as near, the tree has an order of its own.
  return is_tie ? tree_.nearest(p_mm).index : points.index[best];
}

}  // namespace spinaltap
