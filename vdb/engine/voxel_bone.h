#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/progress.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

namespace detail {
struct VoxelLeaves;
}

struct VoxelBoneOptions {
  double voxel_mm = 0.1;  ///< 0.02 to 5
  Box3 region_mm = {};    ///< voxels with their centre in it, patient LPS; empty: the whole of the bones
};

/// Bones as sparse voxels that any tool can mill anywhere: an OpenVDB tree with, for each voxel, whether it is occupied
/// and its CT number in eight bits. Voxel (i, j, k) has its centre at (i, j, k) voxel_mm, patient LPS, so that bones of
/// one patient share one lattice.
class VoxelBone {
 public:
  /// A voxel lives where the sign of a bone's tri-linear distance is negative at its centre (BoneModel::inside()); its
  /// CT number is that of the first bone that holds it. Throws Error on bad options, where nothing lives, and on more
  /// than 2^31 voxels.
  explicit VoxelBone(std::span<const BoneModel> bones, const VoxelBoneOptions& options = {},
                     const Progress& progress = {});
  explicit VoxelBone(const BoneModel& bone, const VoxelBoneOptions& options = {}, const Progress& progress = {})
      : VoxelBone(std::span(&bone, 1), options, progress) {}
  ~VoxelBone();
  VoxelBone(VoxelBone&&) noexcept;
  /// The same voxels, occupied and dead, in a tree of its own.
  VoxelBone(const VoxelBone& other);

  double voxel_mm() const;
  /// That the voxels were made of; empty: the whole of the bones.
  const Box3& region_mm() const;
  Vec3 centre_mm(const Eigen::Vector3i& voxel) const { return voxel_mm() * voxel.cast<double>(); }
  bool is_occupied(const Eigen::Vector3i& voxel) const;
  /// Of a voxel that lives or has lived, as stored: steps of 16 HU from -1024 to 3056.
  std::int16_t hu(const Eigen::Vector3i& voxel) const;
  /// In the order of the tree.
  void for_each_occupied(const std::function<void(const Eigen::Vector3i& voxel)>& visit) const;

  /// All voxels live again that live in `whole`: the bone that this is a copy of. Throws Error where it is none, and
  /// changes nothing then.
  void restore(const VoxelBone& whole);

  /// Which voxels live, 64 to a word, in an order that milling does not change.
  void get_occupancy_words(std::vector<std::uint64_t>& words) const;
  /// Puts them back as get_occupancy_words() gave them. Throws Error on another number of words, and changes nothing
  /// then.
  void set_occupancy_words(std::span<const std::uint64_t> words);

  std::size_t occupied_count() const;
  /// Of all that is stored.
  std::size_t memory_bytes() const;

  detail::VoxelLeaves& leaves() { return *leaves_; }
  const detail::VoxelLeaves& leaves() const { return *leaves_; }

 private:
  std::unique_ptr<detail::VoxelLeaves> leaves_;
};

}  // namespace spinaltap
