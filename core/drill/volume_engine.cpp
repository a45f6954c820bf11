#include "core/drill/volume_engine.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {

VolumeEngine::VolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
    : volume_(volume),
      profile_(bit),
      grown_(profile_.grown(SweptBit::kSkinMm)),
      pressure_(material, volume.hu_range().first, volume.hu_range().second) {}

StepResult VolumeEngine::step(const Pose& pose) noexcept {
  constexpr double kFarthestMm = 1e4;
  StepResult result;
  Pose target = volume_.frame().to_path(pose);
  const double axis_length = target.axis.norm();
  const bool is_near = target.tip_mm.allFinite() && target.tip_mm.cwiseAbs().maxCoeff() <= kFarthestMm;
  if (!is_near || !(std::abs(axis_length - 1.0) < 1e-6)) return result;
  target.axis /= axis_length;
  const Pose start = is_placed_ ? pose_ : target;
  is_placed_ = true;
  pose_ = target;

  Removal removal;
  const BitMotion motion(profile_, start, target);
  for (std::size_t piece = 0; piece < motion.piece_count(); ++piece) {
    remove(SweptBit(profile_, grown_, motion.pose(piece), motion.pose(piece + 1)), removal);
  }
  result.removed = removal.removed;
  result.tested = removal.tested;
  result.removed_hu = removal.hu;
  const DiscPattern& pattern = volume_.pattern();
  const int ring = std::min(1, pattern.ring_count() - 1);
  result.work_n_mm =
      PressureTable::kUnitMpa * (static_cast<double>(removal.pressure[0]) * pattern.point_volume_mm3(0) +
                                 static_cast<double>(removal.pressure[1]) * pattern.point_volume_mm3(ring));
  const double advance_mm = (target.tip_mm - start.tip_mm).dot(target.axis);
  if (advance_mm > 0.0) result.thrust_n = result.work_n_mm / advance_mm;
  return result;
}

std::size_t VolumeEngine::memory_bytes() const { return sizeof(*this) + pressure_.memory_bytes(); }

std::pair<int, int> VolumeEngine::discs_within(const SweptBit& bit) const noexcept {
  // One disc more on each side than the division says: rounding may not cost a disc.
  const double spacing_mm = volume_.pattern().spacing_mm();
  const double discs = volume_.disc_count();
  const double spare_mm = volume_.out_of_plane_mm();
  const double first = std::clamp(std::floor((bit.lowest_z_mm() - spare_mm) / spacing_mm) - 1.0, 0.0, discs);
  const double last = std::clamp(std::ceil((bit.highest_z_mm() + spare_mm) / spacing_mm) + 1.0, -1.0, discs - 1.0);
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace spinaltap
