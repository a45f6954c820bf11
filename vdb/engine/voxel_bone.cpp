#include "vdb/engine/voxel_bone.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/base/error.h"
#include "core/points/hu_byte.h"
#include "vdb/detail/bone_samplers.h"
#include "vdb/engine/detail/voxel_leaves.h"

namespace spinaltap {
namespace {

using detail::LatticeBlock;
using detail::VoxelLeafNode;
using openvdb::Coord;

constexpr int kSide = static_cast<int>(VoxelLeafNode::DIM);
constexpr openvdb::Index kLeafWords = VoxelLeafNode::SIZE / 64;

/// Leaves that may hold occupied voxels: their origins over their side.
struct LeafRange {
  Coord first, last;
  std::size_t count() const {
    std::size_t product = 1;
    for (unsigned axis = 0; axis < 3; ++axis) product *= static_cast<std::size_t>(last[axis] - first[axis] + 1);
    return product;
  }
};

LeafRange leaves_within(const Box3& box_mm, double voxel_mm) {
  constexpr double kFarthest = 1e8;
  LeafRange range;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double low = std::floor(box_mm.min()[axis] / voxel_mm / kSide) - 1.0;
    const double high = std::floor(box_mm.max()[axis] / voxel_mm / kSide) + 1.0;
    if (!(low > -kFarthest && high < kFarthest)) fail("voxels: expected a bone near the origin, found one at ", low);
    range.first[axis] = static_cast<int>(low);
    range.last[axis] = static_cast<int>(high);
  }
  return range;
}

/// Fills leaves from one or several bones.
class LeafFiller {
 public:
  LeafFiller(std::span<const BoneModel> bones, const VoxelBoneOptions& options) : bones_(bones), options_(options) {
    // A voxel beyond the surface's box is in no cell of it that has an inside corner.
    for (const BoneModel& bone : bones) {
      const Vec3 margin_mm = Vec3::Constant(bone.voxel_mm());
      const Box3 box_mm = bone.bounds_mm();
      boxes_mm_.emplace_back(box_mm.min() - margin_mm, box_mm.max() + margin_mm);
    }
  }

  /// Null where nothing lives there.
  std::unique_ptr<VoxelLeafNode> filled(const Coord& leaf) const {
    const Coord origin(leaf.x() * kSide, leaf.y() * kSide, leaf.z() * kSide);
    LatticeBlock block;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int n = 0; n < kSide; ++n) {
        block.at_mm[axis][static_cast<std::size_t>(n)] = options_.voxel_mm * (origin[axis] + n);
      }
    }
    const VoxelLeafNode::NodeMaskType within = within_region(block);
    if (within.isOff()) return nullptr;
    std::unique_ptr<VoxelLeafNode> node;
    const Box3 box_mm(block.position_mm(0), block.position_mm(VoxelLeafNode::SIZE - 1));
    for (std::size_t n = 0; n < bones_.size(); ++n) {
      if (boxes_mm_[n].intersects(box_mm)) add(bones_[n], block, within, origin, node);
    }
    return node;
  }

 private:
  VoxelLeafNode::NodeMaskType within_region(const LatticeBlock& block) const {
    VoxelLeafNode::NodeMaskType within(true);
    if (options_.region_mm.isEmpty()) return within;
    if (options_.region_mm.contains(Box3(block.position_mm(0), block.position_mm(VoxelLeafNode::SIZE - 1)))) {
      return within;
    }
    for (openvdb::Index n = 0; n < VoxelLeafNode::SIZE; ++n) {
      if (!options_.region_mm.contains(block.position_mm(n))) within.setOff(n);
    }
    return within;
  }

  static void add(const BoneModel& bone, const LatticeBlock& block, const VoxelLeafNode::NodeMaskType& within,
                  const Coord& origin, std::unique_ptr<VoxelLeafNode>& node) {
    const int sign = bone.samplers().distance.sign(block);
    if (sign > 0) return;
    VoxelLeafNode::NodeMaskType occupied = within;
    std::array<float, VoxelLeafNode::SIZE> values;
    if (sign == 0) {
      bone.samplers().distance.linear(block, values);
      for (openvdb::Index n = 0; n < VoxelLeafNode::SIZE; ++n) {
        if (!(values[n] < 0.0F)) occupied.setOff(n);
      }
    }
    if (node) occupied -= node->getValueMask();
    if (occupied.isOff()) return;
    if (!node) node = std::make_unique<VoxelLeafNode>(origin, std::uint8_t{0}, false);
    bone.samplers().hu.linear(block, values);
    std::uint8_t* const bytes = node->buffer().data();
    for (openvdb::Index n = 0; n < VoxelLeafNode::SIZE; ++n) {
      if (occupied.isOff(n)) continue;
      bytes[n] = byte_of_hu(std::isnan(values[n]) ? 0.0 : static_cast<double>(values[n]));
    }
    node->setValueMask(node->getValueMask() | occupied);
  }

  std::span<const BoneModel> bones_;
  std::vector<Box3> boxes_mm_;
  const VoxelBoneOptions& options_;
};

}  // namespace

VoxelBone::VoxelBone(std::span<const BoneModel> bones, const VoxelBoneOptions& options, const Progress& progress)
    : leaves_(std::make_unique<detail::VoxelLeaves>()) {
  if (!(options.voxel_mm >= 0.02 && options.voxel_mm <= 5.0)) {
    fail("voxels: expected a size from 0.02 to 5 mm, found ", options.voxel_mm, " mm");
  }
  if (bones.empty()) fail("voxels: expected at least one bone");
  Box3 box_mm;
  for (const BoneModel& bone : bones) box_mm.extend(bone.bounds_mm());
  if (!options.region_mm.isEmpty()) box_mm = box_mm.intersection(options.region_mm);
  if (box_mm.isEmpty()) fail("voxels: expected a region with bone in it, found none there");
  const LeafRange range = leaves_within(box_mm, options.voxel_mm);
  // 2^31 voxels in 2^22 leaves and as many again that are empty; a box beyond that is no bone's.
  constexpr double kMaxLeaves = 0x1.0p27;
  if (!(static_cast<double>(range.count()) <= kMaxLeaves)) {
    fail("voxels: expected a box of at most 2^36 voxels, found one of ", (box_mm.sizes() / options.voxel_mm).prod());
  }
  leaves_->voxel_mm = options.voxel_mm;
  leaves_->region_mm = options.region_mm;
  const LeafFiller filler(bones, options);
  const int layer_count = range.last.x() - range.first.x() + 1;
  const auto layers = static_cast<std::size_t>(layer_count);
  std::vector<std::vector<std::unique_ptr<VoxelLeafNode>>> found(layers);
  std::atomic<std::size_t> occupied{0};
  constexpr std::size_t kMaxVoxels = std::size_t{1} << 31;
  ProgressCounter counter(progress, "filling voxels", layers);
  tbb::parallel_for(std::size_t{0}, layers, [&](std::size_t layer) {
    std::size_t count = 0;
    for (int y = range.first.y(); y <= range.last.y(); ++y) {
      for (int z = range.first.z(); z <= range.last.z(); ++z) {
        auto node = filler.filled(Coord(range.first.x() + static_cast<int>(layer), y, z));
        if (!node) continue;
        count += node->onVoxelCount();
        found[layer].push_back(std::move(node));
      }
    }
    if (occupied.fetch_add(count) + count > kMaxVoxels) {
      fail("voxels: expected at most 2^31 voxels of bone: take larger ones than ", options.voxel_mm,
           " mm, or a region");
    }
    counter.add();
  });
  if (occupied == 0) fail("voxels: expected bone, found no voxel of ", options.voxel_mm, " mm within");
  for (auto& layer : found) {
    for (auto& node : layer) leaves_->tree.addLeaf(node.release());
  }
}

VoxelBone::~VoxelBone() = default;
VoxelBone::VoxelBone(VoxelBone&&) noexcept = default;
VoxelBone::VoxelBone(const VoxelBone& other) : leaves_(std::make_unique<detail::VoxelLeaves>(*other.leaves_)) {}

double VoxelBone::voxel_mm() const { return leaves_->voxel_mm; }
const Box3& VoxelBone::region_mm() const { return leaves_->region_mm; }

void VoxelBone::restore(const VoxelBone& whole) {
  const auto reject = [] { fail("voxels: expected to be restored from the bone that they are a copy of"); };
  if (whole.voxel_mm() != voxel_mm()) reject();
  auto from = whole.leaves_->tree.cbeginLeaf();
  for (auto leaf = leaves_->tree.cbeginLeaf(); leaf; ++leaf, ++from) {
    if (!from || from->origin() != leaf->origin()) reject();
    VoxelLeafNode::NodeMaskType only_here = leaf->getValueMask();
    only_here -= from->getValueMask();
    if (!only_here.isOff()) reject();
  }
  if (from) reject();
  from = whole.leaves_->tree.cbeginLeaf();
  for (auto leaf = leaves_->tree.beginLeaf(); leaf; ++leaf, ++from) leaf->setValueMask(from->getValueMask());
}

void VoxelBone::get_occupancy_words(std::vector<std::uint64_t>& words) const {
  words.reserve(words.size() + std::size_t{kLeafWords} * leaves_->tree.leafCount());
  for (auto leaf = leaves_->tree.cbeginLeaf(); leaf; ++leaf) {
    for (openvdb::Index n = 0; n < kLeafWords; ++n) words.push_back(leaf->getValueMask().getWord<std::uint64_t>(n));
  }
}

void VoxelBone::set_occupancy_words(std::span<const std::uint64_t> words) {
  const std::size_t expected = std::size_t{kLeafWords} * leaves_->tree.leafCount();
  if (words.size() != expected) fail("voxels: expected ", expected, " occupied words, found ", words.size());
  auto from = words.begin();
  for (auto leaf = leaves_->tree.beginLeaf(); leaf; ++leaf) {
    for (openvdb::Index n = 0; n < kLeafWords; ++n) leaf->getValueMask().getWord<std::uint64_t>(n) = *from++;
  }
}

bool VoxelBone::is_occupied(const Eigen::Vector3i& voxel) const {
  return leaves_->tree.isValueOn(Coord(voxel.x(), voxel.y(), voxel.z()));
}

std::int16_t VoxelBone::hu(const Eigen::Vector3i& voxel) const {
  return hu_of_byte(leaves_->tree.getValue(Coord(voxel.x(), voxel.y(), voxel.z())));
}

void VoxelBone::for_each_occupied(const std::function<void(const Eigen::Vector3i& voxel)>& visit) const {
  for (auto leaf = leaves_->tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const Coord at = voxel.getCoord();
      visit({at.x(), at.y(), at.z()});
    }
  }
}

std::size_t VoxelBone::occupied_count() const { return static_cast<std::size_t>(leaves_->tree.activeVoxelCount()); }

std::size_t VoxelBone::memory_bytes() const { return static_cast<std::size_t>(leaves_->tree.memUsage()); }

}  // namespace spinaltap
