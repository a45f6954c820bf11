#include "core/rbf/detail/interaction_lists.h"

#include <algorithm>

#include "core/base/free_memory.h"

namespace spinaltap::detail {
namespace {

using Box = Octree::Box;

std::uint32_t offset_of(const Box& target, const Box& source) {
  std::uint32_t offset = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    offset = 7 * offset + static_cast<std::uint32_t>(target.at[axis] - source.at[axis] + 3);
  }
  return offset;
}

class Maker {
 public:
  Maker(const Octree& tree, const std::vector<bool>& is_target, std::size_t few)
      : boxes_(tree.boxes()), is_target_(is_target), few_(few), colleagues_(boxes_.size()), coarse_(boxes_.size()) {}

  InteractionLists make() {
    colleagues_[0] = {0};
    for (std::uint32_t b = 0; b < boxes_.size(); ++b) {
      if (is_target_[b]) visit(b);
      // A box is visited after its parent and never again.
      free_memory(colleagues_[b], coarse_[b]);
    }
    const std::size_t count = boxes_.size();
    return {{count, far_}, {count, near_}, {count, finer_}, {count, coarser_}};
  }

 private:
  void visit(std::uint32_t b) {
    if (boxes_[b].is_leaf()) {
      near_boxes_.clear();
      for (const std::uint32_t c : coarse_[b]) add_near(c);
      for (const std::uint32_t c : colleagues_[b]) descend(b, c);
      join_near(b);
      return;
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const std::uint32_t child = boxes_[b].first_child + octant;
      if (is_target_[child]) hand_down(b, child);
    }
  }

  void hand_down(std::uint32_t b, std::uint32_t child) {
    for (const std::uint32_t c : colleagues_[b]) {
      if (boxes_[c].is_leaf()) {
        hand_down_leaf(c, child);
        continue;
      }
      for (std::uint32_t s = boxes_[c].first_child; s < boxes_[c].first_child + 8; ++s) {
        if (boxes_[s].count() == 0) continue;
        if (are_adjacent(boxes_[s], boxes_[child])) {
          colleagues_[child].push_back(s);
        } else {
          far_.push_back({child, {s, offset_of(boxes_[child], boxes_[s])}});
        }
      }
    }
    for (const std::uint32_t c : coarse_[b]) hand_down_leaf(c, child);
  }

  void hand_down_leaf(std::uint32_t leaf, std::uint32_t child) {
    if (boxes_[leaf].count() == 0) return;
    // Summing at the nodes of a box with few points of its own costs more than summing at the points.
    if (are_adjacent(boxes_[leaf], boxes_[child]) || boxes_[child].count() < few_) {
      coarse_[child].push_back(leaf);
    } else {
      coarser_.push_back({child, leaf});
    }
  }

  void add_near(std::uint32_t box) {
    if (boxes_[box].count() > 0) near_boxes_.push_back({boxes_[box].begin, boxes_[box].end});
  }

  /// The parts of a colleague of leaf b that are adjacent to it act directly, the others through their expansions.
  void descend(std::uint32_t b, std::uint32_t c) {
    if (boxes_[c].is_leaf()) return add_near(c);
    for (std::uint32_t s = boxes_[c].first_child; s < boxes_[c].first_child + 8; ++s) {
      if (boxes_[s].count() == 0) continue;
      if (are_adjacent(boxes_[s], boxes_[b])) {
        descend(b, s);
      } else if (boxes_[s].count() < few_) {
        add_near(s);
      } else {
        finer_.push_back({b, s});
      }
    }
  }

  void join_near(std::uint32_t b) {
    std::sort(near_boxes_.begin(), near_boxes_.end(),
              [](const SourceRange& p, const SourceRange& q) { return p.begin < q.begin; });
    for (std::size_t i = 0; i < near_boxes_.size();) {
      SourceRange range = near_boxes_[i];
      for (++i; i < near_boxes_.size() && near_boxes_[i].begin == range.end; ++i) range.end = near_boxes_[i].end;
      near_.push_back({b, range});
    }
  }

  const std::vector<Box>& boxes_;
  const std::vector<bool>& is_target_;
  std::size_t few_;
  std::vector<std::vector<std::uint32_t>> colleagues_;  ///< same level, adjacent, with sources
  std::vector<std::vector<std::uint32_t>> coarse_;  ///< leaves of coarser levels with sources, to be summed directly
  std::vector<SourceRange> near_boxes_;
  std::vector<std::pair<std::uint32_t, FarBox>> far_;
  std::vector<std::pair<std::uint32_t, SourceRange>> near_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> finer_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> coarser_;
};

}  // namespace

InteractionLists make_lists(const Octree& tree, const std::vector<bool>& is_target, std::size_t few) {
  return Maker(tree, is_target, few).make();
}

}  // namespace spinaltap::detail
