#pragma once

#include <optional>
#include <vector>

#include "core/plan/suggest.h"

namespace spinaltap::detail {

/// Where a straight way crosses a pedicle's isthmus and how it is turned from the pedicle's axis.
struct Way {
  double across_mm = 0.0;  ///< along the pedicle's width, from its centre
  double up_mm = 0.0;      ///< along its height
  double turn_deg = 0.0;   ///< towards the width's axis
  double rise_deg = 0.0;   ///< towards the height's
};

/// A way with the best screw for it.
struct ScrewedWay {
  Way way;
  DrillPath path;
  double score = 0.0;
};

/// Looks for ways through one pedicle.
class WaySearch {
 public:
  /// `side`: 1 for the patient's left, -1 for the right. Keeps references.
  WaySearch(const WallDistance& walls, const HuSampler& hu, std::span<const PedicleScrew> screws,
            const SuggestOptions& options, double side);

  /// The best ways that keep the margins, best first, not neighbours of each other.
  std::vector<ScrewedWay> find(std::size_t most, const Progress& progress);

  std::size_t ways_looked_at() const { return looked_at_; }
  const PedicleLandmarks& pedicle() const { return pedicle_; }

 private:
  std::optional<ScrewedWay> with_screw(const Way& way) const;
  /// `pedicle_depth_mm`: how deep the path's axis lies below the surface, at least, on its way through the pedicle.
  double score(const DrillPath& path, double pedicle_depth_mm) const;
  /// Counts in `looked_at` the ways it tries.
  ScrewedWay refined(ScrewedWay best, std::size_t& looked_at) const;

  const WallDistance& walls_;
  const HuSampler& hu_;
  std::span<const PedicleScrew> screws_;
  const SuggestOptions& options_;
  double side_;
  const PedicleLandmarks& pedicle_;
  std::size_t looked_at_ = 0;
};

}  // namespace spinaltap::detail
