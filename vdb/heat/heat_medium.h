#pragma once

#include <span>

#include "core/ct/hu_to_density.h"
#include "core/heat/thermal_bone.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// What heat flows through: a tissue at each place. Safe to ask from many threads at once.
class HeatMedium {
 public:
  virtual ~HeatMedium() = default;
  /// At positions (patient LPS, mm); both spans have one length. A tissue of no conductivity is air: it takes no heat.
  virtual void tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const = 0;
};

/// A baked bone: within its surface by density, outside air.
class BoneMedium final : public HeatMedium {
 public:
  BoneMedium(BoneModel bone, const HuToDensity& density, const ThermalBone& thermal);
  void tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const override;

 private:
  BoneModel bone_;
  HuToDensity density_;
  ThermalBone thermal_;
};

}  // namespace spinaltap
