#include "vdb/remaining/detail/sampled_hole.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "vdb/detail/bone_grids.h"

namespace spinaltap::detail {
namespace {

using openvdb::Vec3d;
using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;

/// By central differences. Within the hole, where these reach over the middle, as in a tip, they come out too small:
/// there by differences towards the nearest wall.
Vec3 slope(const Sampler& sampler, const Vec3d& p_mm, float distance_mm, double step_mm) {
  constexpr double kTooSmall = 0.97;
  Vec3 central;
  Vec3 outward;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d step(0.0);
    step[axis] = step_mm;
    const auto rise = [&](const Vec3d& to_mm) {
      return static_cast<double>(sampler.wsSample(to_mm) - distance_mm) / step_mm;
    };
    const double forward = rise(p_mm + step);
    const double backward = rise(p_mm - step);
    central[axis] = 0.5 * (forward - backward);
    outward[axis] = std::max({forward, backward, 0.0}) * (forward > backward ? 1.0 : -1.0);
  }
  const bool is_over_middle = distance_mm < 0.0F && central.norm() < kTooSmall && outward.norm() > 0.0;
  return is_over_middle ? Vec3(outward.normalized()) : central;
}

/// Null where no voxel of the block lies in the hole's band.
std::shared_ptr<HoleBlock> sample_block(const openvdb::FloatGrid& hole, const BlockLattice& lattice, std::size_t block,
                                        float band_mm) {
  constexpr int kSide = BlockLattice::kSide;
  const openvdb::FloatGrid::ConstAccessor accessor = hole.getConstAccessor();  // the sampler only points to it
  const Sampler sampler(accessor, hole.transform());
  const double step_mm = hole.voxelSize()[0];
  const Vec3 corner_mm = lattice.corner_mm(lattice.block(block));
  auto sampled = std::make_shared<HoleBlock>(band_mm);
  HoleBlock::Gradients gradients;
  gradients.fill(Eigen::Vector3f::Zero());
  bool is_reached = false;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; ++z) {
        const Vec3d p_mm = to_vdb(corner_mm + lattice.voxel_mm * Vec3(x, y, z));
        const std::size_t offset = BlockLattice::offset(x, y, z);
        const float distance_mm = sampler.wsSample(p_mm);
        sampled->distance_mm[offset] = std::clamp(distance_mm, -band_mm, band_mm);
        if (distance_mm >= band_mm) continue;
        is_reached = true;
        gradients[offset] = slope(sampler, p_mm, distance_mm, step_mm).cast<float>();
      }
    }
  }
  sampled->set_gradients(gradients);
  return is_reached ? sampled : nullptr;
}

}  // namespace

std::vector<std::pair<std::size_t, std::shared_ptr<HoleBlock>>> sample_hole(const openvdb::FloatGrid& hole,
                                                                            const ResampledBone& bone) {
  const BlockLattice& lattice = bone.lattice;
  const Box3 hole_mm = active_box_mm(hole);
  const double block_mm = BlockLattice::kSide * lattice.voxel_mm;
  std::vector<std::pair<std::size_t, std::shared_ptr<HoleBlock>>> blocks;
  for (std::size_t block = 0; block < bone.places.size(); ++block) {
    if (bone.places[block] == ResampledBone::kOutside) continue;
    const Vec3 corner_mm = lattice.corner_mm(lattice.block(block));
    if (hole_mm.intersects(Box3(corner_mm, corner_mm + Vec3::Constant(block_mm)))) blocks.emplace_back(block, nullptr);
  }
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t n) {
    blocks[n].second = sample_block(hole, lattice, blocks[n].first, bone.band_mm);
  });
  std::erase_if(blocks, [](const auto& block) { return block.second == nullptr; });
  return blocks;
}

}  // namespace spinaltap::detail
