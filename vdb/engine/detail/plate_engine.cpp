// A plate's kerf has two large walls along which it slides: thousands of leaves that touch it and lose nothing. So a
// leaf's certificate is of one direction of the plate alone: how far along it the plate may go before it can touch a
// occupied voxel there. How far it went is summed up in each of its three directions, for all of the bone at once, and
// a certificate is the sum at which it ends: that it still holds is one comparison.

#include "vdb/engine/detail/plate_engine.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/tool/plate.h"
#include "vdb/engine/detail/occupied_leaf.h"
#include "vdb/engine/detail/voxel_leaves.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap::detail {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A certificate: it holds while the plate's way along one of its directions is below an end.
struct OneWay {
  unsigned direction = 0;
  double end_mm = -kNever;
};

struct PlateLeaf : OccupiedLeaf {
  Vec3 centre_mm;
  OneWay holds;
};

struct PlateNode {
  Vec3 centre_mm;
  std::size_t begin = 0, count = 0;  ///< of its leaves
  /// The least end of its leaves' certificates, by direction: while the plate is below all three it has nothing to do.
  std::array<double, 3> ends_mm{-kNever, -kNever, -kNever};
};

std::uint64_t packed(const std::array<std::uint8_t, 64>& flags) noexcept {
  std::uint64_t bits = 0;
  for (unsigned bit = 0; bit < 64; ++bit) bits |= std::uint64_t{flags[bit]} << bit;
  return bits;
}

class PlateEngine final : public DrillEngine {
 public:
  PlateEngine(VoxelBone& bone, const DrillBit& plate, const Material& material)
      : plate_(plate), sweep_(plate), voxel_mm_(bone.voxel_mm()), sums_(material) {
    list_leaves(bone.leaves().tree, bone);
    units_ = {voxel_mm_ * voxel_mm_ * voxel_mm_, 1.0 / voxel_mm_};
    // Float's rounding of places as far from the tip as voxels are looked at, with room.
    spare_mm_ = 3e-5 + 1e-6 * (sweep_.box.reach_mm() + 2.0 * node_half_mm_);
    smaller_ = float_box(sweep_.box, -spare_mm_);
    larger_ = float_box(sweep_.turning, spare_mm_);
  }

  StepResult step(const Pose& pose) noexcept override {
    const bool is_unit = std::abs(pose.axis.norm() - 1.0) < 1e-6;
    const std::optional<Pose> sound = is_unit ? valid_pose(pose, plate_) : std::nullopt;
    if (!sound) return {};
    const Pose target = frame_.to_path(*sound);
    if (!(target.tip_mm.cwiseAbs().maxCoeff() <= kEngineReachMm)) return {};
    const Pose start = is_placed_ ? pose_ : target;
    // On its way from where it was it cut nothing, but went.
    if (!is_placed_) go(pose_, target);
    const PlateMotion motion(sweep_, start, target);
    is_placed_ = true;
    pose_ = target;
    Removal removal;
    if (start.axis != target.axis) removal.back = BackParts(target, sweep_.box.length_mm(), units_.places_per_mm);
    for (std::size_t n = 0; n < motion.piece_count(); ++n) remove(motion.piece(n), removal);
    return result_of(removal, units_, frame_, target.tip_mm);
  }

  void reset_motion() noexcept override { is_placed_ = false; }
  std::size_t memory_bytes() const override {
    return sizeof(*this) + leaves_.size() * sizeof(PlateLeaf) + nodes_.size() * sizeof(PlateNode);
  }

 private:
  void list_leaves(VoxelTree& tree, const VoxelBone& bone) {
    openvdb::CoordBBox box;
    tree.evalLeafBoundingBox(box);
    const openvdb::Coord sum = box.empty() ? openvdb::Coord(0) : box.min() + box.max();
    const openvdb::Coord middle(sum.x() / 2, sum.y() / 2, sum.z() / 2);
    frame_ = PathFrame(bone.centre_mm({middle.x(), middle.y(), middle.z()}));
    std::int32_t farthest = 0;
    std::size_t occupied_count = 0;
    const auto centre_mm = [&](const openvdb::Coord& at, unsigned side) -> Vec3 {
      return voxel_mm_ * (Vec3(at.x(), at.y(), at.z()) + Vec3::Constant(0.5 * (side - 1)));
    };
    std::vector<VoxelNode*> nodes;
    tree.getNodes(nodes);
    for (VoxelNode* node : nodes) {
      PlateNode listed{centre_mm(node->origin() - middle, VoxelNode::DIM), leaves_.size()};
      for (auto leaf = node->beginChildOn(); leaf; ++leaf) {
        const auto occupied = static_cast<std::uint32_t>(leaf->onVoxelCount());
        if (occupied == 0) continue;
        const openvdb::Coord at = leaf->origin() - middle;
        leaves_.push_back({{&leaf->getValueMask().template getWord<std::uint64_t>(0),
                            leaf->buffer().data(),
                            {at.x(), at.y(), at.z()},
                            occupied},
                           centre_mm(at, VoxelLeafNode::DIM),
                           {}});
        occupied_count += occupied;
        for (unsigned n = 0; n < 3; ++n) {
          farthest = std::max(farthest, std::abs(at[n]) + std::int32_t{VoxelLeafNode::DIM});
        }
      }
      listed.count = leaves_.size() - listed.begin;
      if (listed.count > 0) nodes_.push_back(listed);
    }
    leaf_half_mm_ = 0.5 * std::sqrt(3.0) * (VoxelLeafNode::DIM - 1) * voxel_mm_;
    node_half_mm_ = 0.5 * std::sqrt(3.0) * (VoxelNode::DIM - 1) * voxel_mm_;
    farthest_mm_ = std::sqrt(3.0) * farthest * voxel_mm_;
    sums_.check_fit(farthest, occupied_count);
  }

  void remove(const SweptPlate& swept, Removal& removal) noexcept {
    begin_.take(swept.from_rows(), voxel_mm_);
    end_.take(swept.to_rows(), voxel_mm_);
    const Pose& to = swept.to();
    go(swept.from(), to);
    for (std::size_t number = 0; number < nodes_.size(); ++number) {
      PlateNode& node = nodes_[number];
      if (way_mm_[0] < node.ends_mm[0] && way_mm_[1] < node.ends_mm[1] && way_mm_[2] < node.ends_mm[2]) continue;
      if (const std::optional<OneWay> free = free_of_ball(node.centre_mm, node_half_mm_, to.tip_mm)) {
        node.ends_mm = {kNever, kNever, kNever};
        node.ends_mm[free->direction] = free->end_mm;
        continue;
      }
      look_into(node, swept, removal);
    }
  }

  /// Sums up how far, at most, any point of the bone goes along each direction, seen from the plate.
  void go(const Pose& from, const Pose& to) noexcept {
    const Mat3 from_rows = plate_rows(from), to_rows = plate_rows(to);
    const double far_mm = to.tip_mm.norm() + farthest_mm_;
    const Vec3 way = from_rows * (from.tip_mm - to.tip_mm);
    for (unsigned n = 0; n < 3; ++n) {
      step_mm_[n] = std::abs(way[n]) + (to_rows.row(n) - from_rows.row(n)).norm() * far_mm;
      way_mm_[n] += step_mm_[n] * (1.0 + 1e-12);
    }
  }

  void look_into(PlateNode& node, const SweptPlate& swept, Removal& removal) noexcept {
    node.ends_mm = {kNever, kNever, kNever};
    for (std::size_t n = node.begin; n < node.begin + node.count;) {
      PlateLeaf& leaf = leaves_[n];
      if (!(way_mm_[leaf.holds.direction] < leaf.holds.end_mm)) {
        look(leaf, swept, removal);
        if (leaf.occupied == 0) {
          leaf = leaves_[node.begin + --node.count];
          continue;
        }
      }
      double& end_mm = node.ends_mm[leaf.holds.direction];
      end_mm = std::min(end_mm, leaf.holds.end_mm);
      ++n;
    }
  }

  /// Whether the plate has not come into a ball on this step, and how far it may go on before it does.
  std::optional<OneWay> free_of_ball(const Vec3& centre_mm, double half_mm, const Vec3& tip_mm) const noexcept {
    const Vec3 seen = end_.rows * (centre_mm - tip_mm);
    const PlateBox& box = sweep_.turning;
    OneWay best;
    double most_mm = 0.0;
    for (unsigned n = 0; n < 3; ++n) {
      const double free_mm = std::max(seen[n] - box.high_mm()[n], box.low_mm()[n] - seen[n]) - half_mm - spare_mm_;
      if (free_mm > step_mm_[n] && free_mm > most_mm) {
        most_mm = free_mm;
        best = {n, way_mm_[n] + free_mm};
      }
    }
    return most_mm > 0.0 ? std::optional(best) : std::nullopt;
  }

  void look(PlateLeaf& leaf, const SweptPlate& swept, Removal& removal) noexcept {
    if (const std::optional<OneWay> free = free_of_ball(leaf.centre_mm, leaf_half_mm_, swept.to().tip_mm)) {
      leaf.holds = *free;
      return;
    }
    const Vec3 seen = end_.rows * (leaf.centre_mm - swept.to().tip_mm);
    const double inside_mm = leaf_half_mm_ + spare_mm_;
    if (((seen - sweep_.box.low_mm()).array() >= inside_mm).all() &&
        ((sweep_.box.high_mm() - seen).array() >= inside_mm).all()) {
      for (unsigned x = 0; x < 8; ++x) sums_.kill(leaf, x, leaf.words[x], removal);
      return;
    }
    const LeafPlace begin = place_of(leaf, begin_, swept.from().tip_mm), end = place_of(leaf, end_, swept.to().tip_mm);
    Beyond beyond;
    for (unsigned x = 0; x < 8; ++x) {
      if (leaf.words[x] == 0) continue;
      std::uint64_t unsure = 0;
      std::uint64_t dead = leaf.words[x] & word_of(begin, end, x, unsure);
      unsure &= leaf.words[x];
      removal.tested += static_cast<std::size_t>(std::popcount(unsure));
      for (std::uint64_t left = unsure; left != 0; left &= left - 1) {
        const auto bit = static_cast<unsigned>(std::countr_zero(left));
        if (swept.contains(voxel_mm_ * voxel_of(leaf, x * 64 + bit))) dead |= std::uint64_t{1} << bit;
      }
      sums_.kill(leaf, x, dead, removal);
      if (leaf.words[x] != 0) beyond.take(end, x, leaf.words[x], larger_);
    }
    if (leaf.occupied == 0) return;
    leaf.holds = {};
    double most_mm = 0.0;
    for (unsigned n = 0; n < 3; ++n) {
      const double free_mm = static_cast<double>(std::max(beyond.low[n], beyond.high[n])) - spare_mm_;
      if (free_mm <= most_mm) continue;
      most_mm = free_mm;
      leaf.holds = {n, way_mm_[n] + free_mm};
    }
  }

  LeafPlace place_of(const PlateLeaf& leaf, const AxisView& view, const Vec3& tip_mm) const noexcept {
    return view.place_of(voxel_mm_ * voxel_of(leaf, 0) - tip_mm, voxel_mm_);
  }

  /// The plate's box in float, along one direction.
  struct FloatBox {
    std::array<float, 3> low, high;
  };
  static FloatBox float_box(const PlateBox& box, double by_mm) {
    FloatBox made{};
    for (unsigned n = 0; n < 3; ++n) {
      made.low[n] = static_cast<float>(box.low_mm()[n] - by_mm);
      made.high[n] = static_cast<float>(box.high_mm()[n] + by_mm);
    }
    return made;
  }

  /// Voxels of a word that the plate surely holds at the end of its way; `unsure`: those of the others that it may have
  /// passed: not all the way on one side of it.
  std::uint64_t word_of(const LeafPlace& begin, const LeafPlace& end, unsigned x,
                        std::uint64_t& unsure) const noexcept {
    std::array<std::uint8_t, 64> held{}, passed{};
    held.fill(1);
    passed.fill(1);
    for (unsigned n = 0; n < 3; ++n) {
      const float from = begin.first[n] + static_cast<float>(x) * begin.per_x[n];
      const float to = end.first[n] + static_cast<float>(x) * end.per_x[n];
      const float low = smaller_.low[n], high = smaller_.high[n];
      const float far_low = larger_.low[n], far_high = larger_.high[n];
      const auto& from_offsets = begin.offsets->of_bits[n];
      const auto& to_offsets = end.offsets->of_bits[n];
      for (std::size_t bit = 0; bit < 64; ++bit) {
        const float a = from + from_offsets[bit], b = to + to_offsets[bit];
        held[bit] &= static_cast<std::uint8_t>((b >= low) & (b <= high));
        const float upper = std::max(a, b), lower = std::min(a, b);
        passed[bit] &= static_cast<std::uint8_t>((upper >= far_low) & (lower <= far_high));
      }
    }
    const std::uint64_t dead = packed(held);
    unsure = packed(passed) & ~dead;
    return dead;
  }

  /// How far occupied voxels lie beyond each of the plate's sides, the least of them.
  struct Beyond {
    std::array<float, 3> low{1e30F, 1e30F, 1e30F}, high{1e30F, 1e30F, 1e30F};

    void take(const LeafPlace& end, unsigned x, std::uint64_t occupied, const FloatBox& box) noexcept {
      alignas(64) std::array<float, 64> absent;
      for (std::size_t bit = 0; bit < 64; ++bit) absent[bit] = (occupied >> bit & 1U) != 0 ? 0.0F : 1e30F;
      for (unsigned n = 0; n < 3; ++n) {
        const float at = end.first[n] + static_cast<float>(x) * end.per_x[n];
        const auto& offsets = end.offsets->of_bits[n];
        float least = 1e30F, greatest = -1e30F;
        for (std::size_t bit = 0; bit < 64; ++bit) {
          least = std::min(least, offsets[bit] + absent[bit]);
          greatest = std::max(greatest, offsets[bit] - absent[bit]);
        }
        high[n] = std::min(high[n], at + least - box.high[n]);
        low[n] = std::min(low[n], box.low[n] - (at + greatest));
      }
    }
  };

  DrillBit plate_;
  PlateSweep sweep_;
  PathFrame frame_;
  double voxel_mm_;
  VoxelSums sums_;
  RemovalUnits units_;
  FloatBox smaller_{}, larger_{};  ///< what the plate surely holds, and what it may touch
  double spare_mm_ = 0.0, leaf_half_mm_ = 0.0, node_half_mm_ = 0.0;
  double farthest_mm_ = 0.0;  ///< of a voxel from the frame's origin
  std::vector<PlateNode> nodes_;
  std::vector<PlateLeaf> leaves_;
  Pose pose_;  ///< in the frame; of the last step
  bool is_placed_ = false;

  // Of the step:
  AxisView begin_, end_;
  std::array<double, 3> step_mm_{};
  std::array<double, 3> way_mm_{};  ///< of all steps so far
};

}  // namespace

std::unique_ptr<DrillEngine> make_plate_engine(VoxelBone& bone, const DrillBit& plate, const Material& material) {
  return std::make_unique<PlateEngine>(bone, plate, material);
}

}  // namespace spinaltap::detail
