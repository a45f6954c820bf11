#pragma once

#include <vector>

#include "core/segment/body_cylinder.h"
#include "core/segment/spinal_canal.h"

namespace spinaltap {

/// The column of vertebral bodies at one height, as an ellipse across it.
struct ColumnSection {
  Vec3 centre_mm = Vec3::Zero();  ///< of the ellipse, patient LPS
  Mat3 axes = Mat3::Identity();   ///< columns: the column's own left, back and up
  double half_width_mm = 0.0;
  double half_depth_mm = 0.0;
  double wall = 0.0;  ///< share of a full wall on the ellipse but for its back corners, as WallProbe::edge() has it
};

/// The column of vertebral bodies from below upward.
struct SpineColumn {
  /// One each kStepMm along the canal, the lowest first, and some beyond its ends; the outermost may lie outside the
  /// CT.
  std::vector<ColumnSection> sections;
  static constexpr double kStepMm = 2.0;

  double length_mm() const { return sections.empty() ? 0.0 : kStepMm * static_cast<double>(sections.size() - 1); }
  /// The section `s_mm` along the column, between the two next to it; the end ones beyond the ends.
  ColumnSection at(double s_mm) const;
};

/// The CT around a canal that holds all of the bodies in front of it, binned to about 0.8 mm.
FloatGrid hu_around_canal(const CtVolume& ct, const SpinalCanal& canal);

/// Finds the ellipses in front of the canal that have the most wall: of many sizes, distances and turns about the canal
/// at each height the best row is chosen by dynamic programming, in which size and place change little from one to the
/// next. Where discs have no wall the bodies above and below say how wide the column is. `smooth` should be blurred by
/// about a millimetre.
SpineColumn fit_spine_column(const FloatGrid& smooth, const SpinalCanal& canal, const WallLevels& levels);

/// The column through bodies that are known, from below upward: a curve through their middles along their axes, as wide
/// between them as they are, and `beyond_mm` further at either end, bent as between the last two. Throws Error for
/// fewer than two bodies.
SpineColumn column_through(const std::vector<BodyCylinder>& bodies, double beyond_mm, const WallProbe& probe);

}  // namespace spinaltap
