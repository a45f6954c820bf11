#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "vdb/engine/detail/move_certificates.h"
#include "vdb/engine/detail/tool_bounds.h"

namespace spinaltap::detail {

/// Boxes within boxes of occupied bone, as the nodes of a VDB tree have them: a step goes down to those that the tool
/// may have reached since they were last looked at, past all others by the certificates of what they lie in (see
/// MoveCertificates). A box without occupied bone is dropped, and its parent's last takes its place.
class CertificateTree {
 public:
  /// The boxes of one level, all of one size, in the order of the level above.
  struct Level {
    std::vector<Vec3> centres_mm;
    double half_mm = 0.0;                     ///< of a box's diagonal: its points lie so near to its centre
    std::vector<std::uint32_t> begin, count;  ///< of a box's children on the level below; the lowest has none

    void add_children(std::size_t first, std::size_t last) {
      begin.push_back(static_cast<std::uint32_t>(first));
      count.push_back(static_cast<std::uint32_t>(last - first));
    }
  };

  CertificateTree() = default;
  /// From the lowest level up. No certificate holds yet.
  explicit CertificateTree(std::vector<Level> levels);

  /// Begins a step: boxes of the lowest level that must be looked at, in order. Each is then to be certified anew, or
  /// said to be empty; different ones by different threads.
  std::span<const std::uint32_t> due(const SweptBounds& tool) noexcept;
  void certify(std::size_t box, const FreeMove& free) noexcept;
  void set_empty(std::size_t box) noexcept { levels_.front().left_mm[box] = kEmptyMm; }
  /// Ends it. `move(from, to)`: whatever stands for box `from` of the lowest level is to take the place of `to`, which
  /// is empty; both are the same where that was its parent's last.
  template <class Move>
  void finish(const Move& move) noexcept {
    for (std::size_t number = 1; number < levels_.size(); ++number) {
      Boxes& level = levels_[number];
      Boxes& below = levels_[number - 1];
      // From the last, so that what moves into a dropped one's place has been finished.
      for (std::size_t n = level.due_count; n-- > 0;) {
        const std::size_t parent = level.due[n];
        const std::size_t first = level.begin[parent];
        FreeMove free = together(below, first, level.count[parent]);
        if (free.free_mm <= static_cast<double>(kEmptyMm)) {
          for (std::size_t child = first; child < first + level.count[parent];) {
            if (below.left_mm[child] > kEmptyMm) {
              ++child;
              continue;
            }
            const std::size_t last = first + --level.count[parent];
            if (number == 1) move(last, child);
            below.move(last, child);
          }
          free = together(below, first, level.count[parent]);
        }
        renew(level, parent, free);
      }
    }
    Boxes& top = levels_.back();
    for (std::size_t n = top.due_count; n-- > 0;) {
      if (top.left_mm[top.due[n]] <= kEmptyMm) top.move(--top_count_, top.due[n]);
    }
  }

  Vec3 centre_mm(std::size_t box) const { return levels_.front().certificates.centre_mm(box); }
  double half_mm() const { return levels_.front().certificates.half_mm(); }
  /// Boxes of the highest level that hold something occupied.
  std::size_t top_count() const { return top_count_; }
  std::size_t memory_bytes() const;

 private:
  static constexpr float kUnknownMm = -1e30F;
  static constexpr float kEmptyMm = -1e35F;

  struct Boxes {
    MoveCertificates certificates;
    std::vector<float> left_mm;               ///< of certificates, where they were checked in this step
    std::vector<std::uint8_t> is_stale;       ///< left_mm of the children are of an earlier step
    std::vector<std::uint32_t> begin, count;  ///< children, on the level below
    std::vector<std::uint32_t> due;           ///< in this step
    std::size_t due_count = 0;

    void move(std::size_t from, std::size_t to) noexcept;
  };

  void list_due(std::size_t number, std::size_t begin, std::size_t end, const SweptBounds& tool) noexcept;
  void list_failed(std::size_t number, std::size_t begin, std::size_t end, const SweptBounds& tool) noexcept;
  static FreeMove together(const Boxes& level, std::size_t begin, std::size_t count) noexcept;
  static void renew(Boxes& level, std::size_t box, const FreeMove& of_children) noexcept;

  std::vector<Boxes> levels_;
  std::size_t top_count_ = 0;
};

}  // namespace spinaltap::detail
