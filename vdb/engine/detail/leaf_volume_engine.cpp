// A box of points that was just looked at needs no look until the bit has moved by the gap to its nearest occupied
// point. A step goes down the tree of such boxes (see CertificateTree): nodes, leaves, cells; then to the points of
// cells that are due, after their box has been classified: outside the swept bit, inside the bit, or cut.
//
// Which points die is decided as in every engine: by SweptBit.

#include "vdb/engine/detail/leaf_volume_engine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <limits>

namespace spinaltap::detail {

LeafVolumeEngine::LeafVolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
    : VolumeEngine(volume, bit, material), bounds_(BitProfile(bit)), leaves_(volume), tree_(leaves_.levels()) {}

std::size_t LeafVolumeEngine::memory_bytes() const {
  return VolumeEngine::memory_bytes() + sizeof(*this) - sizeof(VolumeEngine) + leaves_.memory_bytes() +
         tree_.memory_bytes();
}

void LeafVolumeEngine::remove(const SweptBit& bit, Removal& removal) noexcept {
  const SweptBounds tool(std::span(&bit, 1), bounds_);
  const auto due = tree_.due(tool);
  // Measured on two cores: sharing breaks even at about 20 us of work; a look at a cell costs 0.3 us.
  constexpr std::size_t kWorthSharing = 150;
  if (due.size() >= kWorthSharing) {
    removal.add(tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, due.size(), kWorthSharing / 4), removal.empty(),
        [&](const tbb::blocked_range<std::size_t>& range, Removal sum) {
          for (std::size_t n = range.begin(); n < range.end(); ++n) look<Sharing::yes>(due[n], tool, sum);
          return sum;
        },
        [](Removal a, const Removal& b) {
          a.add(b);
          return a;
        }));
  } else {
    for (const std::uint32_t cell : due) look<Sharing::no>(cell, tool, removal);
  }
  tree_.finish([&](std::size_t from, std::size_t to) { leaves_.drop_cell(to, from); });
}

template <LeafVolumeEngine::Sharing sharing>
void LeafVolumeEngine::kill_point(PointLeaves::Cell& cell, std::size_t place, Removal& removal) noexcept {
  const auto [disc, index] = leaves_.point(place);
  if constexpr (sharing == Sharing::yes) {
    // Another thread's cell may have points in the same word.
    std::atomic_ref(volume_.occupancy_words(disc)[index / 64])
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
  const auto certify = [&](const FreeMove& free) { tree_.certify(number, free); };
  const double half_mm = tree_.half_mm();
  const BitPlace centre = tool.place(tree_.centre_mm(number));
  const FreeMove outside = tool.free_of_ball(centre, half_mm, 0.5 * half_mm);
  if (outside.free_mm > 0.0) {
    certify(outside);
    return;
  }
  if (tool.holds_ball(centre, half_mm)) {
    while (cell.occupied > 0) kill_point<sharing>(cell, cell.begin, removal);
    return tree_.set_empty(number);
  }
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double cylinder_mm = kFar;
  double cone_mm = kFar;
  removal.tested += cell.occupied;
  const SweptBounds::Reach reach = tool.reach_of_ball(centre, half_mm);
  for (std::size_t n = cell.begin; n < cell.begin + cell.occupied;) {
    const auto [disc, index] = leaves_.point(n);
    const Vec3 p = volume_.point_in_path_mm(disc, index);
    const BitPlace at = tool.place(p);
    const double from_cylinder_mm = bounds_.from_cylinder_mm(at);
    const double from_cone_mm = bounds_.from_cone_mm(at);
    if (reach.holds(from_cylinder_mm, from_cone_mm) && tool.contains_inlined(p)) {
      kill_point<sharing>(cell, n, removal);
      continue;
    }
    cylinder_mm = std::min(cylinder_mm, from_cylinder_mm);
    cone_mm = std::min(cone_mm, from_cone_mm);
    ++n;
  }
  if (cell.occupied == 0) return tree_.set_empty(number);
  // Behind the cone a bit slides along its own wall: that certificate outlives a much longer one that counts advance.
  const double margin_mm = bounds_.margin_mm();
  if (cylinder_mm > std::max(4.0 * margin_mm, 0.25 * cone_mm)) return certify({cylinder_mm - margin_mm, 0.0, 0.0});
  if (bounds_.has_cone() && cone_mm > 4.0 * margin_mm) {
    return certify({cone_mm - margin_mm, bounds_.cone_slope(), 0.0});
  }
  const PieceBounds from(bounds_, centre, half_mm);
  double body_mm = kFar;
  double round_mm = kFar;
  for (std::size_t n = cell.begin; n < cell.begin + cell.occupied; ++n) {
    const auto [disc, index] = leaves_.point(n);
    const BitPlace at = tool.place(volume_.point_in_path_mm(disc, index));
    body_mm = std::min(body_mm, bounds_.from_body_mm(at));
    round_mm = std::min(round_mm, ToolBounds::from_round_mm(bounds_.pieces()[from.nearest()], at));
  }
  // Where one piece is much nearer to the box than the others, only what of a move leads to its side counts.
  const auto [pieces, rest_mm] = from.within(body_mm + half_mm);
  FreeMove one_sided = tool.to_one_side(tree_.centre_mm(number), half_mm, pieces);
  if (one_sided.has_side() && round_mm > 0.5 * body_mm) {
    one_sided.free_mm = round_mm - margin_mm;
    one_sided.rest_mm = rest_mm - margin_mm;
    return certify(one_sided);
  }
  certify({body_mm - margin_mm, 1.0, 1.0});
}

}  // namespace spinaltap::detail
