#include "vdb/remaining/detail/block_drill.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

namespace spinaltap::detail {
namespace {

constexpr int kHalfBlock = kBlockSide / 2;

/// Of a cube of so many voxels' middle to its outermost ones.
double to_corner_voxels(int side) { return 0.5 * std::sqrt(3.0) * (side - 1); }

/// A block is looked at by eighths: many of them are out of the bit's reach, others lie along the bit's wall only.
class EighthDrill {
 public:
  EighthDrill(const ResampledBone& bone, const BitSweep& sweep, BlockDrill& drill)
      : bone_(bone),
        sweep_(sweep),
        drill_(drill),
        corner_mm_(bone.lattice.corner_mm(bone.lattice.block(drill.block))),
        voxel_mm_(bone.lattice.voxel_mm),
        band_mm_(static_cast<double>(bone.band_mm)),
        change_mm_(sweep.changes_from_middle_mm(block_middle_mm(bone.lattice, drill.block),
                                                block_reach_mm(bone.lattice), band_mm_, changes_mm_)) {}

  void look(int eighth) {
    low_ = {(eighth & 1) * kHalfBlock, ((eighth >> 1) & 1) * kHalfBlock, (eighth >> 2) * kHalfBlock};
    const Vec3 first = corner_mm_ + voxel_mm_ * Vec3(low_[0], low_[1], low_[2]);
    const Vec3 middle = first + Vec3::Constant(0.5 * (kHalfBlock - 1) * voxel_mm_);
    const double reach_mm = to_corner_voxels(kHalfBlock) * voxel_mm_;
    const double spare_mm = sweep_.middle_distance_mm(middle) - reach_mm - band_mm_;
    if (spare_mm >= change_mm_) {
      // What the bit did not reach may still be reached later, unless it is gone.
      drill_.slack_mm = std::min(drill_.slack_mm, spare_mm);
      drill_.is_done = false;
      return;
    }
    const bool is_at_wall = sweep_.is_at_wall_throughout(middle, reach_mm + band_mm_);
    if (is_at_wall) {
      sweep_.middle_distances_at_wall(first, voxel_mm_, at_middle_mm_);
    } else {
      find_distances(first);
    }
    std::size_t n = 0;
    for (int x = low_[0]; x < low_[0] + kHalfBlock; ++x) {
      for (int y = low_[1]; y < low_[1] + kHalfBlock; ++y) {
        for (int z = low_[2]; z < low_[2] + kHalfBlock; ++z) look_at({x, y, z}, at_middle_mm_[n++], is_at_wall);
      }
    }
  }

  void end_change() {
    if (!drill_.change.values.empty()) drill_.hole->set_gradients(gradients_);
  }

 private:
  /// Distances to the bit at the middle of its way, or less where they are out of reach anyway.
  void find_distances(const Vec3& first) {
    std::size_t n = 0;
    for (int x = 0; x < kHalfBlock; ++x) {
      for (int y = 0; y < kHalfBlock; ++y) {
        for (int z = 0; z < kHalfBlock; ++z) {
          at_middle_mm_[n] = sweep_.middle_distance_mm(first + voxel_mm_ * Vec3(x, y, z));
          const double beyond_mm = at_middle_mm_[n++] - change_mm_ - band_mm_;
          for (int next = 1; z + 1 < kHalfBlock && beyond_mm >= next * voxel_mm_; ++next, ++z, ++n) {
            at_middle_mm_[n] = change_mm_ + band_mm_ + beyond_mm - next * voxel_mm_;
          }
        }
      }
    }
  }

  void look_at(const std::array<int, 3>& voxel, double at_middle_mm, bool is_at_wall) {
    // Rounding to float must not look like a change again and again.
    constexpr double kMinChangeMm = 1e-6;
    const std::size_t offset = BlockLattice::offset(voxel[0], voxel[1], voxel[2]);
    const float hole_mm = drill_.hole == nullptr ? bone_.band_mm : drill_.hole->distance_mm[offset];
    if (hole_mm <= -bone_.band_mm) return;
    const float bone_mm = bone_.at(drill_.block, offset);
    if (bone_mm >= bone_.band_mm) return;
    drill_.is_done = false;
    const double before_mm = static_cast<double>(hole_mm);
    SweepSample sample{before_mm, Vec3::Zero()};
    if (at_middle_mm - change_mm_ < before_mm) {
      const Vec3 p_mm = corner_mm_ + voxel_mm_ * Vec3(voxel[0], voxel[1], voxel[2]);
      sample = is_at_wall ? sweep_.nearest_below_at_wall(p_mm, before_mm, at_middle_mm, changes_mm_)
                          : sweep_.nearest_below(p_mm, before_mm, at_middle_mm, changes_mm_);
    }
    const double after_mm = std::max(sample.distance_mm, -band_mm_);
    if (!(after_mm < before_mm - kMinChangeMm)) {
      drill_.slack_mm = std::min(drill_.slack_mm, at_middle_mm - before_mm);
      return;
    }
    if (after_mm > -band_mm_) drill_.slack_mm = std::min(drill_.slack_mm, at_middle_mm - after_mm);
    if (drill_.change.values.empty()) begin_change();
    drill_.hole->distance_mm[offset] = static_cast<float>(after_mm);
    // Within, where distances are clamped, no surface is near that would ask for it.
    gradients_[offset] =
        after_mm > -band_mm_ ? Eigen::Vector3f(sample.gradient.cast<float>()) : Eigen::Vector3f::Zero();
    drill_.change.values.extend(voxel);
    if (bone_mm < 0.0F && hole_mm > 0.0F && static_cast<float>(after_mm) <= 0.0F) drill_.change.signs.extend(voxel);
  }

  void begin_change() {
    if (drill_.hole != nullptr) {
      gradients_ = drill_.hole->gradients();
    } else {
      gradients_.fill(Eigen::Vector3f::Zero());
    }
    if (drill_.is_own) return;
    drill_.before = drill_.hole;
    drill_.is_copied = true;
    drill_.is_own = true;
    drill_.hole = std::make_shared<HoleBlock>(drill_.hole != nullptr ? *drill_.hole : HoleBlock(bone_.band_mm));
  }

  const ResampledBone& bone_;
  const BitSweep& sweep_;
  BlockDrill& drill_;
  Vec3 corner_mm_;
  double voxel_mm_;
  double band_mm_;
  std::vector<double>
      changes_mm_;    ///< of distances in the block, at most, from the middle to each of the sweep's poses
  double change_mm_;  ///< the largest
  std::array<int, 3> low_{};
  std::array<double, kHalfBlock * kHalfBlock * kHalfBlock> at_middle_mm_{};
  HoleBlock::Gradients gradients_;  ///< as they are now, from begin_change() on
};

}  // namespace

void BlockBox::extend(const std::array<int, 3>& voxel) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], voxel[axis]);
    high[axis] = std::max(high[axis], voxel[axis]);
  }
}

void BlockBox::extend(const BlockBox& box) {
  if (box.empty()) return;
  extend(box.low);
  extend(box.high);
}

Vec3 block_middle_mm(const BlockLattice& lattice, std::size_t block) {
  return lattice.corner_mm(lattice.block(block)) + Vec3::Constant(0.5 * (kBlockSide - 1) * lattice.voxel_mm);
}

double block_reach_mm(const BlockLattice& lattice) { return to_corner_voxels(kBlockSide) * lattice.voxel_mm; }

HoleBlock::Gradients HoleBlock::gradients() const {
  Gradients all;
  all.fill(Eigen::Vector3f::Zero());
  std::size_t next = 0;
  for (std::size_t word = 0; word < kept_.size(); ++word) {
    for (std::uint64_t bits = kept_[word]; bits != 0; bits &= bits - 1) {
      all[64 * word + static_cast<std::size_t>(std::countr_zero(bits))] = gradients_[next++];
    }
  }
  return all;
}

void HoleBlock::set_gradients(const Gradients& gradients) {
  const auto is_kept = [](const Eigen::Vector3f& one) { return one != Eigen::Vector3f::Zero(); };
  std::size_t count = 0;
  for (std::size_t word = 0; word < kept_.size(); ++word) {
    std::uint64_t bits = 0;
    for (std::size_t n = 0; n < 64; ++n) bits |= std::uint64_t{is_kept(gradients[64 * word + n])} << n;
    kept_[word] = bits;
    before_[word] = static_cast<std::uint16_t>(count);
    count += static_cast<std::size_t>(std::popcount(bits));
  }
  std::vector<Eigen::Vector3f> kept;
  kept.reserve(count);
  std::ranges::copy_if(gradients, std::back_inserter(kept), is_kept);
  gradients_ = std::move(kept);
}

void drill_block(const ResampledBone& bone, const BitSweep& sweep, BlockDrill& drill) {
  EighthDrill eighths(bone, sweep, drill);
  for (int eighth = 0; eighth < 8; ++eighth) eighths.look(eighth);
  eighths.end_change();
}

}  // namespace spinaltap::detail
