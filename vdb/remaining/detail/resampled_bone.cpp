#include "vdb/remaining/detail/resampled_bone.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap::detail {
namespace {

BlockLattice lattice_around(const Box3& box_mm, double voxel_mm) {
  constexpr int kMargin = 2;
  constexpr double kMaxBlocks = 0x1p27;
  const Vec3 low = (box_mm.min() / (kBlockSide * voxel_mm)).array().floor();
  const Vec3 high = (box_mm.max() / (kBlockSide * voxel_mm)).array().floor();
  const Vec3 size = high - low + Vec3::Constant(1.0 + 2.0 * kMargin);
  if (!(size.prod() <= kMaxBlocks)) fail("remaining bone: voxels of ", voxel_mm, " mm are too small for this bone");
  BlockLattice lattice{.voxel_mm = voxel_mm};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    lattice.low[static_cast<std::size_t>(axis)] = static_cast<int>(low[axis]) - kMargin;
    lattice.size[static_cast<std::size_t>(axis)] = static_cast<int>(size[axis]);
  }
  return lattice;
}

/// Blocks that the grid's leaves reach, with a voxel around. All others lie in the grid's tiles.
std::vector<std::size_t> blocks_near_leaves(const openvdb::FloatGrid& grid, const BlockLattice& lattice) {
  std::vector<bool> is_near(lattice.count(), false);
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    Box3 box_mm;
    const openvdb::Coord origin = leaf->origin();
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Vec3d index(origin.x() + ((corner & 1) != 0 ? 8 : -1), origin.y() + ((corner & 2) != 0 ? 8 : -1),
                                 origin.z() + ((corner & 4) != 0 ? 8 : -1));
      box_mm.extend(from_vdb(grid.indexToWorld(index)));
    }
    const auto block_at = [&](double mm) { return static_cast<int>(std::floor(mm / (kBlockSide * lattice.voxel_mm))); };
    const Vec3 low_mm = box_mm.min();
    // A block reaches up to the next one's first voxel.
    const Vec3 high_mm = box_mm.max() + Vec3::Constant(lattice.voxel_mm);
    BlockLattice::Index3 block{};
    for (block[0] = block_at(low_mm.x()); block[0] <= block_at(high_mm.x()); ++block[0]) {
      for (block[1] = block_at(low_mm.y()); block[1] <= block_at(high_mm.y()); ++block[1]) {
        for (block[2] = block_at(low_mm.z()); block[2] <= block_at(high_mm.z()); ++block[2]) {
          if (lattice.holds(block)) is_near[lattice.index(block)] = true;
        }
      }
    }
  }
  std::vector<std::size_t> blocks;
  for (std::size_t n = 0; n < is_near.size(); ++n) {
    if (is_near[n]) blocks.push_back(n);
  }
  return blocks;
}

/// Samples a block, an eighth at a time: where the middle of an eighth is far from the surface, all of it is.
void sample_block(const BoneModel& bone, const Vec3& corner_mm, double voxel_mm, float band_mm,
                  ResampledBone::Values& values) {
  constexpr int kHalf = kBlockSide / 2;
  constexpr std::size_t kPoints = kHalf * kHalf * kHalf;
  const double to_corner_mm = 0.5 * std::sqrt(3.0) * (kHalf - 1) * voxel_mm;
  std::array<Vec3, kPoints> points_mm;
  std::array<float, kPoints> distances_mm{};
  for (int eighth = 0; eighth < 8; ++eighth) {
    const std::array<int, 3> low{(eighth & 1) * kHalf, ((eighth >> 1) & 1) * kHalf, (eighth >> 2) * kHalf};
    const Vec3 middle_mm = corner_mm + voxel_mm * (Vec3(low[0], low[1], low[2]) + Vec3::Constant(0.5 * (kHalf - 1)));
    float at_middle_mm = 0.0F;
    bone.sample({&middle_mm, 1}, {&at_middle_mm, 1}, {});
    // Baked distances grow by a few percent more than 1 mm per mm at most.
    const bool is_far = std::abs(static_cast<double>(at_middle_mm)) > 1.05 * to_corner_mm + voxel_mm;
    std::size_t n = 0;
    for (int x = 0; x < kHalf; ++x) {
      for (int y = 0; y < kHalf; ++y) {
        for (int z = 0; z < kHalf; ++z) {
          points_mm[n++] = corner_mm + voxel_mm * Vec3(low[0] + x, low[1] + y, low[2] + z);
        }
      }
    }
    if (is_far) {
      distances_mm.fill(std::copysign(band_mm, at_middle_mm));
    } else {
      bone.distance(points_mm, distances_mm, {}, Interpolation::quadratic);
    }
    n = 0;
    for (int x = 0; x < kHalf; ++x) {
      for (int y = 0; y < kHalf; ++y) {
        for (int z = 0; z < kHalf; ++z) {
          values[BlockLattice::offset(low[0] + x, low[1] + y, low[2] + z)] =
              std::clamp(distances_mm[n++], -band_mm, band_mm);
        }
      }
    }
  }
}

}  // namespace

ResampledBone resample_bone(const BoneModel& bone, double voxel_mm) {
  if (!(voxel_mm > 0.0)) fail("remaining bone: expected a voxel above 0 mm, found ", voxel_mm);
  ResampledBone result;
  result.lattice = lattice_around(bone.bounds_mm(), voxel_mm);
  const BlockLattice& lattice = result.lattice;
  result.band_mm = static_cast<float>(kBandVoxels * voxel_mm);
  const std::vector<std::size_t> near = blocks_near_leaves(*bone.grids().sdf, lattice);

  result.places.resize(lattice.count());
  tbb::parallel_for(std::size_t{0}, lattice.count(), [&](std::size_t n) {
    const Vec3 middle_mm = lattice.corner_mm(lattice.block(n)) + Vec3::Constant(0.5 * kBlockSide * voxel_mm);
    std::uint8_t is_inside = 0;
    bone.inside({&middle_mm, 1}, {&is_inside, 1});
    result.places[n] = is_inside != 0 ? ResampledBone::kInside : ResampledBone::kOutside;
  });
  // In batches, so that the blocks that turn out to be far from the surface take no memory.
  constexpr std::size_t kBatch = 4096;
  std::vector<ResampledBone::Values> sampled(std::min(kBatch, near.size()));
  for (std::size_t begin = 0; begin < near.size(); begin += kBatch) {
    const std::size_t end = std::min(near.size(), begin + kBatch);
    tbb::parallel_for(begin, end, [&](std::size_t n) {
      sample_block(bone, lattice.corner_mm(lattice.block(near[n])), voxel_mm, result.band_mm, sampled[n - begin]);
    });
    for (std::size_t n = begin; n < end; ++n) {
      const ResampledBone::Values& values = sampled[n - begin];
      const auto [min, max] = std::minmax_element(values.begin(), values.end());
      if (*min >= result.band_mm) {
        result.places[near[n]] = ResampledBone::kOutside;
      } else if (*max <= -result.band_mm) {
        result.places[near[n]] = ResampledBone::kInside;
      } else {
        result.places[near[n]] = static_cast<std::int32_t>(result.values.size());
        result.values.push_back(values);
      }
    }
  }
  result.values.shrink_to_fit();
  return result;
}

}  // namespace spinaltap::detail
