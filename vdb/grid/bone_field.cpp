#include "vdb/grid/bone_field.h"

#include "vdb/detail/bone_samplers.h"

namespace spinaltap {

void BoneField::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                         std::span<Vec3> gradients) const {
  bone_.samplers().distance.quadratic(points_mm, values_mm, gradients);
}

}  // namespace spinaltap
