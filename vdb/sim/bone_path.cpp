#include "vdb/sim/bone_path.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

PathCheckBone as_checked(const BoneModel& bone) {
  return {[bone](std::span<const Vec3> points_mm, std::span<float> distance_mm) {
            bone.sample(points_mm, distance_mm, {});
          },
          bone.band_mm(), bone.bounds_mm()};
}

}  // namespace

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
  const PathCheck check = check_path_on_bone(path, as_checked(bone), {});
  std::string words;
  for (const std::string& fault : check.faults) words += (words.empty() ? "" : "; ") + fault;
  if (!check.likely_cause.empty()) words += "; it fits if " + check.likely_cause;
  fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), " ", words.substr(std::string_view("it ").size()));
}

PathCheck check_path_on_bone(const Bone& bone, const DrillPath& path, const PathCheckOptions& options) {
  const auto checked = [&](const Bone& one) {
    PathCheckBone as = as_checked(one.model());
    as.landmarks = [&one] { return one.no_landmarks().empty() ? &one.landmarks() : nullptr; };
    return check_path_on_bone(path, as, options);
  };
  PathCheck check = checked(bone);
  if (check.fits() || !check.likely_cause.empty()) return check;
  for (const Bone& neighbour : bone.neighbours()) {
    if (checked(neighbour).fits()) check.likely_cause = "it is of " + level_name(neighbour.level());
  }
  return check;
}

}  // namespace spinaltap
