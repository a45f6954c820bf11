#include "vdb/detail/hole_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

constexpr int kSide = BlockLattice::kSide;
constexpr int kHalf = kSide / 2;
constexpr std::uint32_t kNoneInside = 0;
constexpr std::uint32_t kAllInside = 1;

/// Of a block's middle to its outermost voxels.
double to_corner_voxels(int side) { return 0.5 * std::sqrt(3.0) * (side - 1); }

Vec3 middle_mm(const BlockLattice& lattice, std::size_t block) {
  return lattice.corner_mm(lattice.block(block)) + Vec3::Constant(0.5 * (kSide - 1) * lattice.voxel_mm);
}

}  // namespace

void VoxelBox::extend(const std::array<int, 3>& voxel) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], voxel[axis]);
    high[axis] = std::max(high[axis], voxel[axis]);
  }
}

void VoxelBox::extend(const VoxelBox& box) {
  if (box.empty()) return;
  extend(box.low);
  extend(box.high);
}

/// What a look at a block came to.
struct HoleGrid::Outcome {
  std::size_t block = 0;
  Vec3 corner_mm = Vec3::Zero();
  BlockPtr hole;         ///< the block as it is; where it is shared, as it was until something changes
  bool is_own = false;   ///< `hole` may be written
  BlockPtr before;       ///< what was copied
  bool is_copied = false;
  double change_mm = 0.0;          ///< of distances there, at most, during the sweep
  std::vector<double> changes_mm;  ///< the same to each of its poses
  double slack_mm = std::numeric_limits<double>::infinity();
  bool is_done = true;
  BlockChange change;
};

HoleGrid::HoleGrid(std::shared_ptr<const ResampledBone> bone)
    : bone_(std::move(bone)), holes_(bone_->lattice.count()), inside_places_(bone_->lattice.count(), kNoneInside) {
  clear();
}

void HoleGrid::clear() {
  for (std::size_t block = 0; block < holes_.size(); ++block) {
    if (holes_[block] == nullptr) continue;
    holes_[block].reset();
    changes_[block] = {VoxelBox::whole(), VoxelBox::whole()};
  }
  looks_.clear();
  inside_.assign(2, {});
  inside_[kAllInside].fill(~std::uint64_t{0});
  for (std::size_t block = 0; block < holes_.size(); ++block) {
    inside_places_[block] = bone_->places[block] == ResampledBone::kInside ? kAllInside : kNoneInside;
    if (bone_->places[block] >= 0) find_inside(block);
  }
}

void HoleGrid::find_inside(std::size_t block) {
  std::uint32_t& place = inside_places_[block];
  if (place == kNoneInside || place == kAllInside) {
    place = static_cast<std::uint32_t>(inside_.size());
    inside_.emplace_back();
  }
  InsideBits& bits = inside_[place];
  for (int x = 0; x < kSide; ++x) {
    std::uint64_t layer = 0;
    for (int yz = 0; yz < kSide * kSide; ++yz) {
      const std::size_t offset = BlockLattice::offset(x, 0, yz);
      const bool is_inside = bone_->at(block, offset) < 0.0F && hole_mm(block, offset) > 0.0F;
      layer |= std::uint64_t{is_inside} << static_cast<unsigned>(yz);
    }
    bits[static_cast<std::size_t>(x)] = layer;
  }
}

std::vector<std::size_t> HoleGrid::blocks_in_reach(const BitSweep& sweep) const {
  const BlockLattice& lattice = bone_->lattice;
  const double block_mm = kSide * lattice.voxel_mm;
  const double band_mm = static_cast<double>(bone_->band_mm);
  const Box3 box_mm = sweep.bounds_mm(band_mm);
  // Layer by layer along the coordinate that the axis runs along most: in each the bit crosses few blocks.
  const Pose& pose = sweep.middle();
  Eigen::Index main = 0;
  pose.axis.cwiseAbs().maxCoeff(&main);
  const double length_mm = sweep.outline().length_mm();
  const double out_mm = band_mm + sweep.outline().radius_mm() +
                        sweep.change_mm(pose, pose.tip_mm - 0.5 * length_mm * pose.axis, 0.5 * length_mm, 0.0);
  const auto block_at = [&](double mm) { return static_cast<int>(std::floor(mm / block_mm)); };
  const auto clamped = [&](double low, double high, Eigen::Index axis) {
    const auto n = static_cast<std::size_t>(axis);
    // The outermost blocks have no neighbours and no bone.
    return std::pair(std::max(block_at(low), lattice.low[n] + 1),
                     std::min(block_at(high), lattice.low[n] + lattice.size[n] - 2));
  };
  std::vector<std::size_t> blocks;
  const auto [first, last] = clamped(box_mm.min()[main], box_mm.max()[main], main);
  for (int layer = first; layer <= last; ++layer) {
    // The stretch of the axis that can reach the layer, as t mm back from the tip.
    const double low_mm = layer * block_mm - out_mm;
    const double high_mm = (layer + 1) * block_mm + out_mm;
    const double t0 = (pose.tip_mm[main] - low_mm) / pose.axis[main];
    const double t1 = (pose.tip_mm[main] - high_mm) / pose.axis[main];
    const double begin = std::clamp(std::min(t0, t1), 0.0, length_mm);
    const double end = std::clamp(std::max(t0, t1), 0.0, length_mm);
    Box3 around(pose.tip_mm - begin * pose.axis);
    around.extend(pose.tip_mm - end * pose.axis);
    const Vec3 low = (around.min() - Vec3::Constant(out_mm)).cwiseMax(box_mm.min());
    const Vec3 high = (around.max() + Vec3::Constant(out_mm)).cwiseMin(box_mm.max());
    const Eigen::Index u = (main + 1) % 3;
    const Eigen::Index v = (main + 2) % 3;
    const auto [u0, u1] = clamped(low[u], high[u], u);
    const auto [v0, v1] = clamped(low[v], high[v], v);
    BlockLattice::Index3 block{};
    block[static_cast<std::size_t>(main)] = layer;
    for (block[static_cast<std::size_t>(u)] = u0; block[static_cast<std::size_t>(u)] <= u1;
         ++block[static_cast<std::size_t>(u)]) {
      for (block[static_cast<std::size_t>(v)] = v0; block[static_cast<std::size_t>(v)] <= v1;
           ++block[static_cast<std::size_t>(v)]) {
        const std::size_t index = lattice.index(block);
        if (may_change(sweep, index)) blocks.push_back(index);
      }
    }
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

bool HoleGrid::may_change(const BitSweep& sweep, std::size_t block) const {
  if (bone_->places[block] == ResampledBone::kOutside) return false;
  const BlockLattice& lattice = bone_->lattice;
  const double around_mm = to_corner_voxels(kSide) * lattice.voxel_mm;
  const double band_mm = static_cast<double>(bone_->band_mm);
  const Vec3 middle = middle_mm(lattice, block);
  const auto look = looks_.find(block);
  if (look != looks_.end()) {
    if (look->second.is_done) return false;
    const double change_mm = sweep.change_mm(look->second.from, middle, around_mm, band_mm);
    return !(change_mm <= look->second.slack_mm);
  }
  const double change_mm = sweep.change_mm(sweep.middle(), middle, around_mm, band_mm);
  return sweep.middle_distance_mm(middle) - around_mm - change_mm < band_mm;
}

void HoleGrid::look_at(const BitSweep& sweep, std::uint64_t epoch, std::size_t block, Outcome& outcome) const {
  outcome.block = block;
  outcome.hole = holes_[block];
  outcome.corner_mm = bone_->lattice.corner_mm(bone_->lattice.block(block));
  const auto look = looks_.find(block);
  outcome.is_own = look != looks_.end() && look->second.epoch == epoch && outcome.hole != nullptr;
  const double around_mm = to_corner_voxels(kSide) * bone_->lattice.voxel_mm;
  outcome.change_mm = sweep.changes_from_middle_mm(middle_mm(bone_->lattice, block), around_mm,
                                                   static_cast<double>(bone_->band_mm), outcome.changes_mm);
  for (int eighth = 0; eighth < 8; ++eighth) look_at_eighth(sweep, eighth, outcome);
}

void HoleGrid::look_at_eighth(const BitSweep& sweep, int eighth, Outcome& outcome) const {
  // Rounding to float must not look like a change again and again.
  constexpr double kLeastChangeMm = 1e-6;
  const double voxel_mm = bone_->lattice.voxel_mm;
  const float band_mm = bone_->band_mm;
  const double wide_band_mm = static_cast<double>(band_mm);
  const std::array<int, 3> low{(eighth & 1) * kHalf, ((eighth >> 1) & 1) * kHalf, (eighth >> 2) * kHalf};
  const Vec3 middle =
      outcome.corner_mm + voxel_mm * (Vec3(low[0], low[1], low[2]) + Vec3::Constant(0.5 * (kHalf - 1)));
  const double spare_mm = sweep.middle_distance_mm(middle) - to_corner_voxels(kHalf) * voxel_mm - wide_band_mm;
  if (spare_mm >= outcome.change_mm) {
    // What the bit did not reach may still be reached later, unless it is gone.
    outcome.slack_mm = std::min(outcome.slack_mm, spare_mm);
    outcome.is_done = false;
    return;
  }
  for (int x = low[0]; x < low[0] + kHalf; ++x) {
    for (int y = low[1]; y < low[1] + kHalf; ++y) {
      for (int z = low[2]; z < low[2] + kHalf; ++z) {
        const std::size_t offset = BlockLattice::offset(x, y, z);
        const float hole_mm = outcome.hole == nullptr ? band_mm : outcome.hole->distance_mm[offset];
        if (hole_mm <= -band_mm) continue;
        const float bone_mm = bone_->at(outcome.block, offset);
        if (bone_mm >= band_mm) continue;
        outcome.is_done = false;
        const Vec3 p_mm = outcome.corner_mm + voxel_mm * Vec3(x, y, z);
        const double before_mm = static_cast<double>(hole_mm);
        const double at_middle_mm = sweep.middle_distance_mm(p_mm);
        const bool is_in_reach = at_middle_mm - outcome.change_mm < before_mm;
        const SweepSample sample =
            is_in_reach ? sweep.nearest_below(p_mm, before_mm, at_middle_mm, outcome.changes_mm)
                        : SweepSample{before_mm, Vec3::Zero()};
        const double after_mm = std::max(sample.distance_mm, -wide_band_mm);
        if (!(after_mm < before_mm - kLeastChangeMm)) {
          outcome.slack_mm = std::min(outcome.slack_mm, at_middle_mm - before_mm);
          // So far out that the next ones in the row are out of reach too.
          const double beyond = (at_middle_mm - outcome.change_mm - wide_band_mm) / voxel_mm;
          if (beyond >= 1.0) {
            const int next = std::min(static_cast<int>(beyond), kHalf);
            outcome.slack_mm = std::min(outcome.slack_mm, at_middle_mm - next * voxel_mm - wide_band_mm);
            z += next;
          }
          continue;
        }
        if (after_mm > -wide_band_mm) outcome.slack_mm = std::min(outcome.slack_mm, at_middle_mm - after_mm);
        if (!outcome.is_own) {
          outcome.before = outcome.hole;
          outcome.is_copied = true;
          outcome.is_own = true;
          if (outcome.hole != nullptr) {
            outcome.hole = std::make_shared<HoleBlock>(*outcome.hole);
          } else {
            outcome.hole = std::make_shared<HoleBlock>();
            outcome.hole->distance_mm.fill(band_mm);
            outcome.hole->gradient.fill(Eigen::Vector3f::Zero());
          }
        }
        outcome.hole->distance_mm[offset] = static_cast<float>(after_mm);
        outcome.hole->gradient[offset] = sample.gradient.cast<float>();
        outcome.change.values.extend(std::array{x, y, z});
        if (bone_mm < 0.0F && hole_mm > 0.0F && static_cast<float>(after_mm) <= 0.0F) {
          outcome.change.signs.extend(std::array{x, y, z});
        }
      }
    }
  }
}

void HoleGrid::drill(const BitSweep& sweep, std::uint64_t epoch, SavedBlocks& before) {
  const std::vector<std::size_t> blocks = blocks_in_reach(sweep);
  std::vector<Outcome> outcomes(blocks.size());
  // A look takes some microseconds.
  constexpr std::size_t kWorthSharing = 16;
  if (blocks.size() < kWorthSharing) {
    for (std::size_t n = 0; n < blocks.size(); ++n) look_at(sweep, epoch, blocks[n], outcomes[n]);
  } else {
    tbb::parallel_for(std::size_t{0}, blocks.size(),
                      [&](std::size_t n) { look_at(sweep, epoch, blocks[n], outcomes[n]); });
  }
  for (Outcome& outcome : outcomes) {
    Look& look = looks_[outcome.block];
    look.from = sweep.middle();
    look.slack_mm = outcome.slack_mm;
    look.is_done = outcome.is_done;
    if (outcome.change.values.empty()) continue;
    BlockChange& change = changes_[outcome.block];
    change.values.extend(outcome.change.values);
    change.signs.extend(outcome.change.signs);
    if (outcome.is_copied) {
      look.epoch = epoch;
      before.emplace_back(outcome.block, std::move(outcome.before));
      holes_[outcome.block] = std::move(outcome.hole);
    }
    find_inside(outcome.block);
  }
}

HoleGrid::BlockPtr HoleGrid::exchange(std::size_t block, BlockPtr hole) {
  std::swap(holes_[block], hole);
  looks_.erase(block);
  changes_[block] = {VoxelBox::whole(), VoxelBox::whole()};
  find_inside(block);
  return hole;
}

std::vector<std::pair<std::size_t, BlockChange>> HoleGrid::take_changes() {
  std::vector<std::pair<std::size_t, BlockChange>> changes(changes_.begin(), changes_.end());
  changes_.clear();
  std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return changes;
}

std::size_t HoleGrid::hole_block_count() const {
  return static_cast<std::size_t>(
      std::count_if(holes_.begin(), holes_.end(), [](const auto& hole) { return hole != nullptr; }));
}

std::size_t HoleGrid::memory_bytes() const {
  return hole_block_count() * sizeof(HoleBlock) + holes_.capacity() * sizeof(holes_[0]) +
         inside_places_.capacity() * sizeof(std::uint32_t) + inside_.capacity() * sizeof(InsideBits) +
         looks_.size() * (sizeof(Look) + 4 * sizeof(void*)) + changes_.size() * (sizeof(BlockChange) + 4 * sizeof(void*));
}

}  // namespace spinaltap::detail
