// One idea on two levels: a box of points that was just looked at needs no look until the bit has moved by the gap to
// its nearest living point (see MoveCertificates). Leaves of the tree are checked first, in one vector loop; then the
// cells of those leaves whose certificate has run out; then the points of cells that still are due, after their box has
// been classified: outside the swept bit, inside the bit, or cut.
//
// Which points die is decided as in every engine: by SweptBit.

#include "vdb/engine/detail/leaf_volume_engine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

double half_diagonal_mm(double edge_mm) { return 0.5 * std::sqrt(3.0) * edge_mm; }

}  // namespace

LeafVolumeEngine::LeafVolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
    : VolumeEngine(volume, bit, material),
      bounds_(BitProfile(bit)),
      leaves_(volume),
      cell_certificates_(leaves_.first_cell_centres_mm(), half_diagonal_mm(leaves_.cell_mm())),
      leaf_certificates_(leaves_.first_leaf_centres_mm(), half_diagonal_mm(leaves_.leaf_mm())),
      cell_left_mm_(cell_certificates_.size()),
      leaf_left_mm_(leaf_certificates_.size()),
      are_cells_stale_(leaf_certificates_.size(), 0),
      due_leaves_(leaf_certificates_.size()),
      due_cells_(cell_certificates_.size()) {
  leaves_.forget_centres();
}

std::size_t LeafVolumeEngine::memory_bytes() const {
  return VolumeEngine::memory_bytes() + sizeof(*this) - sizeof(VolumeEngine) + leaves_.memory_bytes() +
         cell_certificates_.memory_bytes() + leaf_certificates_.memory_bytes() +
         (cell_left_mm_.size() + leaf_left_mm_.size()) * sizeof(float) + are_cells_stale_.size() +
         (due_leaves_.size() + due_cells_.size()) * sizeof(std::uint32_t);
}

void LeafVolumeEngine::remove(const SweptBit& bit, Removal& removal) noexcept {
  const SweptBounds tool(bit, bounds_);
  const std::size_t leaf_count = leaves_.leaves().size();
  leaf_certificates_.move_to(tool.line());
  cell_certificates_.move_to(tool.line());
  leaf_certificates_.check(0, leaf_count, leaf_left_mm_.data());
  due_leaf_count_ = 0;
  due_cell_count_ = 0;
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    if (!(leaf_left_mm_[leaf] > 0.0F)) list_cells(leaf, tool);
  }
  // Measured on two cores: sharing breaks even at about 20 us of work; a look at a cell costs 0.3 us.
  constexpr std::size_t kWorthSharing = 150;
  if (due_cell_count_ >= kWorthSharing) {
    removal.add(tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, due_cell_count_, kWorthSharing / 4), Removal(),
        [&](const tbb::blocked_range<std::size_t>& range, Removal sum) {
          for (std::size_t n = range.begin(); n < range.end(); ++n) look<Sharing::yes>(due_cells_[n], tool, sum);
          return sum;
        },
        [](Removal a, const Removal& b) {
          a.add(b);
          return a;
        }));
  } else {
    for (std::size_t n = 0; n < due_cell_count_; ++n) look<Sharing::no>(due_cells_[n], tool, removal);
  }
  // From the last, so that the leaf which moves into a dropped one's place has been finished.
  for (std::size_t n = due_leaf_count_; n-- > 0;) finish_leaf(due_leaves_[n]);
}

void LeafVolumeEngine::list_cells(std::size_t number, const SweptBounds& tool) noexcept {
  const double half_mm = leaf_certificates_.half_mm();
  const FreeMove free = tool.free_of_ball(tool.place(leaf_certificates_.centre_mm(number)), half_mm, 0.25 * half_mm);
  if (free.free_mm > 0.0) {
    leaf_certificates_.renew(number, free);
    are_cells_stale_[number] = 1;
    return;
  }
  const PointLeaves::Leaf& leaf = leaves_.leaves()[number];
  due_leaves_[due_leaf_count_++] = static_cast<std::uint32_t>(number);
  if (are_cells_stale_[number] != 0) {
    // The bit may have been anywhere since these were checked.
    std::fill_n(cell_left_mm_.begin() + leaf.begin, leaf.count, -1.0F);
    are_cells_stale_[number] = 0;
  } else {
    cell_certificates_.check(leaf.begin, leaf.begin + leaf.count, cell_left_mm_.data() + leaf.begin);
  }
  for (std::uint32_t cell = leaf.begin; cell < leaf.begin + leaf.count; ++cell) {
    if (!(cell_left_mm_[cell] > 0.0F)) due_cells_[due_cell_count_++] = cell;
  }
}

template <LeafVolumeEngine::Sharing sharing>
void LeafVolumeEngine::kill_point(PointLeaves::Cell& cell, std::size_t place, Removal& removal) noexcept {
  const auto [disc, index] = leaves_.point(place);
  if constexpr (sharing == Sharing::yes) {
    // Another thread's cell may have points in the same word.
    std::atomic_ref(volume_.alive_words(disc)[index / 64])
        .fetch_and(~(std::uint64_t{1} << (index % 64)), std::memory_order_relaxed);
    account(disc, index, removal);
  } else {
    kill(disc, index, removal);
  }
  leaves_.drop_point(cell, place);
}

template <LeafVolumeEngine::Sharing sharing>
void LeafVolumeEngine::look(std::size_t number, const SweptBounds& tool, Removal& removal) noexcept {
  PointLeaves::Cell& cell = leaves_.cell(number);
  const auto certify = [&](const FreeMove& free) {
    cell_certificates_.renew(number, free);
    cell_left_mm_[number] = static_cast<float>(free.free_mm);
  };
  const double half_mm = cell_certificates_.half_mm();
  const BitPlace centre = tool.place(cell_certificates_.centre_mm(number));
  const FreeMove outside = tool.free_of_ball(centre, half_mm, 0.5 * half_mm);
  if (outside.free_mm > 0.0) {
    certify(outside);
    return;
  }
  if (tool.holds_ball(centre, half_mm)) {
    while (cell.living > 0) kill_point<sharing>(cell, cell.begin, removal);
    return;
  }
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double cylinder_mm = kFar;
  double cone_mm = kFar;
  removal.tested += cell.living;
  const SweptBounds::Reach reach = tool.reach_of_ball(centre, half_mm);
  for (std::size_t n = cell.begin; n < cell.begin + cell.living;) {
    const auto [disc, index] = leaves_.point(n);
    const Vec3 p = volume_.point_in_path_mm(disc, index);
    const BitPlace at = tool.place(p);
    const double from_cylinder_mm = bounds_.from_cylinder_mm(at);
    const double from_cone_mm = bounds_.from_cone_mm(at);
    if (reach.holds(from_cylinder_mm, from_cone_mm) && tool.bit().contains_inlined(p)) {
      kill_point<sharing>(cell, n, removal);
      continue;
    }
    cylinder_mm = std::min(cylinder_mm, from_cylinder_mm);
    cone_mm = std::min(cone_mm, from_cone_mm);
    ++n;
  }
  if (cell.living == 0) return;
  // Behind the cone a bit slides along its own wall: that certificate outlives a much longer one that counts advance.
  const double margin_mm = bounds_.margin_mm();
  if (cylinder_mm > std::max(4.0 * margin_mm, 0.25 * cone_mm)) return certify({cylinder_mm - margin_mm, 0.0, 0.0});
  if (bounds_.has_cone() && cone_mm > 4.0 * margin_mm) {
    return certify({cone_mm - margin_mm, bounds_.cone_slope(), 0.0});
  }
  double body_mm = kFar;
  for (std::size_t n = cell.begin; n < cell.begin + cell.living; ++n) {
    const auto [disc, index] = leaves_.point(n);
    body_mm = std::min(body_mm, bounds_.from_body_mm(tool.place(volume_.point_in_path_mm(disc, index))));
  }
  certify({body_mm - margin_mm, 1.0, 1.0});
}

void LeafVolumeEngine::finish_leaf(std::size_t number) noexcept {
  const PointLeaves::Leaf& leaf = leaves_.leaves()[number];
  for (std::size_t cell = leaf.begin; cell < leaf.begin + leaf.count;) {
    if (leaves_.cell(cell).living == 0) {
      const std::size_t moved = leaves_.drop_cell(number, cell);
      cell_certificates_.copy(moved, cell);
      cell_left_mm_[cell] = cell_left_mm_[moved];
      continue;
    }
    ++cell;
  }
  if (leaf.count == 0) {
    const std::size_t moved = leaves_.drop_leaf(number);
    leaf_certificates_.copy(moved, number);
    are_cells_stale_[number] = are_cells_stale_[moved];
    return;
  }
  FreeMove free = cell_certificates_.together(leaf.begin, leaf.begin + leaf.count, cell_left_mm_.data());
  // Rounded down.
  free.free_mm -= 1e-6 * std::abs(free.free_mm);
  leaf_certificates_.renew(number, free);
}

}  // namespace spinaltap::detail
