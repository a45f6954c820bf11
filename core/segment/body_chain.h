#pragma once

#include <vector>

#include "core/segment/spine_column.h"

namespace spinaltap {

/// One end of a vertebral body: the plane of an endplate, or of the CT's border.
struct BodyEnd {
  double s_mm = 0.0;              ///< along the column
  Vec3 centre_mm = Vec3::Zero();  ///< on the plane, patient LPS
  Vec3 up = Vec3::UnitZ();        ///< unit, the plane's normal, upward for both ends
  double edge = 0.0;              ///< how much of an endplate is there, 0 to 1; 0 where is_cut
  /// No endplate: the CT, or what is known of the column, ends before it. Its place is a guess from the next body's
  /// height.
  bool is_cut = false;
};

/// A body between its endplates.
struct BodySpan {
  BodyEnd lower, upper;
  ColumnSection middle;
  double gain = 0.0;  ///< what the chain has by this body, in endplates: about 2 and more for a clear one

  double height_mm() const { return upper.s_mm - lower.s_mm; }
  /// One end or both are cut: it is not whole.
  bool is_cut() const { return lower.is_cut || upper.is_cut; }
};

/// All bodies of a column from below upward, found together: a row of bodies and gaps along the column for which most
/// speaks. An endplate is a fall of the CT number from the body outward, in the mean over a disc across the column that
/// may be tilted by 25 degrees. Bodies have walls at their sides, gaps have none, and are darker than the endplates
/// beside them. Heights go with the column's depth (Panjabi 1991, 1992; Gilad & Nissan 1986) and change little from one
/// body to the next. The best row is found exactly by dynamic programming over all places of all endplates (a hidden
/// semi-Markov model, Rabiner 1989), 0.5 mm apart. `hu` is as scanned, or blurred as its noise asks for.
std::vector<BodySpan> find_body_chain(const FloatGrid& hu, const SpineColumn& column, const WallLevels& levels);

}  // namespace spinaltap
