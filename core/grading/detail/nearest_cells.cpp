#include "core/grading/detail/nearest_cells.h"

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
struct Near {
  float x, y, z;
};
Near operator-(const Near& a, const Near& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float squared(const Near& a) { return a.x * a.x + a.y * a.y + a.z * a.z; }
float sum_of_sizes(const Near& a) { return std::abs(a.x) + std::abs(a.y) + std::abs(a.z); }
Near near_of(const Vec3& mm) {
  return {static_cast<float>(mm.x()), static_cast<float>(mm.y()), static_cast<float>(mm.z())};
}

/// A register of the plainest x86; other machines' compilers do as well with it.
using Lanes = float __attribute__((vector_size(16)));
constexpr std::size_t kLanes = 4;
Lanes all_lanes(float value) { return Lanes{value, value, value, value}; }
/// A point that is nearest to nothing: lists are filled up with it to whole registers.
constexpr Near kNowhere{1e18F, 1e18F, 1e18F};

/// The nearest of a cell's points, by single precision.
struct NearestInCell {
  std::uint32_t index;
  float squared_mm2;
  float next_squared_mm2;  ///< of the next nearest
};

/// Of a cube of cells, a little larger: which one a position on its border lies in is rounded.
float half_with_border(double side_mm) { return static_cast<float>(0.5 * side_mm + 1e-5); }

/// A cube of positions.
struct Cube {
  Near middle;
  float half_mm;
};

/// Candidates as seen from a cube's middle, four at a time.
struct FourCandidates {
  Lanes x, y, z, squared_mm2;
  Lanes beaten;  ///< the least of what rivals leave of it: below minus the tolerance, it is nearest nowhere in the cube
};

Lanes absolute_of(const Lanes& a) {
  const Lanes minus = -a;
  return a < minus ? minus : a;
}

/// Those of `places` that can be nearest to a position in the cube, and perhaps some more. Squared distances may be
/// wrong by `tolerance_mm2`. `point(place)`: where it is.
template <class Place, class Point>
std::vector<Place> can_be_nearest(const Point& point, std::span<const Place> places, const Cube& cube,
                                  float tolerance_mm2) {
  const Near middle = cube.middle;
  const float half_mm = cube.half_mm;
  Near first = kNowhere;
  float first_mm2 = std::numeric_limits<float>::infinity();
  for (const Place place : places) {
    const Near from_middle = point(place) - middle;
    const float mm2 = squared(from_middle);
    if (mm2 < first_mm2) first = from_middle;
    first_mm2 = std::min(first_mm2, mm2);
  }
  // What the one that is nearest to the middle beats leaves few to look at. The difference of two points' squared
  // distances is linear in the position: at most this in the cube.
  std::vector<Place> left;
  std::vector<FourCandidates> near;
  for (const Place place : places) {
    const Near from_middle = point(place) - middle;
    const float mm2 = squared(from_middle);
    if (first_mm2 - mm2 + 2.0F * half_mm * sum_of_sizes(first - from_middle) < -tolerance_mm2) continue;
    const std::size_t lane = left.size() % kLanes;
    if (lane == 0) {
      const Lanes far = all_lanes(kNowhere.x);
      near.push_back({far, far, far, far * far, all_lanes(0.0F)});
    }
    near.back().x[lane] = from_middle.x;
    near.back().y[lane] = from_middle.y;
    near.back().z[lane] = from_middle.z;
    near.back().squared_mm2[lane] = mm2;
    left.push_back(place);
  }
  const auto beat_at = [&near, half_mm](const Near& p) {
    // Without the position's own square, which all have.
    Lanes least = all_lanes(std::numeric_limits<float>::infinity()), rival_x{}, rival_y{}, rival_z{}, rival_mm2{};
    for (const FourCandidates& of : near) {
      const Lanes mm2 = of.squared_mm2 - 2.0F * (p.x * of.x + p.y * of.y + p.z * of.z);
      const auto is_less = mm2 < least;
      least = is_less ? mm2 : least;
      rival_x = is_less ? of.x : rival_x;
      rival_y = is_less ? of.y : rival_y;
      rival_z = is_less ? of.z : rival_z;
      rival_mm2 = is_less ? of.squared_mm2 : rival_mm2;
    }
    std::size_t best = 0;
    for (std::size_t lane = 1; lane < kLanes; ++lane) {
      if (least[lane] < least[best]) best = lane;
    }
    const float x = rival_x[best], y = rival_y[best], z = rival_z[best], mm2 = rival_mm2[best];
    for (FourCandidates& of : near) {
      const Lanes left_mm2 = mm2 - of.squared_mm2 +
                             2.0F * half_mm * (absolute_of(x - of.x) + absolute_of(y - of.y) + absolute_of(z - of.z));
      of.beaten = left_mm2 < of.beaten ? left_mm2 : of.beaten;
    }
  };
  for (std::size_t n = 0; n < 8; ++n) {
    beat_at({(n & 1) != 0 ? half_mm : -half_mm, (n & 2) != 0 ? half_mm : -half_mm, (n & 4) != 0 ? half_mm : -half_mm});
  }
  for (std::size_t n = 0; n < 6; ++n) {
    const float side_mm = (n & 1) != 0 ? half_mm : -half_mm;
    beat_at({n / 2 == 0 ? side_mm : 0.0F, n / 2 == 1 ? side_mm : 0.0F, n / 2 == 2 ? side_mm : 0.0F});
  }
  std::size_t n = 0;
  std::erase_if(left, [&](Place) {
    const bool is_beaten = near[n / kLanes].beaten[n % kLanes] < -tolerance_mm2;
    ++n;
    return is_beaten;
  });
  return left;
}

}  // namespace

/// Lanes points that can be nearest in a cell, from the block's middle: a cache line.
struct alignas(64) NearestCells::Four {
  Lanes x, y, z;
  std::array<std::uint32_t, kLanes>
      index;  ///< in the tree's points, below kLast; of the last four the first has it set

  static constexpr std::uint32_t kLast = 0x80000000U;
  bool is_last() const { return (index[0] & kLast) != 0; }
  Lanes squared_to(const Near& p) const {
    const Lanes dx = x - all_lanes(p.x), dy = y - all_lanes(p.y), dz = z - all_lanes(p.z);
    return dx * dx + dy * dy + dz * dz;
  }
};

struct NearestCells::Block {
  /// Places in `index`.
  using Place = std::uint16_t;
  using Part = std::vector<Place>;

  Vec3 middle_mm = Vec3::Zero();
  float tolerance_mm2 = 0.0F;                    ///< by which squared distances in it may be wrong
  const std::vector<Vec3>* points_mm = nullptr;  ///< the tree's
  std::vector<std::uint32_t> index;              ///< in those; none: too many, or too far away
  std::array<std::atomic<const Four*>, kCellsASide * kCellsASide * kCellsASide> cells{};
  /// How often cells that are not made were asked, at least.
  std::array<std::atomic<std::uint8_t>, kCellsASide * kCellsASide * kCellsASide> asked{};
  std::array<std::atomic<const Part*>, kPartsASide * kPartsASide * kPartsASide> parts{};

  Block() = default;
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  ~Block() {
    for (std::atomic<const Four*>& cell : cells) delete[] cell.load();
    for (std::atomic<const Part*>& part : parts) delete part.load();
  }

  Near near(Place place) const { return near_of((*points_mm)[index[place]] - middle_mm); }
  /// What may be nearest in one of so many cubes a side, of places that are enough for it.
  Part cube(const std::array<std::size_t, 3>& at, std::size_t a_side, std::span<const Place> places) const {
    const double side_mm = kBlockMm / static_cast<double>(a_side);
    const Vec3 first(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
    const Vec3 of_cube_mm = side_mm * (first + Vec3::Constant(0.5)) - Vec3::Constant(0.5 * kBlockMm);
    const auto point = [this](Place place) { return near(place); };
    return can_be_nearest(point, places, {near_of(of_cube_mm), half_with_border(side_mm)}, tolerance_mm2);
  }
  std::unique_ptr<const Four[]> fours_of(const Part& places) const {
    const std::size_t count = (places.size() + kLanes - 1) / kLanes;
    auto fours = std::make_unique<Four[]>(count);
    for (std::size_t n = 0; n < kLanes * count; ++n) {
      const bool is_point = n < places.size();
      const Near point = is_point ? near(places[n]) : kNowhere;
      Four& four = fours[n / kLanes];
      four.x[n % kLanes] = point.x;
      four.y[n % kLanes] = point.y;
      four.z[n % kLanes] = point.z;
      four.index[n % kLanes] = is_point ? index[places[n]] : 0;
    }
    fours[count - 1].index[0] |= Four::kLast;
    return fours;
  }
  static std::size_t place_of(const std::array<std::size_t, 3>& at, std::size_t a_side) {
    return (at[2] * a_side + at[1]) * a_side + at[0];
  }
  /// None while it has been asked too seldom to be worth making: that takes as long as some searches of the tree, and
  /// memory.
  const Four* cell(const std::array<std::size_t, 3>& at) {
    constexpr std::uint8_t kSeldom = 2;
    const std::size_t place = place_of(at, kCellsASide);
    if (cells[place].load(std::memory_order_relaxed) == nullptr &&
        asked[place].fetch_add(1, std::memory_order_relaxed) < kSeldom) {
      return nullptr;
    }
    return &made_once<const Four, std::unique_ptr<const Four[]>>(cells[place], [&] {
      const std::array<std::size_t, 3> around{at[0] / kCellsAPart, at[1] / kCellsAPart, at[2] / kCellsAPart};
      const Part& part = made_once<const Part, std::unique_ptr<const Part>>(parts[place_of(around, kPartsASide)], [&] {
        Part all(index.size());
        std::iota(all.begin(), all.end(), Place{0});
        return std::make_unique<const Part>(cube(around, kPartsASide, all));
      });
      return fours_of(cube(at, kCellsASide, part));
    });
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
  constexpr std::size_t kMany = std::numeric_limits<Block::Place>::max();
  auto block = std::make_unique<Block>();
  block->middle_mm = middle_mm;
  block->points_mm = &tree_.points_mm();
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
  const std::vector<std::uint32_t> left =
      can_be_nearest<std::uint32_t>([&around](std::uint32_t n) { return around[n]; }, all,
                                    {{0.0F, 0.0F, 0.0F}, half_with_border(kBlockMm)}, block->tolerance_mm2);
  if (left.size() > kMany) return block;
  block->index.reserve(left.size());
  for (const std::uint32_t n : left) block->index.push_back(index[n]);
  return block;
}

namespace {

template <class Fours>
NearestInCell nearest_in(const Fours* four, const Near& p) {
  Lanes least = all_lanes(std::numeric_limits<float>::infinity()), next = least;
  using Indices = std::uint32_t __attribute__((vector_size(16)));
  Indices index{};
  bool is_last = false;
  for (; !is_last; ++four) {
    const Lanes squared = four->squared_to(p);
    Indices of;
    std::memcpy(&of, four->index.data(), sizeof of);
    const auto is_less = squared < least;
    const Lanes other = is_less ? least : squared;
    next = other < next ? other : next;
    least = is_less ? squared : least;
    index = is_less ? of : index;
    is_last = four->is_last();
  }
  NearestInCell nearest{0, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const bool is_less = least[lane] < nearest.squared_mm2;
    const float other = is_less ? nearest.squared_mm2 : least[lane];
    nearest.next_squared_mm2 = std::min({nearest.next_squared_mm2, other, next[lane]});
    if (!is_less) continue;
    nearest.squared_mm2 = least[lane];
    nearest.index = index[lane] & ~Fours::kLast;
  }
  return nearest;
}

}  // namespace

bool NearestCells::find_cell(const Vec3& p_mm, CellPlace& place) const {
  const Vec3 at_mm = p_mm - low_mm_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double in_cells = at_mm[static_cast<Eigen::Index>(axis)] / kCellMm;
    if (!(in_cells >= 0.0 && in_cells < static_cast<double>(size_[axis] * kCellsASide))) return false;
    const auto cell = static_cast<std::size_t>(in_cells);
    place.of_blocks[axis] = cell / kCellsASide;
    place.in_block[axis] = cell % kCellsASide;
  }
  place.block = (place.of_blocks[2] * size_[1] + place.of_blocks[1]) * size_[0] + place.of_blocks[0];
  return true;
}

void NearestCells::expect(std::span<const Vec3> places_mm) const {
  // First for where the cells are, then for the cells: each is waited for no longer than the first.
  constexpr std::size_t kMost = 64;
  std::array<const std::atomic<const Four*>*, kMost> cells{};
  std::size_t count = 0;
  for (const Vec3& p_mm : places_mm.first(std::min(places_mm.size(), kMost))) {
    CellPlace place;
    if (!find_cell(p_mm, place)) continue;
    const Block* const block = blocks_[place.block].load(std::memory_order_acquire);
    if (block == nullptr) continue;
    cells[count] = &block->cells[Block::place_of(place.in_block, kCellsASide)];
    __builtin_prefetch(cells[count++]);
  }
  for (std::size_t n = 0; n < count; ++n) {
    constexpr std::size_t kUsual = 6;
    const Four* const cell = cells[n]->load(std::memory_order_acquire);
    if (cell == nullptr) continue;
    for (std::size_t four = 0; four < kUsual; ++four) __builtin_prefetch(cell + four);
  }
}

std::size_t NearestCells::nearest(const Vec3& p_mm) const {
  CellPlace place;
  if (!find_cell(p_mm, place)) return tree_.nearest(p_mm).index;
  Block& block = made_once<Block, std::unique_ptr<Block>>(blocks_[place.block], [&] {
    const Vec3 first(static_cast<double>(place.of_blocks[0]), static_cast<double>(place.of_blocks[1]),
                     static_cast<double>(place.of_blocks[2]));
    return make_block(low_mm_ + kBlockMm * (first + Vec3::Constant(0.5)));
  });
  if (block.index.empty()) return tree_.nearest(p_mm).index;
  const Four* const cell = block.cell(place.in_block);
  if (cell == nullptr) return tree_.nearest(p_mm).index;
  const Near p = near_of(p_mm - block.middle_mm);
  const NearestInCell found = nearest_in(cell, p);
  const float within_mm2 = found.squared_mm2 + block.tolerance_mm2;
  if (found.next_squared_mm2 > within_mm2) return found.index;
  // Of those that may be it by single precision, the nearest as PointTree sums it, bit for bit.
  std::size_t best = 0;
  double best_squared = std::numeric_limits<double>::infinity();
  bool is_tie = false;
  const Four* four = cell;
  do {
    const Lanes near_mm2 = four->squared_to(p);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (near_mm2[lane] > within_mm2) continue;
      const std::size_t index = four->index[lane] & ~Four::kLast;
      const double squared_mm2 = (p_mm - tree_.points_mm()[index]).squaredNorm();
      if (squared_mm2 > best_squared) continue;
      is_tie = squared_mm2 == best_squared;
      best_squared = squared_mm2;
      best = index;
    }
  } while (!four++->is_last());
  // Of several as near, the tree has an order of its own.
  return is_tie ? tree_.nearest(p_mm).index : best;
}

}  // namespace spinaltap
