#include "vdb/remaining/detail/block_faces.h"

#include <algorithm>
#include <array>

#include "vdb/remaining/detail/cell_patches.h"

namespace spinaltap::detail {
namespace {

/// A vertex of a cell in one of the eight blocks.
struct Corner {
  unsigned around = 0;
  std::uint16_t vertex = 0;
  std::uint16_t place = 0;
  std::uint8_t patch = 0;
};

/// How well two triangles fit a surface with that normal: the cosine of the worse.
float fit(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, const Eigen::Vector3f& d,
          const Eigen::Vector3f& normal) {
  const auto cosine = [&](const Eigen::Vector3f& p, const Eigen::Vector3f& q, const Eigen::Vector3f& r) {
    const Eigen::Vector3f across = (q - p).cross(r - p);
    const float length = across.norm();
    return length > 0.0F ? across.dot(normal) / length : -1.0F;
  };
  return std::min(cosine(a, b, c), cosine(a, c, d));
}

class FaceMaker {
 public:
  FaceMaker(const BlockLattice& lattice, std::size_t block, const CellsAround& cells)
      : lattice_(lattice), block_(block), cells_(cells) {
    std::size_t count = 0;
    for (unsigned n = 0; n < 8; ++n) {
      first_[n] = count;
      count += cells[n] == nullptr ? 0 : cells[n]->vertices.size();
    }
    index_.assign(2 * count, kNone);
  }

  void add(const BlockCells::Edge& edge) {
    const std::array<Corner, 4> corners = corners_around(edge);
    std::array<std::uint16_t, 4> index{};
    for (std::size_t n = 0; n < 4; ++n) index[n] = index_of(corners[n], edge.is_wall);
    if (!edge.rises) std::swap(index[1], index[3]);
    const auto p = [&](std::size_t n) -> const Eigen::Vector3f& { return made_->vertices_mm[index[n]]; };
    // Along a rim one diagonal folds the face; elsewhere the shorter one is better.
    constexpr float kClearlyBetter = 0.02F;
    const float first = fit(p(0), p(1), p(2), p(3), edge.normal);
    const float second = fit(p(1), p(2), p(3), p(0), edge.normal);
    bool is_first = (p(0) - p(2)).squaredNorm() <= (p(1) - p(3)).squaredNorm();
    if (std::abs(first - second) > kClearlyBetter) is_first = first > second;
    if (is_first) {
      made_->triangles.push_back({index[0], index[1], index[2]});
      made_->triangles.push_back({index[0], index[2], index[3]});
    } else {
      made_->triangles.push_back({index[1], index[2], index[3]});
      made_->triangles.push_back({index[1], index[3], index[0]});
    }
  }

  std::shared_ptr<SurfaceBlock> made() const { return made_; }

 private:
  static constexpr std::uint16_t kNone = 0xFFFF;

  /// Counter-clockwise, seen from the edge's far end.
  std::array<Corner, 4> corners_around(const BlockCells::Edge& edge) const {
    const std::array<int, 3> voxel{edge.place / (kBlockSide * kBlockSide), edge.place / kBlockSide % kBlockSide,
                                   edge.place % kBlockSide};
    const std::size_t u = (edge.axis + 1U) % 3;
    const std::size_t v = (edge.axis + 2U) % 3;
    constexpr std::array<std::array<int, 2>, 4> kBefore{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
    std::array<Corner, 4> corners;
    for (std::size_t n = 0; n < 4; ++n) {
      std::array<int, 3> cell = voxel;
      std::array<unsigned, 3> from{};  // the edge's first voxel, from the cell's
      cell[u] -= kBefore[n][0];
      cell[v] -= kBefore[n][1];
      from[u] = static_cast<unsigned>(kBefore[n][0]);
      from[v] = static_cast<unsigned>(kBefore[n][1]);
      Corner& corner = corners[n];
      for (std::size_t axis = 0; axis < 3; ++axis) corner.around |= cell[axis] >= 0 ? 1U << axis : 0U;
      corner.place = static_cast<std::uint16_t>(BlockLattice::offset(cell[0] & 7, cell[1] & 7, cell[2] & 7));
      const BlockCells::Cell& found = *cells_[corner.around]->find(corner.place);
      const unsigned number = edge.axis == 0   ? from[1] + 2 * from[2]
                              : edge.axis == 1 ? 4 + from[0] + 2 * from[2]
                                               : 8 + from[0] + 2 * from[1];
      corner.patch = cell_patches(found.code, found.joined).of_edge[number];
      corner.vertex = static_cast<std::uint16_t>(found.first_vertex + corner.patch);
    }
    return corners;
  }

  std::uint16_t index_of(const Corner& corner, bool is_wall) {
    std::uint16_t& index = index_[2 * (first_[corner.around] + corner.vertex) + (is_wall ? 1 : 0)];
    if (index != kNone) return index;
    index = static_cast<std::uint16_t>(made_->vertices_mm.size());
    const BlockCells::Vertex& vertex = cells_[corner.around]->vertices[corner.vertex];
    made_->vertices_mm.push_back(vertex.position_mm);
    made_->normals.push_back(vertex.normals[is_wall ? 1 : 0]);
    std::size_t owner = block_;
    const auto strides = lattice_.strides();
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((corner.around >> axis & 1U) == 0) owner -= static_cast<std::size_t>(strides[axis]);
    }
    made_->keys.push_back((std::uint64_t{owner} * BlockLattice::kVoxels + corner.place) * 4 + corner.patch);
    return index;
  }

  const BlockLattice& lattice_;
  std::size_t block_;
  const CellsAround& cells_;
  std::array<std::size_t, 8> first_{};
  std::vector<std::uint16_t> index_;
  std::shared_ptr<SurfaceBlock> made_ = std::make_shared<SurfaceBlock>();
};

}  // namespace

std::shared_ptr<const SurfaceBlock> make_faces(const BlockLattice& lattice, std::size_t block,
                                               const CellsAround& cells) {
  const BlockCells* own = cells[7];
  if (own == nullptr || own->edges.empty()) return nullptr;
  FaceMaker maker(lattice, block, cells);
  for (const BlockCells::Edge& edge : own->edges) {
    if (!edge.is_wall) maker.add(edge);
  }
  const std::shared_ptr<SurfaceBlock> made = maker.made();
  made->block = lattice.block(block);
  made->wall_begin = made->triangles.size();
  for (const BlockCells::Edge& edge : own->edges) {
    if (edge.is_wall) maker.add(edge);
  }
  made->vertices_mm.shrink_to_fit();
  made->normals.shrink_to_fit();
  made->keys.shrink_to_fit();
  made->triangles.shrink_to_fit();
  return made;
}

}  // namespace spinaltap::detail
