#include "vdb/remaining/remaining_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "vdb/remaining/detail/block_cells.h"
#include "vdb/remaining/detail/block_faces.h"

namespace spinaltap {
namespace {

using detail::BlockBox;
using detail::BlockCells;
using detail::BlockLattice;

constexpr unsigned kDirections = 27;
constexpr unsigned kMiddle = 13;

/// Steps to a neighbour, each -1, 0 or 1.
std::array<int, 3> direction(unsigned n) {
  return {static_cast<int>(n / 9) - 1, static_cast<int>(n / 3 % 3) - 1, static_cast<int>(n % 3) - 1};
}

std::size_t neighbour(const BlockLattice& lattice, std::size_t block, const std::array<int, 3>& steps) {
  const auto strides = lattice.strides();
  std::ptrdiff_t index = static_cast<std::ptrdiff_t>(block);
  for (std::size_t axis = 0; axis < 3; ++axis) index += steps[axis] * strides[axis];
  return static_cast<std::size_t>(index);
}

/// Whether cells of the neighbour depend on voxels in the box: on those up to `before` voxels before its cells' first
/// and up to `behind` behind their last.
bool reaches(const BlockBox& box, const std::array<int, 3>& steps, int before, int behind) {
  if (box.empty()) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (steps[axis] < 0 && box.low[axis] >= behind) return false;
    if (steps[axis] > 0 && box.high[axis] < BlockLattice::kSide - before) return false;
  }
  return true;
}

/// For each of the eight corners of a block of cells, whether a cell there is other than it was: bit n of the result is
/// set where a cell that lies at the high end of all axes in n differs.
unsigned differing_ends(const BlockCells& before, const BlockCells& after) {
  unsigned ends = 0;
  const auto vertices_of = [](const BlockCells& cells, std::size_t n) {
    const std::size_t begin = cells.cells[n].first_vertex;
    const std::size_t end = n + 1 < cells.cells.size() ? cells.cells[n + 1].first_vertex : cells.vertices.size();
    return std::span(cells.vertices).subspan(begin, end - begin);
  };
  const auto differ = [&](std::uint16_t place) {
    unsigned high = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((place >> (6 - 3 * axis) & 7U) == 7U) high |= 1U << axis;
    }
    for (unsigned n = 0; n < 8; ++n) {
      if ((n & high) == n) ends |= 1U << n;
    }
  };
  std::size_t a = 0;
  std::size_t b = 0;
  while (a < before.cells.size() || b < after.cells.size()) {
    if (b == after.cells.size() || (a < before.cells.size() && before.cells[a].place < after.cells[b].place)) {
      differ(before.cells[a++].place);
    } else if (a == before.cells.size() || after.cells[b].place < before.cells[a].place) {
      differ(after.cells[b++].place);
    } else {
      const bool same = before.cells[a].code == after.cells[b].code &&
                        before.cells[a].joined == after.cells[b].joined &&
                        std::ranges::equal(vertices_of(before, a), vertices_of(after, b));
      if (!same) differ(after.cells[b].place);
      ++a;
      ++b;
    }
  }
  return ends;
}

}  // namespace

struct RemainingSurface::State {
  RemainingBone* bone;
  std::vector<std::unique_ptr<const BlockCells>> cells;
  std::vector<std::shared_ptr<const SurfaceBlock>> surfaces;

  explicit State(RemainingBone& of) : bone(&of), cells(lattice().count()), surfaces(lattice().count()) {}

  const BlockLattice& lattice() const { return bone->grid().bone().lattice; }

  bool has_neighbours(std::size_t block) const {
    const BlockLattice::Index3 at = lattice().block(block);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int step = at[axis] - lattice().low[axis];
      if (step < 1 || step > lattice().size[axis] - 2) return false;
    }
    return true;
  }

  /// Finds a block's cells again; bits as differing_ends() has them, and bit 8 where the block's own faces may differ.
  unsigned find_again(std::size_t block) {
    static const BlockCells kNone;
    BlockCells found = detail::find_cells(bone->bone(), bone->grid(), block);
    const BlockCells& before = cells[block] == nullptr ? kNone : *cells[block];
    if (found == before) return 0;
    const unsigned ends = differing_ends(before, found) | 1U << 8U;
    found.cells.shrink_to_fit();
    found.vertices.shrink_to_fit();
    found.edges.shrink_to_fit();
    cells[block] =
        found.cells.empty() && found.edges.empty() ? nullptr : std::make_unique<BlockCells>(std::move(found));
    return ends;
  }

  /// Whether the block's faces came out other than before.
  bool make_again(std::size_t block) {
    detail::CellsAround around{};
    for (unsigned n = 0; n < 8; ++n) {
      const auto step = [&](unsigned axis) { return (n >> axis & 1U) != 0 ? 0 : -1; };
      around[n] = cells[neighbour(lattice(), block, {step(0), step(1), step(2)})].get();
    }
    std::shared_ptr<const SurfaceBlock> made = detail::make_faces(lattice(), block, around);
    const std::shared_ptr<const SurfaceBlock>& before = surfaces[block];
    const bool is_same = made == nullptr ? before == nullptr : (before != nullptr && *made == *before);
    if (is_same) return false;
    surfaces[block] = std::move(made);
    return true;
  }

  std::vector<SurfaceUpdate> mesh(std::vector<std::size_t> stale) {
    std::sort(stale.begin(), stale.end());
    stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
    std::erase_if(stale, [&](std::size_t block) { return !has_neighbours(block); });
    std::vector<unsigned> ends(stale.size());
    tbb::parallel_for(std::size_t{0}, stale.size(), [&](std::size_t n) { ends[n] = find_again(stale[n]); });
    std::vector<std::size_t> faces;
    for (std::size_t n = 0; n < stale.size(); ++n) {
      if (ends[n] != 0) faces.push_back(stale[n]);
      for (unsigned next = 1; next < 8; ++next) {
        if ((ends[n] >> next & 1U) == 0) continue;
        const auto step = [&](unsigned axis) { return static_cast<int>(next >> axis & 1U); };
        const std::size_t beside = neighbour(lattice(), stale[n], {step(0), step(1), step(2)});
        if (has_neighbours(beside)) faces.push_back(beside);
      }
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    std::vector<std::uint8_t> is_new(faces.size());
    tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t n) { is_new[n] = make_again(faces[n]) ? 1 : 0; });
    std::vector<SurfaceUpdate> updates;
    for (std::size_t n = 0; n < faces.size(); ++n) {
      if (is_new[n] != 0) updates.push_back({lattice().block(faces[n]), surfaces[faces[n]]});
    }
    return updates;
  }
};

RemainingSurface::RemainingSurface(RemainingBone& bone) : state_(std::make_unique<State>(bone)) { rebuild(); }

RemainingSurface::~RemainingSurface() = default;
RemainingSurface::RemainingSurface(RemainingSurface&&) noexcept = default;
RemainingSurface& RemainingSurface::operator=(RemainingSurface&&) noexcept = default;

std::vector<SurfaceUpdate> RemainingSurface::update() {
  std::vector<std::size_t> stale;
  for (const auto& [block, change] : state_->bone->grid().take_changes()) {
    for (unsigned n = 0; n < kDirections; ++n) {
      const std::array<int, 3> steps = direction(n);
      // A cell needs its own corners' values, and the signs of the next cells' corners.
      const bool is_stale = n == kMiddle || reaches(change.values, steps, 0, 1) || reaches(change.signs, steps, 1, 2);
      if (is_stale) stale.push_back(neighbour(state_->lattice(), block, steps));
    }
  }
  return state_->mesh(std::move(stale));
}

void RemainingSurface::rebuild() {
  state_->bone->grid().take_changes();
  state_->cells = std::vector<std::unique_ptr<const BlockCells>>(state_->lattice().count());
  state_->surfaces.assign(state_->lattice().count(), nullptr);
  std::vector<std::size_t> all(state_->lattice().count());
  for (std::size_t block = 0; block < all.size(); ++block) all[block] = block;
  state_->mesh(std::move(all));
}

std::vector<std::shared_ptr<const SurfaceBlock>> RemainingSurface::blocks() const {
  std::vector<std::shared_ptr<const SurfaceBlock>> blocks;
  for (const auto& surface : state_->surfaces) {
    if (surface != nullptr) blocks.push_back(surface);
  }
  return blocks;
}

std::size_t RemainingSurface::memory_bytes() const {
  std::size_t bytes =
      state_->cells.capacity() * sizeof(state_->cells[0]) + state_->surfaces.capacity() * sizeof(state_->surfaces[0]);
  for (const auto& cells : state_->cells) {
    if (cells == nullptr) continue;
    bytes += sizeof(BlockCells) + cells->cells.capacity() * sizeof(BlockCells::Cell) +
             cells->vertices.capacity() * sizeof(BlockCells::Vertex) +
             cells->edges.capacity() * sizeof(BlockCells::Edge);
  }
  for (const auto& surface : state_->surfaces) bytes += surface == nullptr ? 0 : surface->memory_bytes();
  return bytes;
}

}  // namespace spinaltap
