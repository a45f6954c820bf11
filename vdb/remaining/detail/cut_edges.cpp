#include "vdb/remaining/detail/cut_edges.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spinaltap::detail {
namespace {

/// Voxels 0 to 8 of a block and its next neighbours.
class BlockVoxels {
 public:
  BlockVoxels(const HoleGrid& grid, std::size_t block)
      : grid_(&grid), block_(block), strides_(grid.bone().lattice.strides()) {}

  struct Place {
    std::size_t block, offset;
  };
  Place place(const std::array<int, 3>& voxel) const {
    std::size_t block = block_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (voxel[axis] >= kBlockSide) block += static_cast<std::size_t>(strides_[axis]);
    }
    return {block, BlockLattice::offset(voxel[0] & 7, voxel[1] & 7, voxel[2] & 7)};
  }
  double bone_mm(const Place& at) const { return static_cast<double>(grid_->bone().at(at.block, at.offset)); }
  double hole_mm(const Place& at) const { return static_cast<double>(grid_->hole_mm(at.block, at.offset)); }
  Vec3 gradient(const Place& at) const {
    const HoleBlock* hole = grid_->hole(at.block);
    return hole == nullptr ? Vec3(Vec3::Zero()) : Vec3(hole->gradient(at.offset).cast<double>());
  }

 private:
  const HoleGrid* grid_;
  std::size_t block_;
  std::array<std::ptrdiff_t, 3> strides_;
};

/// Where the cubic with these values and slopes at 0 and 1 is zero; the values have different signs.
double cubic_root(double v0, double v1, double s0, double s1) {
  const double c2 = 3.0 * (v1 - v0) - 2.0 * s0 - s1;
  const double c3 = 2.0 * (v0 - v1) + s0 + s1;
  double t = v0 / (v0 - v1);
  for (int step = 0; step < 3; ++step) {
    const double slope = s0 + t * (2.0 * c2 + 3.0 * t * c3);
    if (slope == 0.0) break;
    t = std::clamp(t - (v0 + t * (s0 + t * (c2 + t * c3))) / slope, 0.0, 1.0);
  }
  return t;
}

struct HoleCut {
  double t = 0.0;
  Vec3 normal = Vec3::Zero();
};

/// From voxel a, where the hole's distance is above 0, to voxel b, where it is not: t from a. `along_mm` is b - a.
HoleCut cut_by_hole(double a_mm, const Vec3& a_slope, double b_mm, const Vec3& b_slope, const Vec3& along_mm) {
  constexpr double kSmoothCosine = 0.866;
  const double t_even = a_mm / (a_mm - b_mm);
  const double a_along = a_slope.dot(along_mm);
  const double b_along = b_slope.dot(along_mm);
  const double cosine = a_slope.dot(b_slope);
  // Before an edge of the hole: what is nearest to a lies on the edge, and so in the plane of b's face.
  constexpr double kOneFaceCosine = 0.9999, kInPlane = 1e-3;
  const double off_face_mm = b_mm - a_mm * cosine - b_along;
  if (cosine > 0.0 && cosine < kOneFaceCosine && std::abs(off_face_mm) < kInPlane * along_mm.norm() && b_along < 0.0) {
    // What is left of the bone ends where the edge's second face is passed. Of the other face only a plane between both
    // is known, which holds the edge too.
    const HoleCut by_face{std::clamp(1.0 - b_mm / b_along, 0.0, 1.0), b_slope};
    const HoleCut by_edge{a_along < 0.0 ? std::min(1.0, -a_mm / a_along) : 0.0, a_slope};
    return by_edge.t > by_face.t ? by_edge : by_face;
  }
  if (cosine >= kSmoothCosine) {
    const double t = cubic_root(a_mm, b_mm, a_along, b_along);
    return {t, ((1.0 - t) * a_slope + t * b_slope).normalized()};
  }
  // Two sides of an edge, each seen from its own end: what is left of the bone ends at the first.
  HoleCut cut{t_even, (t_even < 0.5 ? a_slope : b_slope)};
  double first = 2.0;
  if (a_along < 0.0 && a_mm <= -a_along) {
    first = -a_mm / a_along;
    cut = {first, a_slope};
  }
  if (b_along < 0.0) {
    const double t = 1.0 - b_mm / b_along;
    if (t >= 0.0 && t <= std::min(first, 1.0)) cut = {t, b_slope};
  }
  if (cut.normal.squaredNorm() == 0.0)
    cut.normal = a_slope.squaredNorm() > 0.0 ? a_slope : Vec3(-along_mm.normalized());
  return cut;
}

/// A cut by the bone's own surface, to be looked for.
struct BoneCut {
  std::size_t edge = 0;
  double t = 0.0;  ///< from the inner voxel
  Vec3 inner_mm;
  Vec3 along_mm;
};

/// One step of Newton's method along each edge, on the field as it was baked.
void sharpen(const BoneModel& bone, std::vector<BoneCut>& cuts, std::vector<Vec3>& normals) {
  constexpr double kMinSlope = 0.1;
  std::vector<Vec3> points_mm(cuts.size());
  std::vector<float> values_mm(cuts.size());
  normals.resize(cuts.size());
  for (std::size_t n = 0; n < cuts.size(); ++n) points_mm[n] = cuts[n].inner_mm + cuts[n].t * cuts[n].along_mm;
  bone.distance(points_mm, values_mm, normals, Interpolation::quadratic);
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const double slope = normals[n].dot(cuts[n].along_mm);
    const double length_mm = cuts[n].along_mm.norm();
    if (slope > kMinSlope * length_mm) {
      cuts[n].t = std::clamp(cuts[n].t - static_cast<double>(values_mm[n]) / slope, 0.0, 1.0);
    }
    const double steep = normals[n].norm();
    normals[n] = steep > kMinSlope ? Vec3(normals[n] / steep) : Vec3(cuts[n].along_mm / length_mm);
  }
}

}  // namespace

SignRows::SignRows(const HoleGrid& grid, std::size_t block) {
  const auto strides = grid.bone().lattice.strides();
  const auto neighbour_of = [](int voxel) { return voxel < 0 ? -1 : (voxel >= BlockLattice::kSide ? 1 : 0); };
  for (int nx = -1; nx <= 1; ++nx) {
    for (int ny = -1; ny <= 1; ++ny) {
      const auto column =
          static_cast<std::size_t>(static_cast<std::ptrdiff_t>(block) + nx * strides[0] + ny * strides[1]);
      const InsideBits& before = grid.inside(column - 1);
      const InsideBits& own = grid.inside(column);
      const InsideBits& behind = grid.inside(column + 1);
      for (int x = -1; x < kSide - 1; ++x) {
        if (neighbour_of(x) != nx) continue;
        const auto layer = static_cast<std::size_t>(x & 7);
        for (int y = -1; y < kSide - 1; ++y) {
          if (neighbour_of(y) != ny) continue;
          const auto shift = 8U * static_cast<unsigned>(y & 7);
          const auto byte = [&](const InsideBits& bits) { return static_cast<unsigned>(bits[layer] >> shift & 0xFFU); };
          const unsigned bits = byte(before) >> 7U | byte(own) << 1U | (byte(behind) & 3U) << 9U;
          rows_[place(x, y)] = static_cast<std::uint16_t>(bits);
        }
      }
    }
  }
}

std::uint8_t SignRows::code(int x, int y, int z) const {
  const auto two = [&](int dx, int dy) { return row(x + dx, y + dy) >> static_cast<unsigned>(z + 1) & 3U; };
  const unsigned low = two(0, 0) & 1U, high = two(0, 0) >> 1U;
  unsigned code = low | high << 4U;
  code |= (two(1, 0) & 1U) << 1U | (two(1, 0) >> 1U) << 5U;
  code |= (two(0, 1) & 1U) << 2U | (two(0, 1) >> 1U) << 6U;
  code |= (two(1, 1) & 1U) << 3U | (two(1, 1) >> 1U) << 7U;
  return static_cast<std::uint8_t>(code);
}

SurfacePlane EdgeCut::plane() const {
  Vec3 point(voxel[0], voxel[1], voxel[2]);
  point[axis] += t;
  return {point, normal};
}

std::vector<EdgeCut> find_cut_edges(const BoneModel& bone, const HoleGrid& grid, std::size_t block,
                                    const SignRows& signs) {
  const BlockLattice& lattice = grid.bone().lattice;
  const BlockVoxels voxels(grid, block);
  const Vec3 corner_mm = lattice.corner_mm(lattice.block(block));
  std::vector<EdgeCut> edges;
  std::vector<BoneCut> bone_cuts;

  const auto add = [&](int x, int y, int z, std::uint8_t axis) {
    EdgeCut edge;
    edge.voxel = {x, y, z};
    edge.axis = axis;
    edge.rises = signs.is_bone(x, y, z);
    std::array<int, 3> next = edge.voxel;
    ++next[axis];
    const std::array<int, 3>& inner = edge.rises ? edge.voxel : next;
    const auto a = voxels.place(inner);
    const auto b = voxels.place(edge.rises ? next : edge.voxel);
    const Vec3 along_mm = (edge.rises ? lattice.voxel_mm : -lattice.voxel_mm) * Vec3::Unit(axis);
    const double a_mm = voxels.bone_mm(a);
    const double b_mm = voxels.bone_mm(b);
    const double a_hole_mm = voxels.hole_mm(a);
    const double b_hole_mm = voxels.hole_mm(b);
    edge.t = 2.0;
    if (b_hole_mm <= 0.0) {
      const HoleCut cut = cut_by_hole(a_hole_mm, voxels.gradient(a), b_hole_mm, voxels.gradient(b), along_mm);
      edge.t = cut.t;
      // The hole's gradient points into what is left; the bone's outside lies the other way.
      edge.normal = -cut.normal;
      edge.is_wall = true;
    }
    if (b_mm >= 0.0) {
      const Vec3 inner_mm = corner_mm + lattice.voxel_mm * Vec3(inner[0], inner[1], inner[2]);
      bone_cuts.push_back({edges.size(), a_mm / (a_mm - b_mm), inner_mm, along_mm});
    }
    edges.push_back(edge);
  };
  constexpr unsigned kOwn = 0x1FFU << 1U;        // voxels 0 to 8
  constexpr unsigned kOwnButLast = 0xFFU << 1U;  // 0 to 7
  const auto each = [](unsigned bits, const auto& visit) {
    for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits) - 1);
  };
  for (int x = 0; x <= kBlockSide; ++x) {
    for (int y = 0; y <= kBlockSide; ++y) {
      const unsigned row = signs.row(x, y);
      if (x < kBlockSide) each((row ^ signs.row(x + 1, y)) & kOwn, [&](int z) { add(x, y, z, 0); });
      if (y < kBlockSide) each((row ^ signs.row(x, y + 1)) & kOwn, [&](int z) { add(x, y, z, 1); });
      each((row ^ row >> 1U) & kOwnButLast, [&](int z) { add(x, y, z, 2); });
    }
  }
  std::vector<Vec3> normals;
  sharpen(bone, bone_cuts, normals);
  for (std::size_t n = 0; n < bone_cuts.size(); ++n) {
    EdgeCut& edge = edges[bone_cuts[n].edge];
    if (bone_cuts[n].t > edge.t) continue;
    edge.t = bone_cuts[n].t;
    edge.normal = normals[n];
    edge.is_wall = false;
  }
  // So far from the inner voxel on.
  for (EdgeCut& edge : edges) edge.t = edge.rises ? edge.t : 1.0 - edge.t;
  return edges;
}

}  // namespace spinaltap::detail
