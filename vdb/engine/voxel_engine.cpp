// Boxes within boxes: branches of the tree, their nodes, leaves. Each has a certificate of how far the tool may move
// before it can touch a living voxel there (see MoveCertificates); a step looks only where one has run out. What is due
// at the end are leaves, whose words are looked at 64 voxels at a time: most are out of reach or held by the tool, and
// the few that float cannot decide are put to SweptBit, as in every engine.

#include "vdb/engine/voxel_engine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/engine/swept_engine.h"
#include "vdb/engine/detail/certificate_tree.h"
#include "vdb/engine/detail/living_leaf.h"
#include "vdb/engine/detail/move_certificates.h"
#include "vdb/engine/detail/plate_engine.h"
#include "vdb/engine/detail/tool_bounds.h"
#include "vdb/engine/detail/voxel_leaves.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap {
namespace detail {
namespace {

/// What of the tool's moves a certificate counts, from few to all: those across the axis; of the advance, a cone's
/// slope too; all, and no less of the advance than the cone's slope. One that counts few holds as well where more are
/// counted.
enum Counts : std::uint8_t { kAcross, kAcrossCone, kAll };

struct CertifiedLeaf : LivingLeaf {
  std::uint8_t counts = kAcross;  ///< what its certificate counts
  std::uint8_t basis = 0;         ///< 0: words' certificates are from all of the tool; or 1 + the piece they are from
  float free_mm = -1.0F;          ///< its certificate when it was made
  std::array<float, 8> word_mm = {};  ///< and of each word alone
};

/// Middle of a box of `voxels` to a side, in voxels from `zero`.
Vec3 middle_of(const openvdb::Coord& origin, const openvdb::Coord& zero, int voxels) {
  const openvdb::Coord at = origin - zero;
  return Vec3(at.x(), at.y(), at.z()) + Vec3::Constant(0.5 * (voxels - 1));
}

/// More than any certificate has.
constexpr float kFarMm = 1e30F;

class VoxelEngine final : public SweptEngine {
 public:
  VoxelEngine(VoxelBone& bone, const DrillBit& bit, const Material& material, const VoxelEngineOptions& options,
              const WordKernels& kernels)
      : VoxelEngine(bone, bit, material, options, kernels, middle_voxel(bone)) {}

  std::size_t memory_bytes() const override {
    return sizeof(*this) + leaves_.size() * sizeof(CertifiedLeaf) + tree_.memory_bytes();
  }

 private:
  VoxelEngine(VoxelBone& bone, const DrillBit& bit, const Material& material, const VoxelEngineOptions& options,
              const WordKernels& kernels, const openvdb::Coord& middle)
      : SweptEngine(bit, PathFrame(bone.centre_mm({middle.x(), middle.y(), middle.z()}))),
        bounds_(profile()),
        voxel_mm_(bone.voxel_mm()),
        options_(options),
        kernels_(kernels),
        sums_(material) {
    list_tree(bone.leaves().tree, middle);
    sums_.check_fit(farthest_, alive_);
    set_units({voxel_mm_ * voxel_mm_ * voxel_mm_, 1.0 / voxel_mm_});
  }

  static openvdb::Coord middle_voxel(const VoxelBone& bone) {
    openvdb::CoordBBox box;
    bone.leaves().tree.evalLeafBoundingBox(box);
    if (box.empty()) return openvdb::Coord(0);
    const openvdb::Coord sum = box.min() + box.max();
    return {sum.x() / 2, sum.y() / 2, sum.z() / 2};
  }

  void list_tree(VoxelTree& tree, const openvdb::Coord& middle) {
    constexpr std::int32_t kLeafSide = VoxelLeafNode::DIM;
    std::vector<VoxelBranch*> branches;
    tree.getNodes(branches);
    std::vector<CertificateTree::Level> levels(3);
    CertificateTree::Level &leaves = levels[0], &nodes = levels[1], &whole = levels[2];
    const auto list = [&](CertificateTree::Level& level, const auto& node) {
      const auto side = static_cast<int>(node.dim());
      level.half_mm = 0.5 * std::sqrt(3.0) * (side - 1) * voxel_mm_;
      level.centres_mm.push_back(voxel_mm_ * middle_of(node.origin(), middle, side));
    };
    for (VoxelBranch* branch : branches) {
      const std::size_t first_node = nodes.centres_mm.size();
      for (auto node = branch->beginChildOn(); node; ++node) {
        const std::size_t first_leaf = leaves_.size();
        for (auto leaf = node->beginChildOn(); leaf; ++leaf) {
          const auto alive = static_cast<std::uint32_t>(leaf->onVoxelCount());
          if (alive == 0) continue;
          const openvdb::Coord at = leaf->origin() - middle;
          leaves_.push_back({{&leaf->getValueMask().template getWord<std::uint64_t>(0),
                              leaf->buffer().data(),
                              {at.x(), at.y(), at.z()},
                              alive}});
          alive_ += alive;
          for (unsigned axis = 0; axis < 3; ++axis) farthest_ = std::max(farthest_, std::abs(at[axis]) + kLeafSide);
          list(leaves, *leaf);
        }
        if (leaves_.size() == first_leaf) continue;
        list(nodes, *node);
        nodes.add_children(first_leaf, leaves_.size());
      }
      if (nodes.centres_mm.size() == first_node) continue;
      list(whole, *branch);
      whole.add_children(first_node, nodes.centres_mm.size());
    }
    tree_ = CertificateTree(std::move(levels));
  }

  void remove(const SweptBit& bit, Removal& removal) noexcept override { take(std::span(&bit, 1), removal); }

  void remove_together(std::span<const SweptBit> pieces, Removal& removal) noexcept override {
    // Together, each leaf is looked at once, with all voxels that lie within the whole way of the tool. Measured: that
    // pays where a tool hardly does more than turn; one whose tip goes far is quicker piece by piece.
    constexpr double kLongWayMm = 0.3;
    const Vec3 way = pieces.back().to().tip_mm - pieces.front().from().tip_mm;
    if (way.norm() <= kLongWayMm) return take(pieces, removal);
    for (const SweptBit& piece : pieces) remove(piece, removal);
  }

  void take(std::span<const SweptBit> pieces, Removal& removal) noexcept {
    const SweptBounds tool(pieces, bounds_);
    const WordTool words = word_tool(tool);
    Mat3 rows = pieces.front().from_rows();
    views_[0].take(rows, voxel_mm_);
    for (std::size_t n = 0; n < pieces.size(); ++n) {
      // Each piece has directions across the axis of its own.
      rows = n == 0 ? pieces[n].to_rows() : Mat3(rows * (pieces[n].from_rows().transpose() * pieces[n].to_rows()));
      views_[n + 1].take(rows, voxel_mm_);
    }
    const auto due = tree_.due(tool);
    // Measured: sharing breaks even at some 20 us of work, a leaf takes 0.2 us.
    constexpr std::size_t kWorthSharing = 200;
    if (options_.shares_work && due.size() >= kWorthSharing) {
      removal.add(tbb::parallel_reduce(
          tbb::blocked_range<std::size_t>(0, due.size(), kWorthSharing / 4), removal.empty(),
          [&](const tbb::blocked_range<std::size_t>& range, Removal sum) {
            for (std::size_t n = range.begin(); n < range.end(); ++n) look(due[n], tool, words, sum);
            return sum;
          },
          [](Removal a, const Removal& b) {
            a.add(b);
            return a;
          }));
    } else {
      for (const std::uint32_t leaf : due) look(leaf, tool, words, removal);
    }
    tree_.finish([&](std::size_t from, std::size_t to) { leaves_[to] = leaves_[from]; });
  }

  WordTool word_tool(const SweptBounds& tool) const noexcept {
    const auto f = [](double value) { return static_cast<float>(value); };
    static_assert(kMaxStretches <= WordTool::kMaxPieces);
    WordTool words{};
    for (const ToolBounds::Piece& piece : bounds_.pieces()) {
      words.pieces[words.piece_count++] = {f(piece.begin_mm),       f(piece.end_mm),  f(piece.ball_centre_mm),
                                           f(piece.ball_radius_mm), f(piece.per_off), f(piece.per_back),
                                           f(piece.at_origin_mm)};
    }
    words.radius = f(bounds_.radius_mm());
    words.cone_offset = f(bounds_.cone_offset_mm());
    words.cone_slope = f(bounds_.cone_slope());
    // Float's rounding of places this far from the tip, and of how far a turn takes them, with room.
    const BitProfile& outline = tool.pieces().front().profile();
    const double far_mm = outline.length_mm() + 2.0 * outline.radius_mm() + tool.line().way_mm + 4.0 * tree_.half_mm() +
                          bounds_.larger_ball_mm();
    words.skin = f(tool.line().edge_mm > 0.0 ? SweepProfile::kTurningSkinMm : SweepProfile::kStraightSkinMm);
    words.spare = f(3e-5 + 2e-6 * (1.0 + 1.6 * tool.line().turned) * far_mm);
    return words;
  }

  Vec3 centre_mm(const LivingLeaf& leaf, std::size_t bit) const noexcept { return voxel_mm_ * voxel_of(leaf, bit); }

  LeafPlace place_of(const CertifiedLeaf& leaf, const Vec3& tip_mm, const AxisView& view) const noexcept {
    return view.place_of(centre_mm(leaf, 0) - tip_mm, voxel_mm_);
  }

  void look(std::size_t number, const SweptBounds& tool, const WordTool& words, Removal& removal) noexcept {
    CertifiedLeaf& leaf = leaves_[number];
    const double half_mm = tree_.half_mm();
    const BitPlace centre = tool.place(tree_.centre_mm(number));
    const SweptBounds::Reach reach = tool.reach_of_ball(centre, half_mm);
    const PieceBounds from(bounds_, centre, half_mm);
    const FreeMove outside = tool.free_of_ball(centre, half_mm, from.least_mm(), reach, 0.5 * half_mm);
    if (outside.free_mm > 0.0) {
      leaf.word_mm.fill(static_cast<float>(outside.free_mm));
      leaf.basis = 0;
      const Counts counts = outside.backward > 0.0 ? kAll : outside.forward > 0.0 ? kAcrossCone : kAcross;
      if (counts == kAll) {
        const auto [pieces, rest_mm] = from.within(from.least_mm() + 0.5 * half_mm);
        FreeMove one_sided = tool.to_one_side(tree_.centre_mm(number), half_mm, pieces);
        const double round_mm = ToolBounds::from_round_mm(bounds_.pieces()[from.nearest()], centre) - half_mm;
        if (one_sided.angle_sine < 1.0 && round_mm >= reach.body + 0.25 * half_mm) {
          one_sided.free_mm = std::min(outside.free_mm, round_mm - bounds_.margin_mm());
          one_sided.rest_mm = rest_mm - bounds_.margin_mm();
          leaf.word_mm.fill(static_cast<float>(one_sided.free_mm));
          leaf.basis = static_cast<std::uint8_t>(1 + from.nearest());
          return certify(number, one_sided, counts);
        }
      }
      return certify(number, static_cast<float>(outside.free_mm), counts);
    }
    if (tool.holds_ball(centre, half_mm)) {
      for (unsigned x = 0; x < 8; ++x) sums_.kill(leaf, x, leaf.words[x], removal);
      tree_.set_empty(number);
      return;
    }
    LeafArguments arguments;
    const double more_mm = 2.0 * (static_cast<double>(words.spare) + bounds_.margin_mm());
    arguments.cylinder = static_cast<float>(reach.cylinder + more_mm);
    arguments.cone = static_cast<float>(reach.cone + more_mm * (1.0 + bounds_.cone_slope()));
    arguments.body = static_cast<float>(reach.body + 2.0 * more_mm);
    arguments.piece = static_cast<float>(reach.piece + 2.0 * more_mm);
    const PieceBounds::Near near = from.within(static_cast<double>(arguments.body));
    arguments.pieces = near.pieces;
    arguments.rest = static_cast<float>(near.rest_mm);
    FreeMove one_sided = tool.to_one_side(tree_.centre_mm(number), half_mm, arguments.pieces);
    const auto basis =
        static_cast<std::uint8_t>(one_sided.angle_sine < 1.0 ? 1 + std::countr_zero(arguments.pieces) : 0);
    // Words as the certificate left them, less what has been used of it since.
    const float used_mm = basis == leaf.basis ? leaf.free_mm - tree_.left_mm(number) : kFarMm;
    arguments.due = 0;
    unsigned skipped = 0;
    for (unsigned x = 0; x < 8; ++x) {
      if (leaf.words[x] == 0) continue;
      leaf.word_mm[x] -= used_mm;
      (leaf.word_mm[x] > 0.0F ? skipped : arguments.due) |= 1U << x;
    }
    // A bound from the cylinder is of use where nothing lies within it.
    arguments.wants_cylinder = skipped == 0 && centre.off_mm + half_mm > bounds_.radius_mm();
    arguments.tool = &words;
    arguments.words = leaf.words;
    static_assert(kTogether <= LeafArguments::kMostPieces);
    const auto pieces = tool.pieces();
    arguments.piece_count = static_cast<unsigned>(pieces.size());
    arguments.places[0] = place_of(leaf, pieces.front().from().tip_mm, views_[0]);
    for (std::size_t n = 0; n < pieces.size(); ++n) {
      arguments.places[n + 1] = place_of(leaf, pieces[n].to().tip_mm, views_[n + 1]);
    }
    std::array<WordResult, 8> seen;
    kernels_.look(arguments, seen.data());
    std::array<Nearest, 8> nearest;
    Nearest least;
    for (unsigned x = 0; x < 8; ++x) {
      if ((arguments.due >> x & 1U) == 0) continue;
      std::uint64_t dead = seen[x].dead;
      nearest[x] = {static_cast<double>(seen[x].cylinder - words.spare),
                    static_cast<double>(seen[x].cone - words.spare), static_cast<double>(seen[x].body - words.spare)};
      if (basis == 0) nearest[x].body_mm = std::min(nearest[x].body_mm, static_cast<double>(arguments.rest));
      removal.tested += static_cast<std::size_t>(std::popcount(seen[x].unsure));
      for (std::uint64_t left = seen[x].unsure; left != 0; left &= left - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(left));
        const Vec3 p = centre_mm(leaf, x * 64 + bit);
        if (tool.contains_inlined(p)) {
          dead |= std::uint64_t{1} << bit;
          continue;
        }
        const BitPlace at = tool.place(p);
        const double body_mm =
            basis != 0 ? ToolBounds::from_round_mm(bounds_.pieces()[from.nearest()], at) : bounds_.from_body_mm(at);
        nearest[x].take({bounds_.from_cylinder_mm(at), bounds_.from_cone_mm(at), body_mm});
      }
      sums_.kill(leaf, x, dead, removal);
      if (leaf.words[x] != 0) least.take(nearest[x]);
    }
    if (leaf.alive == 0) {
      tree_.set_empty(number);
      return;
    }
    Counts counts = what_to_count(least);
    if (skipped != 0) counts = std::max(counts, static_cast<Counts>(leaf.counts));
    leaf.basis = skipped == 0 && counts == kAcross ? std::uint8_t{0} : basis;
    if (leaf.basis != 0) counts = kAll;
    float free_mm = kFarMm;
    for (unsigned x = 0; x < 8; ++x) {
      if (leaf.words[x] == 0) continue;
      float word_mm = leaf.word_mm[x];
      if ((arguments.due >> x & 1U) != 0) {
        word_mm = static_cast<float>(free_of(nearest[x], counts));
        // What does not hold now does not hold after a move away either.
        leaf.word_mm[x] = word_mm > 0.0F ? word_mm : -kFarMm;
      }
      free_mm = std::min(free_mm, word_mm);
    }
    if (leaf.basis == 0) return certify(number, free_mm, counts);
    one_sided.free_mm = static_cast<double>(free_mm);
    one_sided.rest_mm = static_cast<double>(arguments.rest) - bounds_.margin_mm();
    certify(number, one_sided, counts);
  }

  /// Least bounds of voxels that live.
  struct Nearest {
    double cylinder_mm = 1e30, cone_mm = 1e30, body_mm = 1e30;
    void take(const Nearest& other) noexcept {
      cylinder_mm = std::min(cylinder_mm, other.cylinder_mm);
      cone_mm = std::min(cone_mm, other.cone_mm);
      body_mm = std::min(body_mm, other.body_mm);
    }
  };
  Counts what_to_count(const Nearest& least) const noexcept {
    // Behind the cone a bit slides along its own wall: that certificate outlives a much longer one that counts advance.
    const double margin_mm = bounds_.margin_mm();
    const double other_mm = bounds_.has_cone() ? least.cone_mm : least.body_mm;
    if (least.cylinder_mm > std::max(4.0 * margin_mm, 0.25 * other_mm)) return kAcross;
    return bounds_.has_cone() && least.cone_mm > 4.0 * margin_mm ? kAcrossCone : kAll;
  }
  double free_of(const Nearest& nearest, Counts counts) const noexcept {
    const double bound_mm = counts == kAcross       ? nearest.cylinder_mm
                            : counts == kAcrossCone ? nearest.cone_mm
                                                    : nearest.body_mm;
    return bound_mm - bounds_.margin_mm();
  }
  void certify(std::size_t number, float free_mm, Counts counts) noexcept {
    const double slope = bounds_.has_cone() ? bounds_.cone_slope() : 0.0;
    const double forward = counts == kAll ? std::max(1.0, slope) : counts == kAcrossCone ? slope : 0.0;
    certify(number, {static_cast<double>(free_mm), forward, counts == kAll ? 1.0 : 0.0}, counts);
  }
  void certify(std::size_t number, const FreeMove& free, Counts counts) noexcept {
    tree_.certify(number, free);
    leaves_[number].free_mm = static_cast<float>(free.free_mm);
    leaves_[number].counts = counts;
  }

  ToolBounds bounds_;
  double voxel_mm_;
  VoxelEngineOptions options_;
  const WordKernels& kernels_;
  VoxelSums sums_;
  std::array<AxisView, kTogether + 1> views_;  ///< at the begin of this way and after each of its pieces
  CertificateTree tree_;                       ///< of leaves, nodes, branches
  std::vector<CertifiedLeaf> leaves_;
  std::size_t alive_ = 0;
  std::int32_t farthest_ = 0;
};

}  // namespace

std::unique_ptr<DrillEngine> make_voxel_engine(VoxelBone& bone, const DrillBit& bit, const Material& material,
                                               const VoxelEngineOptions& options, const WordKernels& kernels) {
  if (bit.is_plate()) return make_plate_engine(bone, bit, material);
  return std::make_unique<VoxelEngine>(bone, bit, material, options, kernels);
}

}  // namespace detail

std::unique_ptr<DrillEngine> make_voxel_engine(VoxelBone& bone, const DrillBit& bit, const Material& material,
                                               const VoxelEngineOptions& options) {
  return detail::make_voxel_engine(bone, bit, material, options, detail::word_kernels().back());
}

}  // namespace spinaltap
