#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/anatomy/wall_distance.h"
#include "core/plan/suggest.h"

namespace spinaltap::detail {

/// Where a straight trajectory crosses a pedicle's isthmus and how it is turned from the pedicle's axis.
struct Trajectory {
  double across_mm = 0.0;  ///< along the pedicle's width, from its centre
  double up_mm = 0.0;      ///< along its height
  double turn_deg = 0.0;   ///< towards the width's axis
  double rise_deg = 0.0;   ///< towards the height's
};

/// What a search asks of a trajectory.
struct Attempt {
  Technique technique = Technique::pedicle;
  double margin_mm = 1.0;
  double widest_share = 0.8;
  double least_diameter_mm = 0.0;  ///< of the screw
};

/// What keeps a trajectory from taking a screw, the first that is met.
enum class ScrewLimit { none, pedicle, share, bearing, length, entry, way_in };

/// Why trajectories do not take a screw of one diameter.
struct SearchLimits {
  double diameter_mm = 0.0;
  std::size_t tried = 0;
  std::array<std::size_t, 7> trajectories{};  ///< by ScrewLimit
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

  /// The best trajectories that keep the margins, best first, not neighbours of each other. For in-out-in those that
  /// stand out least at the pedicle's side, by the lattice only.
  std::vector<ScrewCandidate> find(const Attempt& attempt, std::size_t max, const Progress& progress);
  /// Of a found trajectory the best with no screw wider and longer than this one, moved as refining does; none where it
  /// has none.
  std::optional<ScrewCandidate> with_smaller(const ScrewCandidate& found, const Attempt& attempt,
                                             const PedicleScrew& largest);

  /// Of the lattice's trajectories, what keeps each from a screw of this diameter; of those through the pedicle.
  SearchLimits limits(const Attempt& attempt, double diameter_mm) const;

  std::size_t trajectories_tried() const { return looked_at_; }
  const PedicleLandmarks& pedicle() const { return pedicle_; }

 private:
  struct Line;
  std::vector<Trajectory> lattice(const Attempt& attempt) const;
  Line line_of(const Trajectory& trajectory) const;
  std::optional<ScrewCandidate> with_screw(const Trajectory& trajectory, const Attempt& attempt,
                                           const PedicleScrew* largest, ScrewLimit* limit = nullptr) const;
  std::optional<ScrewCandidate> beside_pedicle(const Trajectory& trajectory, const Attempt& attempt) const;
  /// `pedicle_depth_mm`: how deep the path's axis lies below the surface, at least, on its way through the pedicle.
  double score(const DrillPath& path, double pedicle_depth_mm, const Attempt& attempt) const;
  /// Whether a tool's section at its entry meets the joint surface.
  bool is_on_joint(const Vec3& entry_mm, const Vec3& direction, double radius_mm) const;
  double approach(const DrillPath& path) const;
  /// Counts in `looked_at` the trajectories it tries.
  ScrewCandidate refined(ScrewCandidate best, const Attempt& attempt, const PedicleScrew* largest,
                         std::size_t& looked_at) const;

  const WallDistance& walls_;
  const HuSampler& hu_;
  std::span<const PedicleScrew> screws_;
  const SuggestOptions& options_;
  double side_;
  const PedicleLandmarks& pedicle_;
  Vec3 reference_ = -Vec3::UnitY();  ///< direction that a path is wanted to run along
  double reference_rise_deg_ = 0.0;  ///< its turn from the pedicle's axis towards the height's
  std::size_t looked_at_ = 0;
};

}  // namespace spinaltap::detail
