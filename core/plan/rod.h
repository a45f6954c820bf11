#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/plan/suggest.h"

namespace spinaltap {

/// A screw's head as a rod meets it.
struct RodHead {
  std::string level;              ///< "T11"; for people
  Vec3 centre_mm = Vec3::Zero();  ///< of the tulip, patient LPS
  Vec3 axis = Vec3::UnitY();      ///< unit, out of the bone
};

/// Where the head of a path's screw is. Throws Error for a path without a screw that has a head.
RodHead rod_head(const DrillPath& path, const std::string& level);

/// How a rod lies in the heads of one side, from the head down.
struct RodFit {
  std::vector<double> offset_mm;  ///< of each head from the rod, sideways and in depth together
  std::vector<double>
      spacing_mm;  ///< from each head to the next, along the straight line; one less than there are heads
  std::vector<double> angle_deg;  ///< between the axes of neighbouring heads; likewise
  /// Radius to which the rod is bent where it bends most; infinite for a straight one.
  double min_bend_radius_mm = 0.0;
  double max_offset_mm() const;
};

/// Lays a rod: a line through two heads, for more the smoothest curve of second order along them that is nearest to all
/// (least squares), sideways and in depth each. Throws Error on fewer than two heads or on heads at one height.
RodFit fit_rod(std::span<const RodHead> heads);

/// One level's choices for one side: the best path and the next best.
struct RodLevel {
  std::string level;
  std::vector<const SuggestedPath*> choices;  ///< best first, not empty
};

/// Of each level the choice with which the heads lie in line: the sum of scores, less `weight` for each millimetre that
/// a head is off the line through its neighbours', is largest. Exact, by dynamic programming over pairs of neighbours.
/// Throws Error on a level without a choice.
std::vector<std::size_t> choose_for_rod(std::span<const RodLevel> levels, double weight = 0.1);

}  // namespace spinaltap
