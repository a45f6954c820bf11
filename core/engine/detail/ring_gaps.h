#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/engine/detail/disc_kernels.h"
#include "core/points/disc_pattern.h"

namespace spinaltap {

/// For every ring of every disc, a gap of dead points: the places of the occupied ones at its two ends.
///
/// While the middle of the bit faces the gap, no occupied point of the ring is nearer to it than the nearer end; so the
/// rings of a whole disc are asked for their nearest occupied points in a few vector operations. Where it does not face
/// the gap that is known, the ring's circle itself is the bound. Gaps may be noted smaller than they are, never larger.
class RingGaps {
 public:
  RingGaps(std::size_t discs, const DiscPattern& pattern, const detail::DiscKernels& kernels);

  /// Which ends of rings' gaps, from ring `begin` up to `end`, lie or may lie within `reach_mm` of (x, y) in a disc's
  /// plane, and how far off it the other ends and all occupied points beyond them are, at least (1e15 without any), mm:
  /// as the ellipse counts it. `reached` gets a byte a ring, kReachesBelow and kReachesAbove, and some beyond: room for
  /// kLongestVector more than rings.
  double min_distance_mm(int disc, int begin, int end, double x_mm, double y_mm, double reach_mm,
                         const detail::FloatEllipse& ellipse, std::uint8_t* reached) const noexcept;

  /// Ends of a gap: places on the ring, counted as its points are. All after `below` and before `above`, around the
  /// ring's end where need be, are dead.
  struct Ends {
    std::size_t below = kNowhere;
    std::size_t above = kNowhere;
  };
  static constexpr std::size_t kNowhere = ~std::size_t{0};

  /// The ring's gap where that is known and (x, y) faces it; else nowhere.
  Ends faced_gap(int disc, int ring, double x_mm, double y_mm) const noexcept;

  bool is_dead(int disc, int ring) const noexcept { return ends_[place(disc, ring)] == detail::kDeadRing; }
  void set_dead(int disc, int ring) noexcept { ends_[place(disc, ring)] = detail::kDeadRing; }
  void set_gap(int disc, int ring, std::size_t below, std::size_t above) noexcept;

  std::size_t memory_bytes() const;

 private:
  std::size_t place(int disc, int ring) const {
    return static_cast<std::size_t>(disc) * rings_ + static_cast<std::size_t>(ring);
  }

  std::int16_t units(double mm) const noexcept;

  detail::DiscKernels kernels_;
  const DiscPattern& pattern_;
  double unit_mm_, units_per_mm_;  ///< of where ends lie
  double rounding_mm_;             ///< of distances, and of which end of a gap is nearer
  std::size_t rings_;
  // Disc by disc: gaps, and where their ends lie. To look these up by place would take longer than all else.
  std::vector<detail::GapEnds> ends_;
  std::vector<std::int16_t> below_x_, below_y_, above_x_, above_y_;
};

}  // namespace spinaltap
