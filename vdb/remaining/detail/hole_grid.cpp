#include "vdb/remaining/detail/hole_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap::detail {
namespace {

constexpr std::uint32_t kNoneInside = 0;
constexpr std::uint32_t kAllInside = 1;

}  // namespace

HoleGrid::HoleGrid(std::shared_ptr<const ResampledBone> bone, SavedBlocks start)
    : bone_(std::move(bone)),
      gone_(std::make_shared<HoleBlock>(-bone_->band_mm)),
      holes_(bone_->lattice.count()),
      start_(std::move(start)),
      inside_places_(bone_->lattice.count(), kNoneInside) {
  clear();
}

void HoleGrid::clear() {
  for (std::size_t block = 0; block < holes_.size(); ++block) {
    if (holes_[block] == nullptr) continue;
    holes_[block].reset();
    changes_[block] = {BlockBox::whole(), BlockBox::whole()};
  }
  for (const auto& [block, hole] : start_) {
    holes_[block] = hole;
    changes_[block] = {BlockBox::whole(), BlockBox::whole()};
  }
  looks_.clear();
  inside_.assign(2, {});
  inside_[kAllInside].fill(~std::uint64_t{0});
  for (std::size_t block = 0; block < holes_.size(); ++block) {
    inside_places_[block] = bone_->places[block] == ResampledBone::kInside ? kAllInside : kNoneInside;
    if (bone_->places[block] >= 0 || holes_[block] != nullptr) find_inside(block);
  }
}

void HoleGrid::find_inside(std::size_t block) {
  std::uint32_t& place = inside_places_[block];
  if (place == kNoneInside || place == kAllInside) {
    place = static_cast<std::uint32_t>(inside_.size());
    inside_.emplace_back();
  }
  InsideBits& bits = inside_[place];
  for (int x = 0; x < kBlockSide; ++x) {
    std::uint64_t layer = 0;
    for (int yz = 0; yz < kBlockSide * kBlockSide; ++yz) {
      const std::size_t offset = BlockLattice::offset(x, 0, yz);
      const bool is_inside = bone_->at(block, offset) < 0.0F && hole_mm(block, offset) > 0.0F;
      layer |= std::uint64_t{is_inside} << static_cast<unsigned>(yz);
    }
    bits[static_cast<std::size_t>(x)] = layer;
  }
}

std::vector<std::size_t> HoleGrid::blocks_in_reach(const BitSweep& sweep) const {
  const BlockLattice& lattice = bone_->lattice;
  const double block_mm = kBlockSide * lattice.voxel_mm;
  const double band_mm = static_cast<double>(bone_->band_mm);
  const Box3 box_mm = sweep.bounds_mm(band_mm);
  // Layer by layer along the coordinate that the axis runs along most: in each the bit crosses few blocks.
  const Pose& pose = sweep.middle();
  Eigen::Index main = 0;
  pose.axis.cwiseAbs().maxCoeff(&main);
  const double length_mm = sweep.outline().length_mm();
  const double out_mm = band_mm + sweep.outline().radius_mm() +
                        sweep.change_from_middle_mm(pose.tip_mm - 0.5 * length_mm * pose.axis, 0.5 * length_mm, 0.0);
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
  const double around_mm = block_reach_mm(lattice);
  const double band_mm = static_cast<double>(bone_->band_mm);
  const Vec3 middle = block_middle_mm(lattice, block);
  const auto look = looks_.find(block);
  if (look != looks_.end() && look->second.is_done) return false;
  if (look != looks_.end() && look->second.slack_mm >= 0.0) {
    const double change_mm = sweep.change_mm(look->second.from, middle, around_mm, band_mm);
    return change_mm > look->second.slack_mm;
  }
  const double change_mm = sweep.change_from_middle_mm(middle, around_mm, band_mm);
  return sweep.middle_distance_mm(middle) - around_mm - change_mm < band_mm;
}

void HoleGrid::change_bit() {
  for (auto& [block, look] : looks_) look.slack_mm = -1.0;
}

void HoleGrid::drill(const BitSweep& sweep, std::uint64_t epoch, SavedBlocks& before) {
  const std::vector<std::size_t> blocks = blocks_in_reach(sweep);
  std::vector<BlockDrill> drills(blocks.size());
  const auto drill_one = [&](std::size_t n) {
    const std::size_t block = blocks[n];
    const auto look = looks_.find(block);
    const bool is_own = look != looks_.end() && look->second.epoch == epoch && holes_[block] != nullptr;
    drills[n].block = block;
    drills[n].hole = holes_[block];
    drills[n].is_own = is_own;
    drill_block(*bone_, sweep, drills[n]);
  };
  // A block takes some microseconds.
  constexpr std::size_t kWorthSharing = 16;
  if (blocks.size() < kWorthSharing) {
    for (std::size_t n = 0; n < blocks.size(); ++n) drill_one(n);
  } else {
    tbb::parallel_for(std::size_t{0}, blocks.size(), drill_one);
  }
  for (BlockDrill& drill : drills) {
    Look& look = looks_[drill.block];
    look.from = sweep.middle();
    look.slack_mm = drill.slack_mm;
    look.is_done = drill.is_done;
    if (drill.change.values.empty()) continue;
    BlockChange& change = changes_[drill.block];
    change.values.extend(drill.change.values);
    change.signs.extend(drill.change.signs);
    if (drill.is_copied) {
      look.epoch = epoch;
      before.emplace_back(drill.block, std::move(drill.before));
      holes_[drill.block] = std::move(drill.hole);
    }
    // Nothing of it can change any more.
    if (holes_[drill.block]->is_even(-bone_->band_mm)) holes_[drill.block] = gone_;
    find_inside(drill.block);
  }
}

HoleGrid::BlockPtr HoleGrid::exchange(std::size_t block, BlockPtr hole) {
  std::swap(holes_[block], hole);
  looks_.erase(block);
  changes_[block] = {BlockBox::whole(), BlockBox::whole()};
  find_inside(block);
  return hole;
}

std::vector<std::pair<std::size_t, BlockChange>> HoleGrid::take_changes() {
  std::vector<std::pair<std::size_t, BlockChange>> changes(changes_.begin(), changes_.end());
  changes_.clear();
  std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return changes;
}

std::size_t HoleGrid::memory_bytes() const {
  std::size_t blocks = 0;
  for (const BlockPtr& hole : holes_) blocks += hole == nullptr || hole == gone_ ? 0 : hole->memory_bytes();
  return blocks + holes_.capacity() * sizeof(holes_[0]) + inside_places_.capacity() * sizeof(std::uint32_t) +
         inside_.capacity() * sizeof(InsideBits) + looks_.size() * (sizeof(Look) + 4 * sizeof(void*)) +
         changes_.size() * (sizeof(BlockChange) + 4 * sizeof(void*));
}

}  // namespace spinaltap::detail
