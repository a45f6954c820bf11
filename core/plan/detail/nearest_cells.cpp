#include "core/plan/detail/nearest_cells.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

namespace spinaltap {
namespace {

/// What `make` makes, once for all threads: of several that make it at the same time one is kept.
template <class T, class Owner, class Make>
T& made_once(std::atomic<T*>& place, const Make& make) {
  T* found = place.load(std::memory_order_acquire);
  if (found != nullptr) return *found;
  Owner made = make();
  if (place.compare_exchange_strong(found, made.get(), std::memory_order_acq_rel)) return *made.release();
  return *found;
}

/// From a block's middle. Single precision: small, and quick to search; what it leaves open the points themselves say.
struct alignas(16) Near {
  float x, y, z;
  float none = 0.0F;  ///< fills a register's lane
};
Near operator-(const Near& a, const Near& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float squared(const Near& a) { return a.x * a.x + a.y * a.y + a.z * a.z; }
float sum_of_sizes(const Near& a) { return std::abs(a.x) + std::abs(a.y) + std::abs(a.z); }
Near near_of(const Vec3& mm) {
  return {static_cast<float>(mm.x()), static_cast<float>(mm.y()), static_cast<float>(mm.z())};
}

/// A register of the plainest x86; other machines' compilers do as well with it.
using Four = float __attribute__((vector_size(16)));
constexpr std::size_t kLanes = 4;
Four all_lanes(float value) { return Four{value, value, value, value}; }
Four lanes_of(const Near& point) {
  Four lanes;
  std::memcpy(&lanes, &point, sizeof lanes);
  return lanes;
}
/// A point that is nearest to nothing: lists are filled up with it to whole registers.
constexpr Near kNowhere{1e18F, 1e18F, 1e18F};

/// Writes squared distances from p of a list's points, and returns the least.
template <class Place>
float squares_to(const Near& p, const std::vector<Near>& points, std::span<const Place> places, float* squared_mm2) {
  const Four px = all_lanes(p.x), py = all_lanes(p.y), pz = all_lanes(p.z);
  Four least = all_lanes(std::numeric_limits<float>::infinity());
  for (std::size_t n = 0; n < places.size(); n += kLanes) {
    const Four a = lanes_of(points[places[n]]), b = lanes_of(points[places[n + 1]]);
    const Four c = lanes_of(points[places[n + 2]]), d = lanes_of(points[places[n + 3]]);
    const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Four x = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) - px;
    const Four y = __builtin_shufflevector(ab, cd, 2, 3, 6, 7) - py;
    const Four z = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 6, 3, 7),
                                           __builtin_shufflevector(c, d, 2, 6, 3, 7), 0, 1, 4, 5) -
                   pz;
    const Four sum = x * x + y * y + z * z;
    std::memcpy(squared_mm2 + n, &sum, sizeof sum);
    least = sum < least ? sum : least;
  }
  return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
}

/// Of a cube of cells, a little larger: which one a position on its border lies in is rounded.
float half_with_border(double side_mm) { return static_cast<float>(0.5 * side_mm + 1e-5); }

/// A cube of positions.
struct Cube {
  Near middle;
  float half_mm;
};

/// Those of `places` in `points` that can be nearest to a position in the cube, and perhaps some more. Squared
/// distances may be wrong by `tolerance_mm2`.
template <class Place>
std::vector<Place> can_be_nearest(const std::vector<Near>& points, std::span<const Place> places, const Cube& cube,
                                  float tolerance_mm2) {
  struct Candidate {
    Near from_middle;
    float squared_mm2;
    Place place;
  };
  const auto& [middle, half_mm] = cube;
  // The difference of two points' squared distances is linear in the position: at most this in the cube.
  const auto is_beaten_by = [half_mm = half_mm, tolerance_mm2](const Candidate& rival, const Candidate& candidate) {
    return rival.squared_mm2 - candidate.squared_mm2 +
               2.0F * half_mm * sum_of_sizes(rival.from_middle - candidate.from_middle) <
           -tolerance_mm2;
  };
  std::vector<Candidate> near;
  near.reserve(places.size());
  Candidate first{{}, std::numeric_limits<float>::infinity(), 0};
  for (const Place place : places) {
    const Near from_middle = points[place] - middle;
    near.push_back({from_middle, squared(from_middle), place});
    if (near.back().squared_mm2 < first.squared_mm2) first = near.back();
  }
  // What the one that is nearest to the middle beats leaves few to look at.
  std::erase_if(near, [&](const Candidate& candidate) { return is_beaten_by(first, candidate); });
  const auto beat_at = [&](const Near& p) {
    Candidate rival{{}, std::numeric_limits<float>::infinity(), 0};
    float rival_mm2 = std::numeric_limits<float>::infinity();
    for (const Candidate& candidate : near) {
      const float mm2 = squared(candidate.from_middle - p);
      if (mm2 < rival_mm2) rival = candidate;
      rival_mm2 = std::min(rival_mm2, mm2);
    }
    std::erase_if(near, [&](const Candidate& candidate) { return is_beaten_by(rival, candidate); });
  };
  for (std::size_t n = 0; n < 8; ++n) {
    beat_at({(n & 1) != 0 ? half_mm : -half_mm, (n & 2) != 0 ? half_mm : -half_mm, (n & 4) != 0 ? half_mm : -half_mm});
  }
  for (std::size_t n = 0; n < 6; ++n) {
    const float side_mm = (n & 1) != 0 ? half_mm : -half_mm;
    beat_at({n / 2 == 0 ? side_mm : 0.0F, n / 2 == 1 ? side_mm : 0.0F, n / 2 == 2 ? side_mm : 0.0F});
  }
  std::vector<Place> left;
  left.reserve(near.size());
  for (const Candidate& candidate : near) left.push_back(candidate.place);
  return left;
}

}  // namespace

struct NearestCells::Block {
  Vec3 middle_mm = Vec3::Zero();
  float tolerance_mm2 = 0.0F;        ///< by which squared distances in it may be wrong
  std::vector<Near> points;          ///< and kNowhere; none: too many, or too far away
  std::vector<std::uint32_t> index;  ///< of each, its place in the tree's points
  std::array<std::atomic<const Cell*>, kCellsASide * kCellsASide * kCellsASide> cells{};
  std::array<std::atomic<const Cell*>, kPartsASide * kPartsASide * kPartsASide> parts{};

  Block() = default;
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  ~Block() {
    for (std::atomic<const Cell*>& cell : cells) delete[] cell.load();
    for (std::atomic<const Cell*>& part : parts) delete[] part.load();
  }

  /// What may be nearest in one of so many cubes a side, of places that are enough for it.
  std::unique_ptr<const Cell[]> cube(const std::array<std::size_t, 3>& at, std::size_t a_side,
                                     std::span<const Cell> places) const {
    const double side_mm = kBlockMm / static_cast<double>(a_side);
    const Vec3 first(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
    const Vec3 of_cube_mm = side_mm * (first + Vec3::Constant(0.5)) - Vec3::Constant(0.5 * kBlockMm);
    const std::vector<Cell> left =
        can_be_nearest(points, places, {near_of(of_cube_mm), half_with_border(side_mm)}, tolerance_mm2);
    const std::size_t filled_up = (left.size() + kLanes - 1) / kLanes * kLanes;
    auto cell = std::make_unique<Cell[]>(filled_up + 1);
    cell[0] = static_cast<Cell>(filled_up);
    std::fill_n(std::copy(left.begin(), left.end(), cell.get() + 1), filled_up - left.size(),
                static_cast<Cell>(index.size()));
    return cell;
  }
  std::span<const Cell> cell(const std::array<std::size_t, 3>& at) {
    const auto place_of = [](const std::array<std::size_t, 3>& of, std::size_t a_side) {
      return (of[2] * a_side + of[1]) * a_side + of[0];
    };
    using Owner = std::unique_ptr<const Cell[]>;
    const Cell& found = made_once<const Cell, Owner>(cells[place_of(at, kCellsASide)], [&] {
      const std::array<std::size_t, 3> around{at[0] / kCellsAPart, at[1] / kCellsAPart, at[2] / kCellsAPart};
      const Cell& part = made_once<const Cell, Owner>(parts[place_of(around, kPartsASide)], [&] {
        std::vector<Cell> all(index.size());
        std::iota(all.begin(), all.end(), Cell{0});
        return cube(around, kPartsASide, all);
      });
      return cube(at, kCellsASide, {&part + 1, part});
    });
    return {&found + 1, found};
  }
};

NearestCells::NearestCells(const PointTree& tree) : tree_(tree) {
  constexpr double kAroundMm = 8.0;  // further away the tree is asked
  const Box3 bounds_mm = bounds_of(tree.points_mm());
  if (bounds_mm.isEmpty()) return;
  low_mm_ = bounds_mm.min() - Vec3::Constant(kAroundMm);
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kAroundMm;
    size_[axis] = static_cast<std::size_t>(std::ceil(side_mm / kBlockMm));
    count *= size_[axis];
  }
  blocks_ = std::vector<std::atomic<Block*>>(count);
}

NearestCells::~NearestCells() {
  for (std::atomic<Block*>& block : blocks_) delete block.load();
}

std::unique_ptr<NearestCells::Block> NearestCells::make_block(const Vec3& middle_mm) const {
  constexpr double kFarMm = 40.0;
  constexpr std::size_t kMany = std::numeric_limits<Cell>::max() - kLanes;
  auto block = std::make_unique<Block>();
  block->middle_mm = middle_mm;
  const double furthest_mm = tree_.nearest(middle_mm).distance_mm + std::numbers::sqrt3 * kBlockMm + 1e-3;
  if (furthest_mm > kFarMm) return block;
  std::vector<Near> around;
  std::vector<std::uint32_t> index;
  for (const PointTree::Group& group : tree_.groups()) {
    const double reach_mm = furthest_mm + group.radius_mm;
    if ((group.middle_mm - middle_mm).squaredNorm() > reach_mm * reach_mm) continue;
    for (const std::uint32_t n : group.points) {
      const Vec3 mm = tree_.points_mm()[n] - middle_mm;
      if (mm.squaredNorm() > furthest_mm * furthest_mm) continue;
      around.push_back(near_of(mm));
      index.push_back(n);
    }
  }
  // Coordinates are wrong by 2^-24 of themselves, and so is each sum; twice that, and as much again to spare.
  constexpr double kRounding = 2e-6;
  const double size_mm = furthest_mm + kBlockMm;
  block->tolerance_mm2 = static_cast<float>(kRounding * (1.0 + size_mm * size_mm));
  std::vector<std::uint32_t> all(around.size());
  std::iota(all.begin(), all.end(), 0U);
  const std::vector<std::uint32_t> left = can_be_nearest<std::uint32_t>(
      around, all, {{0.0F, 0.0F, 0.0F}, half_with_border(kBlockMm)}, block->tolerance_mm2);
  if (left.size() > kMany) return block;
  block->points.reserve(left.size() + 1);
  block->index.reserve(left.size());
  for (const std::uint32_t n : left) {
    block->points.push_back(around[n]);
    block->index.push_back(index[n]);
  }
  block->points.push_back(kNowhere);
  return block;
}

std::size_t NearestCells::nearest(const Vec3& p_mm) const {
  const Vec3 at_mm = p_mm - low_mm_;
  std::array<std::size_t, 3> of_blocks{}, in_block{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double in_cells = at_mm[static_cast<Eigen::Index>(axis)] / kCellMm;
    if (!(in_cells >= 0.0 && in_cells < static_cast<double>(size_[axis] * kCellsASide))) {
      return tree_.nearest(p_mm).index;
    }
    const auto cell = static_cast<std::size_t>(in_cells);
    of_blocks[axis] = cell / kCellsASide;
    in_block[axis] = cell % kCellsASide;
  }
  Block& block = made_once<Block, std::unique_ptr<Block>>(
      blocks_[(of_blocks[2] * size_[1] + of_blocks[1]) * size_[0] + of_blocks[0]], [&] {
        const Vec3 first(static_cast<double>(of_blocks[0]), static_cast<double>(of_blocks[1]),
                         static_cast<double>(of_blocks[2]));
        return make_block(low_mm_ + kBlockMm * (first + Vec3::Constant(0.5)));
      });
  if (block.points.empty()) return tree_.nearest(p_mm).index;
  const std::span<const Cell> places = block.cell(in_block);
  constexpr std::size_t kMost = 512;
  if (places.size() > kMost) return tree_.nearest(p_mm).index;
  std::array<float, kMost> near_mm2;
  const float least_mm2 = squares_to(near_of(p_mm - block.middle_mm), block.points, places, near_mm2.data());
  // Those that may be it by single precision, mostly one; else as PointTree sums it, bit for bit.
  std::size_t best = 0, count = 0;
  double best_squared = std::numeric_limits<double>::infinity();
  bool is_tie = false;
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (near_mm2[n] > least_mm2 + block.tolerance_mm2) continue;
    if (count++ == 0) {
      best = n;
      continue;
    }
    const auto squared_to = [&](std::size_t of) {
      return (p_mm - tree_.points_mm()[block.index[places[of]]]).squaredNorm();
    };
    if (count == 2) best_squared = squared_to(best);
    const double squared_mm2 = squared_to(n);
    if (squared_mm2 > best_squared) continue;
    is_tie = squared_mm2 == best_squared;
    best_squared = squared_mm2;
    best = n;
  }
  // Of several as near, the tree has an order of its own.
  return is_tie ? tree_.nearest(p_mm).index : block.index[places[best]];
}

}  // namespace spinaltap
