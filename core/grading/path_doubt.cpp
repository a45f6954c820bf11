#include "core/grading/path_doubt.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/anatomy/point_tree.h"
#include "core/base/text_writer.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kDoubtStepMm = 0.25;

double tool_radius_mm(const DrillPath& path) { return path.screw ? path.screw->radius_mm() : path.bit.radius_mm(); }

/// Calls `look` with the depth, place and direction of the middle of each step, and the step's length.
template <class Look>
void walk(const PathCurve& curve, const Look& look) {
  const int steps = std::max(1, static_cast<int>(std::ceil(curve.length_mm() / kDoubtStepMm)));
  const double step_mm = curve.length_mm() / steps;
  for (int n = 0; n < steps; ++n) {
    const double depth_mm = (n + 0.5) * step_mm;
    look(depth_mm, curve.at_mm(depth_mm), curve.direction_at(depth_mm), step_mm);
  }
}

void add_length(double depth_mm, const Vec3& p_mm, double step_mm, PathDoubt& doubt) {
  if (doubt.length_mm == 0.0) {
    doubt.depth_mm = depth_mm;
    doubt.place_mm = p_mm;
  }
  doubt.length_mm += step_mm;
}

PathDoubt of_made_up(const MadeUpSlices& made_up, const PathCurve& curve, double radius_mm) {
  PathDoubt doubt;
  walk(curve, [&](double depth_mm, const Vec3& p_mm, const Vec3& direction, double step_mm) {
    // A section reaches as far along the slices' normal as it leans.
    const double along = made_up.normal.dot(direction);
    const double reach_mm = radius_mm * std::sqrt(std::max(0.0, 1.0 - along * along));
    if (made_up.holds(p_mm, reach_mm)) add_length(depth_mm, p_mm, step_mm, doubt);
  });
  return doubt;
}

PathDoubt of_unsure(const std::vector<Vec3>& unsure_mm, const PathCurve& curve, double radius_mm) {
  // The places stand for voxels of the segmentation's work, thinned out: bone within this is as unsure.
  constexpr double kStandsForMm = 1.0;
  // Beside ribs and joints bone is unsure on every vertebra: it counts where the tool would stand out by more than
  // this.
  constexpr double kWorthMm = 1.0;
  PathDoubt doubt{.kind = PathDoubt::Kind::unsure_bone, .without_mm = std::numeric_limits<double>::infinity()};
  const PointTree tree(unsure_mm);
  walk(curve, [&](double depth_mm, const Vec3& p_mm, const Vec3&, double step_mm) {
    const double left_mm = tree.nearest(p_mm).distance_mm - radius_mm - kStandsForMm;
    if (!(left_mm < 0.0)) return;
    add_length(depth_mm, p_mm, step_mm, doubt);
    doubt.without_mm = std::min(doubt.without_mm, left_mm);
  });
  return doubt.without_mm < -kWorthMm ? doubt : PathDoubt{};
}

}  // namespace

std::string in_words(const PathDoubt& doubt) {
  const std::string length = fixed_text(doubt.length_mm, 1) + " mm of it ";
  if (doubt.kind == PathDoubt::Kind::made_up_slices) return length + "lie in slices that were made up";
  return length + "run in bone that may be another's";
}

std::vector<PathDoubt> path_doubts(const DoubtfulBone& bone, const DrillPath& path) {
  check_path(path);
  std::vector<PathDoubt> doubts;
  const PathCurve curve(path);
  const double radius_mm = tool_radius_mm(path);
  if (bone.made_up) doubts.push_back(of_made_up(*bone.made_up, curve, radius_mm));
  if (!bone.unsure_mm.empty()) doubts.push_back(of_unsure(bone.unsure_mm, curve, radius_mm));
  std::erase_if(doubts, [](const PathDoubt& doubt) { return !(doubt.length_mm > 0.0); });
  return doubts;
}

}  // namespace spinaltap
