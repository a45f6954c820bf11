#pragma once

#include <span>

#include "core/base/scalar_field.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A baked bone's distance as a field: tri-quadratic value (mm) and gradient; see BoneModel::distance() for what they
/// are worth near and beyond the edge of the band. Positions that are not numbers are outside.
class BoneField final : public ScalarField {
 public:
  explicit BoneField(BoneModel bone) : bone_(std::move(bone)) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;

 private:
  BoneModel bone_;
};

}  // namespace spinaltap
