#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/engine/detail/disc_kernels.h"
#include "core/points/disc_pattern.h"

namespace spinaltap {

/// For every ring of every disc, a gap of dead points: the places of the living ones at its two ends.
///
/// While the middle of the bit faces the gap, no living point of the ring is nearer to it than the nearer end; so the
/// rings of a whole disc are asked for their nearest living points in a few vector operations. Where it does not face
/// the gap that is known, the ring's circle itself is the bound. Gaps may be noted smaller than they are, never larger.
class RingGaps {
 public:
  RingGaps(std::size_t discs, const DiscPattern& pattern, const detail::DiscKernels& kernels);

  /// Which rings from `begin` up to `end` may have a living point within `reach_mm` of (x, y) in a disc's plane, and
  /// the least distance that living points of the others have, at least (1e15 without any), mm. To float's precision: a
  /// micrometre's hundredth. `is_reached` gets a byte a ring, and some beyond: room for kLongestVector more than rings.
  double min_distance_mm(int disc, int begin, int end, double x_mm, double y_mm, double reach_mm,
                         std::uint8_t* is_reached) const noexcept;

  bool is_dead(int disc, int ring) const noexcept { return ends_[place(disc, ring)] == detail::kDeadRing; }
  void set_dead(int disc, int ring) noexcept { ends_[place(disc, ring)] = detail::kDeadRing; }
  /// Places on the ring, counted as its points are: all after `below` and before `above`, around the ring's end where
  /// need be, are dead.
  void set_gap(int disc, int ring, std::size_t below, std::size_t above) noexcept {
    ends_[place(disc, ring)] = static_cast<detail::GapEnds>(below | above << 16);
  }

  std::size_t memory_bytes() const;

 private:
  std::size_t place(int disc, int ring) const {
    return static_cast<std::size_t>(disc) * rings_ + static_cast<std::size_t>(ring);
  }

  detail::DiscKernels kernels_;
  float spacing_mm_;
  std::size_t rings_;
  std::vector<detail::GapEnds> ends_;  ///< disc by disc
  std::vector<float> x_mm_;            ///< of a disc's points
  std::vector<float> y_mm_;
};

}  // namespace spinaltap
