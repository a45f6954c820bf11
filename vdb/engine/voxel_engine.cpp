// Boxes within boxes: branches of the tree, their nodes, leaves. Each has a certificate of how far the tool may move
// before it can touch an occupied voxel there (see MoveCertificates); a step looks only where one has run out. What is
// due at the end are leaves. Where only balls and cylinders of the tool are near, their rows of voxels are cut with
// these; elsewhere their words are looked at 64 voxels at a time. The few that float cannot decide are put to SweptBit,
// as in every engine.

#include "vdb/engine/voxel_engine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/engine/swept_engine.h"
#include "vdb/engine/detail/certificate_tree.h"
#include "vdb/engine/detail/move_certificates.h"
#include "vdb/engine/detail/occupied_leaf.h"
#include "vdb/engine/detail/plate_engine.h"
#include "vdb/engine/detail/round_rows.h"
#include "vdb/engine/detail/tool_bounds.h"
#include "vdb/engine/detail/voxel_leaves.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap {
namespace detail {
namespace {

/// More than any bound.
constexpr double kFarMm = 1e30;

/// Middle of a box of `voxels` to a side, in voxels from `zero`.
Vec3 middle_of(const openvdb::Coord& origin, const openvdb::Coord& zero, int voxels) {
  const openvdb::Coord at = origin - zero;
  return Vec3(at.x(), at.y(), at.z()) + Vec3::Constant(0.5 * (voxels - 1));
}

class VoxelEngine final : public SweptEngine {
 public:
  VoxelEngine(VoxelBone& bone, const DrillBit& bit, const Material& material, const VoxelEngineOptions& options,
              const WordKernels& kernels)
      : VoxelEngine(bone, bit, material, options, kernels, middle_voxel(bone)) {}

  std::size_t memory_bytes() const override {
    return sizeof(*this) + leaves_.size() * sizeof(OccupiedLeaf) + tree_.memory_bytes();
  }

 private:
  VoxelEngine(VoxelBone& bone, const DrillBit& bit, const Material& material, const VoxelEngineOptions& options,
              const WordKernels& kernels, const openvdb::Coord& middle)
      : SweptEngine(bit, PathFrame(bone.centre_mm({middle.x(), middle.y(), middle.z()}))),
        bounds_(profile()),
        voxel_mm_(bone.voxel_mm()),
        rounds_(bounds_, voxel_mm_),
        options_(options),
        kernels_(kernels),
        sums_(material) {
    list_tree(bone.leaves().tree, middle);
    sums_.check_fit(farthest_, occupied_);
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
          const auto occupied = static_cast<std::uint32_t>(leaf->onVoxelCount());
          if (occupied == 0) continue;
          const openvdb::Coord at = leaf->origin() - middle;
          leaves_.push_back({&leaf->getValueMask().template getWord<std::uint64_t>(0),
                             leaf->buffer().data(),
                             {at.x(), at.y(), at.z()},
                             occupied});
          occupied_ += occupied;
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
  // Together, each leaf is looked at once, with all voxels that lie within the whole way of the tool.
  void remove_together(std::span<const SweptBit> pieces, Removal& removal) noexcept override { take(pieces, removal); }

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
    rounds_.take(tool);
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
    words.spare = f(3e-5 + 2e-6 * (1.0 + 1.6 * tool.line().turned) * far_mm);
    return words;
  }

  Vec3 centre_mm(const OccupiedLeaf& leaf, std::size_t bit) const noexcept { return voxel_mm_ * voxel_of(leaf, bit); }

  LeafPlace place_of(const OccupiedLeaf& leaf, const Vec3& tip_mm, const AxisView& view) const noexcept {
    return view.place_of(centre_mm(leaf, 0) - tip_mm, voxel_mm_);
  }

  void look(std::size_t number, const SweptBounds& tool, const WordTool& words, Removal& removal) noexcept {
    OccupiedLeaf& leaf = leaves_[number];
    const double half_mm = tree_.half_mm();
    const BitPlace centre = tool.place(tree_.centre_mm(number));
    const SweptBounds::Reach reach = tool.reach_of_ball(centre, half_mm);
    const PieceBounds from(bounds_, centre, half_mm);
    const FreeMove outside = tool.free_of_ball(centre, half_mm, from.least_mm(), reach, 0.5 * half_mm);
    if (outside.free_mm > 0.0) {
      if (outside.backward > 0.0) {
        const auto [pieces, rest_mm] = from.within(from.least_mm() + 0.5 * half_mm);
        FreeMove one_sided = tool.to_one_side(tree_.centre_mm(number), half_mm, pieces);
        const double round_mm = ToolBounds::from_round_mm(bounds_.pieces()[from.nearest()], centre) - half_mm;
        if (one_sided.has_side() && round_mm >= reach.body + 0.25 * half_mm) {
          one_sided.free_mm = std::min(outside.free_mm, round_mm - bounds_.margin_mm());
          one_sided.rest_mm = rest_mm - bounds_.margin_mm();
          return tree_.certify(number, one_sided);
        }
      }
      return tree_.certify(number, outside);
    }
    const double more_mm = 2.0 * (static_cast<double>(words.spare) + bounds_.margin_mm());
    const PieceBounds::Near near = from.within(reach.body + 2.0 * more_mm);
    const FreeMove free = (near.pieces & ~rounds_.pieces()) == 0
                              ? look_at_rows(number, tool, centre, reach, near, removal)
                              : look_at_words(leaf, tool, words, reach, near, removal);
    if (leaf.occupied == 0) return tree_.set_empty(number);
    tree_.certify(number, free);
  }

  /// Where nothing but balls and cylinders can have come near.
  FreeMove look_at_rows(std::size_t number, const SweptBounds& tool, const BitPlace& centre,
                        const SweptBounds::Reach& reach, const PieceBounds::Near& near, Removal& removal) noexcept {
    OccupiedLeaf& leaf = leaves_[number];
    const double half_mm = tree_.half_mm();
    std::array<std::uint64_t, 8> dead{}, unsure{};
    // From the balls and cylinders alone, and from the tool, which has ends.
    double round_mm = kFarMm, body_mm = near.rest_mm;
    for (unsigned left = near.pieces; left != 0; left &= left - 1) {
      const auto piece = static_cast<std::size_t>(std::countr_zero(left));
      RowArguments rows;
      rounds_.put(piece, leaf.words, centre_mm(leaf, 0), centre, half_mm, reach, rows);
      round_mm = std::min(round_mm, rounds_.bound_mm(piece, kernels_.look_at_rows(rows, dead.data(), unsure.data())));
    }
    body_mm = std::min(body_mm, round_mm);
    for (unsigned x = 0; x < 8; ++x) {
      if ((dead[x] | unsure[x]) == 0) continue;
      unsure[x] &= ~dead[x];
      dead[x] |= passed(leaf, x, unsure[x], tool, removal);
      sums_.kill(leaf, x, dead[x], removal);
      for (std::uint64_t left = unsure[x] & ~dead[x]; left != 0; left &= left - 1) {
        const BitPlace at = tool.place(centre_mm(leaf, x * 64 + static_cast<std::size_t>(std::countr_zero(left))));
        body_mm = std::min(body_mm, bounds_.from_body_mm(at));
        for (unsigned pieces = near.pieces; pieces != 0; pieces &= pieces - 1) {
          const auto piece = static_cast<std::size_t>(std::countr_zero(pieces));
          round_mm = std::min(round_mm, ToolBounds::from_round_mm(bounds_.pieces()[piece], at));
        }
      }
    }
    if (leaf.occupied == 0) return {};
    const double margin_mm = bounds_.margin_mm();
    FreeMove free = tool.to_one_side(tree_.centre_mm(number), half_mm, near.pieces);
    // Along its own wall a bit slides for ever.
    if (free.axial == 0.0 && round_mm > 4.0 * margin_mm && bounds_.is_widest(near.pieces)) {
      return {round_mm - margin_mm, 0.0, 0.0};
    }
    if (free.has_side() && round_mm > 0.5 * body_mm) {
      free.free_mm = round_mm - margin_mm;
      free.rest_mm = near.rest_mm - margin_mm;
      return free;
    }
    return {body_mm - margin_mm, 1.0, 1.0};
  }

  /// Where others may have.
  FreeMove look_at_words(OccupiedLeaf& leaf, const SweptBounds& tool, const WordTool& words,
                         const SweptBounds::Reach& reach, const PieceBounds::Near& near, Removal& removal) noexcept {
    LeafArguments arguments;
    const double more_mm = 2.0 * (static_cast<double>(words.spare) + bounds_.margin_mm());
    arguments.cylinder = static_cast<float>(reach.cylinder + more_mm);
    arguments.cone = static_cast<float>(reach.cone + more_mm * (1.0 + bounds_.cone_slope()));
    arguments.body = static_cast<float>(reach.body + 2.0 * more_mm);
    arguments.piece = static_cast<float>(reach.piece + 2.0 * more_mm);
    arguments.pieces = near.pieces;
    arguments.rest = static_cast<float>(near.rest_mm);
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
    kernels_.look_at_words(arguments, seen.data());
    Nearest least;
    for (unsigned x = 0; x < 8; ++x) {
      if (leaf.words[x] == 0) continue;
      const std::uint64_t dead = seen[x].dead | passed(leaf, x, seen[x].unsure, tool, removal);
      sums_.kill(leaf, x, dead, removal);
      least.take({static_cast<double>(seen[x].cylinder - words.spare), static_cast<double>(seen[x].cone - words.spare),
                  static_cast<double>(seen[x].body - words.spare)});
      for (std::uint64_t left = seen[x].unsure & ~dead; left != 0; left &= left - 1) {
        const BitPlace at = tool.place(centre_mm(leaf, x * 64 + static_cast<std::size_t>(std::countr_zero(left))));
        least.take({bounds_.from_cylinder_mm(at), bounds_.from_cone_mm(at), bounds_.from_body_mm(at)});
      }
    }
    // Behind the cone a bit slides along its own wall: that certificate outlives a much longer one that counts advance.
    const double margin_mm = bounds_.margin_mm();
    const double other_mm = bounds_.has_cone() ? least.cone_mm : least.body_mm;
    if (least.cylinder_mm > std::max(4.0 * margin_mm, 0.25 * other_mm)) {
      return {least.cylinder_mm - margin_mm, 0.0, 0.0};
    }
    if (bounds_.has_cone() && least.cone_mm > 4.0 * margin_mm) {
      return {least.cone_mm - margin_mm, bounds_.cone_slope(), 0.0};
    }
    return {least.body_mm - margin_mm, 1.0, 1.0};
  }

  /// Those of some voxels of word x that the tool passed.
  std::uint64_t passed(const OccupiedLeaf& leaf, unsigned x, std::uint64_t unsure, const SweptBounds& tool,
                       Removal& removal) const noexcept {
    removal.tested += static_cast<std::size_t>(std::popcount(unsure));
    std::uint64_t dead = 0;
    for (std::uint64_t left = unsure; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      if (tool.contains_inlined(centre_mm(leaf, x * 64 + bit))) dead |= left & ~(left - 1);
    }
    return dead;
  }

  /// Least bounds of voxels that live.
  struct Nearest {
    double cylinder_mm = kFarMm, cone_mm = kFarMm, body_mm = kFarMm;
    void take(const Nearest& other) noexcept {
      cylinder_mm = std::min(cylinder_mm, other.cylinder_mm);
      cone_mm = std::min(cone_mm, other.cone_mm);
      body_mm = std::min(body_mm, other.body_mm);
    }
  };

  ToolBounds bounds_;
  double voxel_mm_;
  RoundRows rounds_;
  VoxelEngineOptions options_;
  const WordKernels& kernels_;
  VoxelSums sums_;
  std::array<AxisView, kTogether + 1> views_;  ///< at the begin of this way and after each of its pieces
  CertificateTree tree_;                       ///< of leaves, nodes, branches
  std::vector<OccupiedLeaf> leaves_;
  std::size_t occupied_ = 0;
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
