#include "vdb/sim/bone_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

void check_path_meets_bone(const DrillPath& path, const BoneModel& bone) {
  constexpr double kStepMm = 0.1;
  std::vector<Vec3> points_mm = PathCurve(path).places_mm(kStepMm);
  if (!path.is_curved()) {
    const int steps = static_cast<int>(std::ceil(path.length_mm() / kStepMm));
    points_mm.clear();
    for (int i = 0; i <= steps; ++i) {
      points_mm.push_back(path.entry_mm + (path.target_mm - path.entry_mm) * i / steps);
    }
  }
  std::vector<float> distance_mm(points_mm.size());
  bone.sample(points_mm, distance_mm, {});
  if (std::any_of(distance_mm.begin(), distance_mm.end(), [](float value) { return value < 0.0F; })) return;
  const Box3 bounds_mm = bone.bounds_mm();
  const Eigen::IOFormat format(4, Eigen::DontAlignCols, ", ", ", ");
  fail("path ", in_quotes(path.name), " misses the bone: it runs from (", path.entry_mm.transpose().format(format),
       ") to (", path.target_mm.transpose().format(format), "), the bone lies within (",
       bounds_mm.min().transpose().format(format), ") and (", bounds_mm.max().transpose().format(format), ") mm");
}

}  // namespace spinaltap
