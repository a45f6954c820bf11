#pragma once

#include <cmath>
#include <vector>

#include "core/grading/instrument.h"
#include "core/tool/bit_profile.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// A part of an instrument as a body of revolution about its path.
struct InstrumentBody {
  InstrumentPart part;
  BitProfile profile;
  double tip_mm;  ///< where along the path its tip is

  bool contains(double along_mm, double off_axis_squared_mm2) const {
    return profile.contains(tip_mm - along_mm, off_axis_squared_mm2);
  }
  /// Signed, to its surface.
  double distance_mm(double along_mm, double off_axis_mm) const {
    return profile.distance_mm(tip_mm - along_mm, off_axis_mm);
  }
};

/// What lies behind the entry: the way in, which begins `opening_mm` behind it, and the head and the driver of a path
/// with a screw.
std::vector<InstrumentBody> instrument_bodies(const DrillPath& path, double opening_mm);
/// The path's screw, which it must have.
InstrumentBody screw_body(const DrillPath& path);
/// That screw's head.
InstrumentBody screw_head(const DrillPath& path);

/// A path as a straight line. Behind its entry a curved one is straight as well.
class PathLine {
 public:
  explicit PathLine(const DrillPath& path);
  double along_mm(const Vec3& p_mm) const { return (p_mm - entry_mm_).dot(direction_); }
  double off_squared_mm2(const Vec3& p_mm, double along_mm) const {
    return (p_mm - entry_mm_ - along_mm * direction_).squaredNorm();
  }
  double off_mm(const Vec3& p_mm, double along_mm) const { return std::sqrt(off_squared_mm2(p_mm, along_mm)); }
  double distance_mm(const InstrumentBody& body, const Vec3& p_mm) const {
    const double along = along_mm(p_mm);
    return body.distance_mm(along, off_mm(p_mm, along));
  }
  const Vec3& direction() const { return direction_; }

 private:
  Vec3 entry_mm_, direction_;
};

}  // namespace spinaltap
