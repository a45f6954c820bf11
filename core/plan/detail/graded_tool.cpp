#include "core/plan/detail/graded_tool.h"

#include <algorithm>

namespace spinaltap {
namespace {

BitProfile profile_of(const DrillPath& path) {
  check_path(path);
  return BitProfile(path.screw ? path.screw->outline() : path.bit);
}

}  // namespace

GradedTool::GradedTool(const DrillPath& path)
    : profile_(profile_of(path)),
      entry_mm_(path.entry_mm),
      target_mm_(path.target_mm),
      direction_(path.direction()),
      length_mm_(path.length_mm()) {}

double GradedTool::radius_mm(double depth_mm) const {
  // Whatever has passed a depth has cut it as wide as its widest part: a burr's hole does not narrow to its shank.
  return std::max(0.0, profile_.widest_mm(0.0, length_mm_ - depth_mm));
}

}  // namespace spinaltap
