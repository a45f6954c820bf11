#include "vdb/remaining/detail/block_cells.h"

#include "vdb/remaining/detail/cell_patches.h"
#include "vdb/remaining/detail/cut_edges.h"

namespace spinaltap::detail {
namespace {

/// Whether the cell's looped face meets one of the next cell, and so both are joined there.
bool is_joined(const SignRows& signs, const std::array<int, 3>& cell, std::uint8_t code) {
  const std::uint8_t face = looped_face(code);
  if (face == kNoFace) return false;
  std::array<int, 3> next = cell;
  next[face / 2] += face % 2 == 1 ? 1 : -1;
  return looped_face(signs.code(next[0], next[1], next[2])) == (face ^ 1U);
}

/// Where each of the 12 edges of a cell lies: its first voxel from the cell's, and its axis.
struct CellEdge {
  std::array<int, 3> from;
  unsigned axis;
};

constexpr std::array<CellEdge, 12> kCellEdges{{{{0, 0, 0}, 0},
                                               {{0, 1, 0}, 0},
                                               {{0, 0, 1}, 0},
                                               {{0, 1, 1}, 0},
                                               {{0, 0, 0}, 1},
                                               {{1, 0, 0}, 1},
                                               {{0, 0, 1}, 1},
                                               {{1, 0, 1}, 1},
                                               {{0, 0, 0}, 2},
                                               {{1, 0, 0}, 2},
                                               {{0, 1, 0}, 2},
                                               {{1, 1, 0}, 2}}};

constexpr std::size_t kCorners = kBlockSide + 1;

std::size_t edge_slot(int x, int y, int z, unsigned axis) {
  return ((static_cast<std::size_t>(x) * kCorners + static_cast<std::size_t>(y)) * kCorners +
          static_cast<std::size_t>(z)) *
             3 +
         axis;
}

/// The cut edges of one piece of surface.
struct Piece {
  std::array<SurfacePlane, 12> planes;
  std::size_t count = 0;
  std::array<Vec3, 2> normals{Vec3::Zero(), Vec3::Zero()};
};

Eigen::Vector3f unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Eigen::Vector3f((v / length).cast<float>()) : Eigen::Vector3f(Eigen::Vector3f::Zero());
}

}  // namespace

const BlockCells::Cell* BlockCells::find(std::uint16_t place) const {
  const std::size_t row = place / BlockLattice::kSide;
  for (std::size_t n = row_begins[row]; n < row_begins[row + 1]; ++n) {
    if (cells[n].place == place) return &cells[n];
  }
  return nullptr;
}

bool may_have_surface(const HoleGrid& grid, std::size_t block) {
  const auto strides = grid.bone().lattice.strides();
  const InsideBits& own = grid.inside(block);
  const std::uint64_t first = own[0];
  if (first != 0 && ~first != 0) return true;
  for (unsigned next = 0; next < 8; ++next) {
    std::size_t at = block;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((next >> axis & 1U) != 0) at += static_cast<std::size_t>(strides[axis]);
    }
    for (const std::uint64_t layer : grid.inside(at)) {
      if (layer != first) return true;
    }
  }
  return false;
}

BlockCells find_cells(const BoneModel& bone, const HoleGrid& grid, std::size_t block) {
  BlockCells result;
  if (!may_have_surface(grid, block)) return result;
  const SignRows signs(grid, block);
  const std::vector<EdgeCut> cuts = find_cut_edges(bone, grid, block, signs);
  if (cuts.empty()) return result;

  std::array<std::uint16_t, kCorners * kCorners * kCorners * 3> cut_of_edge;  // set where edges are cut
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const auto& [x, y, z] = cuts[n].voxel;
    cut_of_edge[edge_slot(x, y, z, cuts[n].axis)] = static_cast<std::uint16_t>(n);
    if (x == kBlockSide || y == kBlockSide || z == kBlockSide) continue;
    result.edges.push_back({static_cast<std::uint16_t>(BlockLattice::offset(x, y, z)), cuts[n].axis, cuts[n].rises,
                            cuts[n].is_wall, cuts[n].normal.cast<float>()});
  }
  const Vec3 corner_mm = grid.bone().lattice.corner_mm(grid.bone().lattice.block(block));
  const double voxel_mm = grid.bone().lattice.voxel_mm;
  for (int x = 0; x < kBlockSide; ++x) {
    for (int y = 0; y < kBlockSide; ++y) {
      result.row_begins[BlockLattice::offset(0, x, y)] = static_cast<std::uint16_t>(result.cells.size());
      // Rows of one kind throughout have no cut cell.
      const unsigned all = signs.row(x, y) & signs.row(x + 1, y) & signs.row(x, y + 1) & signs.row(x + 1, y + 1);
      const unsigned any = signs.row(x, y) | signs.row(x + 1, y) | signs.row(x, y + 1) | signs.row(x + 1, y + 1);
      constexpr unsigned kOwn = 0x1FFU << 1U;
      if ((any & kOwn) == 0 || (all & kOwn) == kOwn) continue;
      for (int z = 0; z < kBlockSide; ++z) {
        const std::uint8_t code = signs.code(x, y, z);
        if (code == 0 || code == 0xFF) continue;
        const bool joined = is_joined(signs, {x, y, z}, code);
        result.cells.push_back({static_cast<std::uint16_t>(BlockLattice::offset(x, y, z)),
                                static_cast<std::uint16_t>(result.vertices.size()), code, joined});
        const CellPatches& patches = cell_patches(code, joined);
        std::array<Piece, 4> pieces;
        for (unsigned edge = 0; edge < 12; ++edge) {
          if (patches.of_edge[edge] == kNoPatch) continue;
          const auto& [from, axis] = kCellEdges[edge];
          const EdgeCut& cut = cuts[cut_of_edge[edge_slot(x + from[0], y + from[1], z + from[2], axis)]];
          Piece& piece = pieces[patches.of_edge[edge]];
          SurfacePlane& plane = piece.planes[piece.count++];
          plane = cut.plane();
          plane.point -= Vec3(x, y, z);
          piece.normals[cut.is_wall ? 1 : 0] += cut.normal;
        }
        for (unsigned n = 0; n < patches.count; ++n) {
          const Vec3 local = feature_vertex(std::span(pieces[n].planes).first(pieces[n].count));
          const Vec3 p_mm = corner_mm + voxel_mm * (Vec3(x, y, z) + local);
          result.vertices.push_back(
              {p_mm.cast<float>(), {unit_or_zero(pieces[n].normals[0]), unit_or_zero(pieces[n].normals[1])}});
        }
      }
    }
  }
  result.row_begins.back() = static_cast<std::uint16_t>(result.cells.size());
  return result;
}

}  // namespace spinaltap::detail
