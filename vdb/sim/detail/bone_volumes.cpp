#include "vdb/sim/detail/bone_volumes.h"

#include <algorithm>

#include "core/engine/volume_segments.h"

namespace spinaltap {

BoneSampler sampler_of(const BoneModel& bone, const ScalarField* exact) {
  return [&bone, exact](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
    bone.sample(points_mm, distance_mm, hu);
    if (exact == nullptr) return;
    std::vector<double> values_mm(points_mm.size());
    exact->evaluate(points_mm, values_mm, {});
    std::transform(values_mm.begin(), values_mm.end(), distance_mm.begin(),
                   [](double value_mm) { return static_cast<float>(value_mm); });
  };
}

std::vector<PointVolume> volumes_along(const BoneModel& bone, const DrillPath& path, const PointVolumeOptions& options,
                                       const FineSpacing& fine) {
  if (fine.spacing_mm == 0.0) {
    std::vector<PointVolume> one;
    one.emplace_back(path, options);
    return one;
  }
  return make_segments(path,
                       fine_near_surface(path, options.lead_in_mm, sampler_of(bone), fine.near_mm, fine.tip_mm,
                                         fine.spacing_mm, options.spacing_mm),
                       options);
}

}  // namespace spinaltap
