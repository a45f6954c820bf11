#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/rbf/detail/octree.h"

namespace spinaltap::detail {

/// Lists of boxes, one for each box, stored one after the other.
template <class Entry>
class Lists {
 public:
  /// Entry (box, item) pairs in any order; each box keeps its items in the order given.
  Lists() = default;
  Lists(std::size_t boxes, const std::vector<std::pair<std::uint32_t, Entry>>& entries) : start_(boxes + 1, 0) {
    for (const auto& [box, item] : entries) ++start_[box + 1];
    for (std::size_t b = 0; b < boxes; ++b) start_[b + 1] += start_[b];
    items_.resize(entries.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const auto& [box, item] : entries) items_[next[box]++] = item;
  }
  const Entry* begin(std::uint32_t box) const { return items_.data() + start_[box]; }
  const Entry* end(std::uint32_t box) const { return items_.data() + start_[box + 1]; }
  std::size_t count(std::uint32_t box) const { return start_[box + 1] - start_[box]; }

 private:
  std::vector<std::size_t> start_;
  std::vector<Entry> items_;
};

/// Sources [begin, end) of the sorted order.
struct SourceRange {
  std::uint32_t begin;
  std::uint32_t end;
};

/// A box of the same level, not adjacent, and its direction from the target box, -3..3 along each axis.
struct FarBox {
  std::uint32_t box;
  std::uint32_t offset;  ///< (dx + 3) + 7 (dy + 3) + 49 (dz + 3), d = target - source
};
inline constexpr std::uint32_t kOffsets = 343;

/// Which boxes act on which, and how (the lists U, V, W and X of Cheng, Greengard & Rokhlin 1999). Every source acts on
/// every place of a leaf exactly once, through one of them, at the leaf or at one of its ancestors.
struct InteractionLists {
  Lists<FarBox> far;             ///< V: same level, expansion to expansion
  Lists<SourceRange> near;       ///< U: of leaves, source to target; neighbouring ranges are joined
  Lists<std::uint32_t> finer;    ///< W: of leaves, boxes whose expansion is evaluated at the targets
  Lists<std::uint32_t> coarser;  ///< X: leaves whose sources are summed at the box's nodes
};

/// Lists for the boxes where `is_target`. A finer box with fewer sources than `few` is summed directly.
InteractionLists make_lists(const Octree& tree, const std::vector<bool>& is_target, std::size_t few);

}  // namespace spinaltap::detail
