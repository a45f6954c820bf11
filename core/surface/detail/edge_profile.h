#pragma once

#include <array>
#include <optional>

#include "core/segment/float_grid.h"

namespace spinaltap {

/// What blurs a bone's edge in a CT, and how dense its cortex would be without the blur.
struct EdgeModel {
  double blur_in_slice_mm = 0.5;  ///< standard deviation along i and j
  double blur_across_mm = 0.5;    ///< standard deviation along k
  double cortex_hu = 1200.0;

  /// Standard deviation along a unit vector in patient LPS, for a grid of these axes.
  double blur_mm(const Vec3& direction, const GridGeometry& geometry) const;
};

/// CT numbers along a surface point's normal, inside first.
struct EdgeProfile {
  static constexpr int kInside = 20;   ///< samples further in than the point
  static constexpr int kOutside = 14;  ///< samples further out
  static constexpr int kCount = kInside + 1 + kOutside;

  std::array<double, kCount> hu{};
  double step_mm = 0.15;
  Vec3 normal = Vec3::UnitX();

  double way_mm(int i) const { return (i - kInside) * step_mm; }
};

/// Samples tri-linearly; beyond the grid, its border's values.
EdgeProfile sample_profile(const FloatGrid& hu, const Vec3& p_mm, const Vec3& normal, double step_mm);

/// A bone's outer edge along a profile.
struct EdgeFit {
  double offset_mm = 0.0;     ///< of the edge from the point, outward positive
  double thickness_mm = 0.0;  ///< of the cortex; 0 where none stands out
  double inside_hu = 0.0;
  double outside_hu = 0.0;
  double rms_hu = 0.0;  ///< what the model leaves of the profile
};

/// Fits a blurred three-layer edge (cancellous bone, cortex of known density, tissue outside) to a profile by damped
/// least squares. A thin cortex's half-maximum lies outside its true edge, by up to half the blur; this edge does not.
/// Source: Treece, Gee, Mayhew & Poole 2010, "High resolution cortical bone thickness measurement from clinical CT
/// data" (their equation 3); blur and density, which they hold fixed, come from estimate_edge_model(). Where an edge
/// without a cortex describes the profile nearly as well, that one is taken. Nothing when the profile shows no edge
/// within `reach_mm`, or one that the model does not describe.
std::optional<EdgeFit> fit_edge(const EdgeProfile& profile, const EdgeModel& model, const GridGeometry& geometry,
                                double reach_mm);

}  // namespace spinaltap
