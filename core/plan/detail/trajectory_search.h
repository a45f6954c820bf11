#pragma once

#include <optional>
#include <vector>

#include "core/plan/suggest.h"

namespace spinaltap::detail {

/// Where a straight trajectory crosses a pedicle's isthmus and how it is turned from the pedicle's axis.
struct Trajectory {
  double across_mm = 0.0;  ///< along the pedicle's width, from its centre
  double up_mm = 0.0;      ///< along its height
  double turn_deg = 0.0;   ///< towards the width's axis
  double rise_deg = 0.0;   ///< towards the height's
};

/// A trajectory with the best screw for it.
struct ScrewCandidate {
  Trajectory trajectory;
  DrillPath path;
  double score = 0.0;
};

/// Looks for trajectories through one pedicle.
class TrajectorySearch {
 public:
  /// `side`: 1 for the patient's left, -1 for the right. Keeps references.
  TrajectorySearch(const WallDistance& walls, const HuSampler& hu, std::span<const PedicleScrew> screws,
                   const SuggestOptions& options, double side);

  /// The best trajectories that keep the margins, best first, not neighbours of each other.
  std::vector<ScrewCandidate> find(std::size_t max, const Progress& progress);

  std::size_t trajectories_tried() const { return looked_at_; }
  const PedicleLandmarks& pedicle() const { return pedicle_; }

 private:
  std::optional<ScrewCandidate> with_screw(const Trajectory& trajectory) const;
  /// `pedicle_depth_mm`: how deep the path's axis lies below the surface, at least, on its way through the pedicle.
  double score(const DrillPath& path, double pedicle_depth_mm) const;
  /// Counts in `looked_at` the trajectories it tries.
  ScrewCandidate refined(ScrewCandidate best, std::size_t& looked_at) const;

  const WallDistance& walls_;
  const HuSampler& hu_;
  std::span<const PedicleScrew> screws_;
  const SuggestOptions& options_;
  double side_;
  const PedicleLandmarks& pedicle_;
  std::size_t looked_at_ = 0;
};

}  // namespace spinaltap::detail
