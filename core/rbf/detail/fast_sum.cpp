#include "core/rbf/detail/fast_sum.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace spinaltap::detail {
namespace {

/// Eight targets as the kernels take them; places past the last repeat it.
struct TargetPack {
  double at[3 * kLanes];
};

template <class PointAt>
TargetPack pack(std::size_t count, const PointAt& point_at) {
  TargetPack targets;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Vec3 p = point_at(std::min(l, count - 1));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      targets.at[axis * kLanes + l] = p[static_cast<Eigen::Index>(axis)];
    }
  }
  return targets;
}

/// The coordinates along each axis where the points are all those of a lattice, x fastest, that grows along each axis.
std::optional<std::array<std::vector<double>, 3>> axes_of_lattice(std::span<const Vec3> points_mm) {
  constexpr std::size_t kMinPoints = 64;
  if (points_mm.size() < kMinPoints) return std::nullopt;
  std::array<std::vector<double>, 3> axes_mm;
  std::array<std::size_t, 3> steps{1, 0, 0};  // from a point to its neighbour along each axis
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    std::vector<double>& list = axes_mm[axis];
    for (std::size_t i = 0; i < points_mm.size(); i += steps[axis]) {
      const double at_mm = points_mm[i][a];
      if (!list.empty() && !(at_mm > list.back())) break;
      list.push_back(at_mm);
    }
    if (axis < 2) steps[axis + 1] = steps[axis] * list.size();
  }
  const auto& [x_mm, y_mm, z_mm] = axes_mm;
  if (x_mm.size() * y_mm.size() * z_mm.size() != points_mm.size()) return std::nullopt;
  std::size_t n = 0;
  for (const double z : z_mm) {
    for (const double y : y_mm) {
      for (const double x : x_mm) {
        const Vec3& p = points_mm[n++];
        if (!(p.x() == x && p.y() == y && p.z() == z)) return std::nullopt;
      }
    }
  }
  return axes_mm;
}

}  // namespace

void direct_sums(RadialKernel kernel, double low_pass_mm, std::span<const Vec3> centres_mm,
                 std::span<const double> weights, std::span<const Vec3> points_mm, std::span<double> values,
                 std::span<Vec3> gradients, const SimdKernels& simd) {
  const std::size_t count = centres_mm.size();
  std::vector<double> coordinates(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coordinates[axis * count + i] = centres_mm[i][static_cast<Eigen::Index>(axis)];
    }
  }
  const SourceArrays sources{coordinates.data(), coordinates.data() + count, coordinates.data() + 2 * count,
                             weights.data()};
  tbb::parallel_for(std::size_t{0}, (points_mm.size() + kLanes - 1) / kLanes, [&](std::size_t k) {
    const std::size_t first = k * kLanes;
    const std::size_t size = std::min(kLanes, points_mm.size() - first);
    const TargetPack targets = pack(size, [&](std::size_t l) -> const Vec3& { return points_mm[first + l]; });
    LaneSums sums{};
    simd.near_sum(power_of(kernel), !gradients.empty(), targets.at, sources, 0, count, low_pass_mm * low_pass_mm, sums);
    for (std::size_t l = 0; l < size; ++l) {
      values[first + l] = sums.value[l];
      if (!gradients.empty()) {
        gradients[first + l] = Vec3(sums.gradient[0][l], sums.gradient[1][l], sums.gradient[2][l]);
      }
    }
  });
}

FastSum::FastSum(RadialKernel kernel, double low_pass_mm, std::span<const Vec3> centres_mm,
                 const FastSumOptions& options)
    : kernel_(kernel),
      c2_(low_pass_mm * low_pass_mm),
      options_(options),
      simd_(options.simd != nullptr ? *options.simd : best_simd_kernels()),
      grid_(options.order),
      tree_(centres_mm, options.leaf_size, options.beside_size),
      far_field_(kernel, c2_, options.order, simd_),
      multipole_slot_(tree_.boxes().size(), Octree::kNone),
      local_slot_(tree_.boxes().size(), Octree::kNone) {
  const auto& boxes = tree_.boxes();
  std::vector<bool> is_target(boxes.size());
  std::uint32_t multipoles = 0;
  std::uint32_t locals = 0;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    is_target[b] = options.anywhere || boxes[b].count() > 0;
    if (boxes[b].count() > 0) multipole_slot_[b] = multipoles++;
    if (is_target[b]) local_slot_[b] = locals++;
  }
  lists_ = make_lists(tree_, is_target, grid_.node_count());
  multipole_.resize(multipoles * grid_.node_count());
  local_.resize(locals * grid_.node_count());
  x_mm_.resize(centres_mm.size());
  y_mm_.resize(centres_mm.size());
  z_mm_.resize(centres_mm.size());
  weight_.resize(centres_mm.size(), 0.0);
  for (std::size_t i = 0; i < centres_mm.size(); ++i) {
    const Vec3& c = centres_mm[tree_.sorted()[i]];
    x_mm_[i] = c.x();
    y_mm_[i] = c.y();
    z_mm_[i] = c.z();
  }
}

void FastSum::set_weights(std::span<const double> weights) {
  for (std::size_t i = 0; i < weight_.size(); ++i) weight_[i] = weights[tree_.sorted()[i]];
  std::fill(multipole_.begin(), multipole_.end(), 0.0);
  std::fill(local_.begin(), local_.end(), 0.0);
  spread_weights();
  translate();
  pass_down();
}

void FastSum::spread_weights() {
  const auto& boxes = tree_.boxes();
  const std::size_t nodes = grid_.node_count();
  const auto& level_begin = tree_.level_begin();
  for (std::size_t level = level_begin.size() - 1; level-- > 0;) {
    tbb::parallel_for(level_begin[level], level_begin[level + 1], [&](std::uint32_t b) {
      const Octree::Box& box = boxes[b];
      if (box.count() == 0) return;
      double* to = multipole_.data() + multipole_slot_[b] * nodes;
      if (!box.is_leaf()) {
        for (int octant = 0; octant < 8; ++octant) {
          const std::uint32_t child = box.first_child + static_cast<std::uint32_t>(octant);
          if (boxes[child].count() == 0) continue;
          grid_.child_to_parent(octant, multipole_.data() + multipole_slot_[child] * nodes, to);
        }
        return;
      }
      const Vec3 centre = tree_.centre_mm(box);
      const double per_mm = 1.0 / tree_.half_width_mm(box);
      for (std::uint32_t i = box.begin; i < box.end; ++i) {
        grid_.spread((Vec3(x_mm_[i], y_mm_[i], z_mm_[i]) - centre) * per_mm, weight_[i], to);
      }
    });
  }
}

void FastSum::translate() {
  const auto& level_begin = tree_.level_begin();
  for (std::size_t level = 2; level + 1 < level_begin.size(); ++level) {
    far_field_.translate(tree_, lists_, level_begin[level], level_begin[level + 1], multipole_slot_, multipole_,
                         local_slot_, local_);
  }
}

void FastSum::pass_down() {
  const auto& boxes = tree_.boxes();
  const std::size_t nodes = grid_.node_count();
  const auto& level_begin = tree_.level_begin();
  for (std::size_t level = 1; level + 1 < level_begin.size(); ++level) {
    tbb::parallel_for(level_begin[level], level_begin[level + 1], [&](std::uint32_t b) {
      if (local_slot_[b] == Octree::kNone) return;
      const Octree::Box& box = boxes[b];
      double* local = local_.data() + local_slot_[b] * nodes;
      const int octant = static_cast<int>(b - boxes[box.parent].first_child);
      if (local_slot_[box.parent] != Octree::kNone) {
        grid_.parent_to_child(octant, local_.data() + local_slot_[box.parent] * nodes, local);
      }
      if (lists_.coarser.count(b) == 0) return;
      const Vec3 centre = tree_.centre_mm(box);
      const double half_mm = tree_.half_width_mm(box);
      const auto size = static_cast<std::size_t>(grid_.order());
      for (std::size_t first = 0; first < nodes; first += kLanes) {
        const std::size_t count = std::min(kLanes, nodes - first);
        const TargetPack targets = pack(count, [&](std::size_t l) -> Vec3 {
          const std::size_t k = first + l;
          return centre + half_mm * Vec3(grid_.node(static_cast<int>(k % size)),
                                         grid_.node(static_cast<int>(k / size % size)),
                                         grid_.node(static_cast<int>(k / size / size)));
        });
        LaneSums sums{};
        for (const std::uint32_t* c = lists_.coarser.begin(b); c != lists_.coarser.end(b); ++c) {
          near_sums({boxes[*c].begin, boxes[*c].end}, targets.at, false, sums);
        }
        for (std::size_t l = 0; l < count; ++l) local[first + l] += sums.value[l];
      }
    });
  }
}

void FastSum::near_sums(SourceRange range, const double* targets, bool gradient, LaneSums& sums) const {
  simd_.near_sum(power_of(kernel_), gradient, targets, {x_mm_.data(), y_mm_.data(), z_mm_.data(), weight_.data()},
                 range.begin, range.end, c2_, sums);
}

void FastSum::expansion_sums(std::uint32_t box, const double* targets, bool gradient, LaneSums& sums) const {
  const std::size_t nodes = grid_.node_count();
  const auto size = static_cast<std::size_t>(grid_.order());
  const Vec3 centre = tree_.centre_mm(tree_.boxes()[box]);
  const double half_mm = tree_.half_width_mm(tree_.boxes()[box]);
  thread_local std::vector<double> places;
  places.resize(3 * nodes);
  for (std::size_t k = 0; k < nodes; ++k) {
    places[k] = centre.x() + half_mm * grid_.node(static_cast<int>(k % size));
    places[nodes + k] = centre.y() + half_mm * grid_.node(static_cast<int>(k / size % size));
    places[2 * nodes + k] = centre.z() + half_mm * grid_.node(static_cast<int>(k / size / size));
  }
  simd_.near_sum(power_of(kernel_), gradient, targets,
                 {places.data(), places.data() + nodes, places.data() + 2 * nodes,
                  multipole_.data() + multipole_slot_[box] * nodes},
                 0, nodes, c2_, sums);
}

void FastSum::leaf_sums(std::uint32_t leaf, const double* targets, bool gradient, LaneSums& sums) const {
  const Octree::Box& box = tree_.boxes()[leaf];
  const Vec3 centre = tree_.centre_mm(box);
  const double per_mm = 1.0 / tree_.half_width_mm(box);
  TargetPack places;
  for (std::size_t k = 0; k < 3 * kLanes; ++k) {
    places.at[k] = (targets[k] - centre[static_cast<Eigen::Index>(k / kLanes)]) * per_mm;
  }
  simd_.interpolate(grid_.order(), gradient, places.at, local_.data() + local_slot_[leaf] * grid_.node_count(),
                    grid_.inverse(), per_mm, sums);
  beside_sums(leaf, targets, gradient, sums);
}

void FastSum::beside_sums(std::uint32_t leaf, const double* targets, bool gradient, LaneSums& sums) const {
  for (const std::uint32_t* f = lists_.finer.begin(leaf); f != lists_.finer.end(leaf); ++f) {
    expansion_sums(*f, targets, gradient, sums);
  }
  for (const SourceRange* r = lists_.near.begin(leaf); r != lists_.near.end(leaf); ++r) {
    near_sums(*r, targets, gradient, sums);
  }
}

void FastSum::outside_sums(std::uint32_t b, const double* targets, const Vec3& p_mm, bool gradient,
                           LaneSums& sums) const {
  const Octree::Box& box = tree_.boxes()[b];
  if (box.count() == 0) return;
  // As far as a box of the same level that is not adjacent.
  const double half_mm = tree_.half_width_mm(box);
  const bool is_far = (p_mm - tree_.centre_mm(box)).cwiseAbs().maxCoeff() >= 3.0 * half_mm;
  if (box.is_leaf() || (is_far && box.count() < grid_.node_count())) {
    near_sums({box.begin, box.end}, targets, gradient, sums);
  } else if (is_far) {
    expansion_sums(b, targets, gradient, sums);
  } else {
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      outside_sums(box.first_child + octant, targets, p_mm, gradient, sums);
    }
  }
}

void FastSum::at_centres(std::span<double> values) const {
  const auto& boxes = tree_.boxes();
  tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t b) {
    const Octree::Box& box = boxes[b];
    if (!box.is_leaf()) return;
    for (std::uint32_t first = box.begin; first < box.end; first += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, box.end - first);
      const TargetPack targets =
          pack(count, [&](std::size_t l) { return Vec3(x_mm_[first + l], y_mm_[first + l], z_mm_[first + l]); });
      LaneSums sums{};
      leaf_sums(static_cast<std::uint32_t>(b), targets.at, false, sums);
      for (std::size_t l = 0; l < count; ++l) values[tree_.sorted()[first + l]] = sums.value[l];
    }
  });
}

void FastSum::evaluate(std::span<const Vec3> points_mm, std::span<double> values, std::span<Vec3> gradients) const {
  if (gradients.empty()) {
    if (const auto axes_mm = axes_of_lattice(points_mm)) {
      return evaluate_lattice({(*axes_mm)[0], (*axes_mm)[1], (*axes_mm)[2]}, values);
    }
  }
  evaluate_each(points_mm, values, gradients);
}

void FastSum::evaluate_each(std::span<const Vec3> points_mm, std::span<double> values,
                            std::span<Vec3> gradients) const {
  constexpr std::size_t kBlock = std::size_t{1} << 20;  // bounds the memory that sorting takes
  constexpr std::uint32_t kOutside = Octree::kNone;
  const bool gradient = !gradients.empty();
  std::vector<std::uint32_t> leaf;
  std::vector<std::uint32_t> order;
  for (std::size_t block = 0; block < points_mm.size(); block += kBlock) {
    const std::size_t count = std::min(kBlock, points_mm.size() - block);
    leaf.resize(count);
    order.resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Vec3& p = points_mm[block + i];
        leaf[i] = tree_.contains(p) ? tree_.leaf_at(p) : kOutside;
      }
    });
    // By leaf, in the order given within each.
    std::vector<std::uint32_t> start(tree_.boxes().size() + 2, 0);
    const auto key = [&](std::size_t i) { return leaf[i] == kOutside ? tree_.boxes().size() : leaf[i]; };
    for (std::size_t i = 0; i < count; ++i) ++start[key(i) + 1];
    for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
    for (std::size_t i = 0; i < count; ++i) order[start[key(i)]++] = static_cast<std::uint32_t>(i);

    // Packs of up to eight places of one leaf; outside the cube each place goes alone.
    struct Pack {
      std::uint32_t begin;
      std::uint32_t count;
    };
    std::vector<Pack> packs;
    for (std::uint32_t i = 0; i < count;) {
      std::uint32_t last = i + 1;
      while (last < count && last - i < kLanes && leaf[order[i]] != kOutside && leaf[order[last]] == leaf[order[i]]) {
        ++last;
      }
      packs.push_back({i, last - i});
      i = last;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, packs.size(), 8), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k) {
        const Pack& p = packs[k];
        const auto point = [&](std::size_t l) -> const Vec3& { return points_mm[block + order[p.begin + l]]; };
        const TargetPack targets = pack(p.count, point);
        LaneSums sums{};
        if (leaf[order[p.begin]] == kOutside) {
          outside_sums(0, targets.at, point(0), gradient, sums);
        } else {
          leaf_sums(leaf[order[p.begin]], targets.at, gradient, sums);
        }
        for (std::size_t l = 0; l < p.count; ++l) {
          const std::size_t i = block + order[p.begin + l];
          values[i] = sums.value[l];
          if (gradient) gradients[i] = Vec3(sums.gradient[0][l], sums.gradient[1][l], sums.gradient[2][l]);
        }
      }
    });
  }
}

void FastSum::evaluate_lattice(const LatticeAxes& axes_mm, std::span<double> values) const {
  // What lies outside the cube is no box's.
  LatticePart whole{0, {}, {}};
  const Vec3 centre = tree_.centre_mm(tree_.boxes()[0]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto is_in = [&](double at_mm) {
      Vec3 p = centre;
      p[static_cast<Eigen::Index>(axis)] = at_mm;
      return tree_.contains(p);
    };
    const std::span<const double> list = axes_mm[axis];
    const auto first = std::find_if(list.begin(), list.end(), is_in);
    const auto last = std::find_if_not(first, list.end(), is_in);
    whole.begin[axis] = static_cast<std::size_t>(first - list.begin());
    whole.end[axis] = static_cast<std::size_t>(last - list.begin());
  }
  std::vector<LatticePart> parts;
  divide_lattice(axes_mm, whole, parts);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) { lattice_sums(axes_mm, parts[n], values); });

  std::vector<Vec3> outside_mm;
  std::vector<std::size_t> at;
  std::size_t n = 0;
  for (std::size_t k = 0; k < axes_mm[2].size(); ++k) {
    for (std::size_t j = 0; j < axes_mm[1].size(); ++j) {
      const bool row_is_in = k >= whole.begin[2] && k < whole.end[2] && j >= whole.begin[1] && j < whole.end[1];
      for (std::size_t i = 0; i < axes_mm[0].size(); ++i, ++n) {
        if (row_is_in && i >= whole.begin[0] && i < whole.end[0]) continue;
        outside_mm.emplace_back(axes_mm[0][i], axes_mm[1][j], axes_mm[2][k]);
        at.push_back(n);
      }
    }
  }
  std::vector<double> outside(at.size());
  evaluate_each(outside_mm, outside, {});
  for (std::size_t o = 0; o < at.size(); ++o) values[at[o]] = outside[o];
}

void FastSum::divide_lattice(const LatticeAxes& axes_mm, const LatticePart& part,
                             std::vector<LatticePart>& parts) const {
  constexpr std::size_t kMaxPlaces = 4096;  // so that threads share large boxes
  std::array<std::size_t, 3> counts{};
  for (std::size_t axis = 0; axis < 3; ++axis) counts[axis] = part.end[axis] - part.begin[axis];
  if (counts[0] == 0 || counts[1] == 0 || counts[2] == 0) return;
  const Octree::Box& box = tree_.boxes()[part.leaf];
  if (box.is_leaf()) {
    if (counts[0] * counts[1] * counts[2] <= kMaxPlaces) {
      parts.push_back(part);
      return;
    }
    const auto axis = static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
    LatticePart lower = part;
    LatticePart upper = part;
    lower.end[axis] = upper.begin[axis] = part.begin[axis] + counts[axis] / 2;
    divide_lattice(axes_mm, lower, parts);
    divide_lattice(axes_mm, upper, parts);
    return;
  }
  // As Octree::leaf_at() goes: the middle is the upper half's.
  const Vec3 centre = tree_.centre_mm(box);
  std::array<std::size_t, 3> middle{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto begin = axes_mm[axis].begin();
    middle[axis] = static_cast<std::size_t>(std::lower_bound(begin + static_cast<std::ptrdiff_t>(part.begin[axis]),
                                                             begin + static_cast<std::ptrdiff_t>(part.end[axis]),
                                                             centre[static_cast<Eigen::Index>(axis)]) -
                                            begin);
  }
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    LatticePart child{box.first_child + octant, part.begin, part.end};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      (((octant >> axis) & 1U) != 0 ? child.begin : child.end)[axis] = middle[axis];
    }
    divide_lattice(axes_mm, child, parts);
  }
}

void FastSum::lattice_sums(const LatticeAxes& axes_mm, const LatticePart& part, std::span<double> values) const {
  const Octree::Box& box = tree_.boxes()[part.leaf];
  const Vec3 centre = tree_.centre_mm(box);
  const double per_mm = 1.0 / tree_.half_width_mm(box);
  struct Scratch {
    std::array<std::vector<double>, 3> places;
    std::vector<double> work;
    std::vector<double> sums;
  };
  thread_local Scratch scratch;
  std::array<std::size_t, 3> counts{};
  std::array<std::size_t, 3> filled{};
  std::array<const double*, 3> places{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    counts[axis] = part.end[axis] - part.begin[axis];
    filled[axis] = (counts[axis] + kLanes - 1) / kLanes * kLanes;
    scratch.places[axis].resize(filled[axis]);
    for (std::size_t i = 0; i < filled[axis]; ++i) {
      const double at_mm = axes_mm[axis][part.begin[axis] + std::min(i, counts[axis] - 1)];
      scratch.places[axis][i] = (at_mm - centre[static_cast<Eigen::Index>(axis)]) * per_mm;
    }
    places[axis] = scratch.places[axis].data();
  }
  scratch.work.resize((filled[1] + filled[2]) * static_cast<std::size_t>(grid_.order()));
  scratch.sums.resize(filled[0] * counts[1] * counts[2]);
  simd_.interpolate_lattice(grid_.order(), counts.data(), places.data(),
                            local_.data() + local_slot_[part.leaf] * grid_.node_count(), grid_.inverse(),
                            scratch.work.data(), scratch.sums.data());
  const auto index_of = [&](std::size_t n) {
    return std::array<std::size_t, 3>{n % counts[0], n / counts[0] % counts[1], n / counts[0] / counts[1]};
  };
  const bool is_alone = lists_.finer.count(part.leaf) == 0 && lists_.near.count(part.leaf) == 0;
  const std::size_t count = counts[0] * counts[1] * counts[2];
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t size = std::min(kLanes, count - first);
    LaneSums sums{};
    for (std::size_t l = 0; l < size; ++l) {
      const auto [i, j, k] = index_of(first + l);
      sums.value[l] += scratch.sums[(k * counts[1] + j) * filled[0] + i];
    }
    if (!is_alone) {
      const TargetPack targets = pack(size, [&](std::size_t l) {
        const auto [i, j, k] = index_of(first + l);
        return Vec3(axes_mm[0][part.begin[0] + i], axes_mm[1][part.begin[1] + j], axes_mm[2][part.begin[2] + k]);
      });
      beside_sums(part.leaf, targets.at, false, sums);
    }
    for (std::size_t l = 0; l < size; ++l) {
      const auto [i, j, k] = index_of(first + l);
      values[((part.begin[2] + k) * axes_mm[1].size() + part.begin[1] + j) * axes_mm[0].size() + part.begin[0] + i] =
          sums.value[l];
    }
  }
}

}  // namespace spinaltap::detail
