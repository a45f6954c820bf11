#include "core/engine/swept_engine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/points/material.h"

namespace spinaltap {

SweptEngine::SweptEngine(const DrillBit& bit, const PathFrame& frame) : profile_(BitProfile(bit)), frame_(frame) {}

BackParts::BackParts(const Pose& pose, double length_mm, double places_per_mm) noexcept {
  constexpr double kFine = 1024.0;
  for (Eigen::Index n = 0; n < 3; ++n) back[static_cast<std::size_t>(n)] = std::llround(-kFine * pose.axis[n]);
  double tip = 0.0;
  for (Eigen::Index n = 0; n < 3; ++n) {
    tip += static_cast<double>(back[static_cast<std::size_t>(n)]) * pose.tip_mm[n] * places_per_mm;
  }
  begin = std::llround(tip);
  parts = std::max<std::int64_t>(
      1, std::llround(static_cast<double>(StepResult::kBackParts) * 0x1.0p32 / (length_mm * places_per_mm * kFine)));
}

StepResult SweptEngine::step(const Pose& pose) noexcept {
  Pose target = frame_.to_path(pose);
  const double axis_length = target.axis.norm();
  const bool is_near = target.tip_mm.allFinite() && target.tip_mm.cwiseAbs().maxCoeff() <= kEngineReachMm;
  if (!is_near || !(std::abs(axis_length - 1.0) < 1e-6)) return {};
  target.axis /= axis_length;
  const Pose start = is_placed_ ? pose_ : target;
  is_placed_ = true;
  pose_ = target;

  Removal removal;
  if (start.axis != target.axis) removal.back = BackParts(target, profile().length_mm(), units_.places_per_mm);
  const BitMotion motion(profile_, start, target);
  const std::size_t count = motion.piece_count();
  if (count == 1) {  // most steps
    remove(motion.piece(0), removal);
    return result_of(removal, units_, frame_, target.tip_mm);
  }
  for (std::size_t first = 0; first < count; first += kTogether) {
    const auto piece = [&](std::size_t n) { return motion.piece(std::min(first + n, count - 1)); };
    const std::array<SweptBit, kTogether> pieces{piece(0), piece(1), piece(2), piece(3)};
    remove_together(std::span(pieces).first(std::min(kTogether, count - first)), removal);
  }
  return result_of(removal, units_, frame_, target.tip_mm);
}

StepResult result_of(const Removal& removal, const RemovalUnits& units, const PathFrame& frame,
                     const Vec3& tip_mm) noexcept {
  StepResult result;
  result.removed = removal.removed;
  result.tested = removal.tested;
  if (removal.removed == 0) return result;
  result.removed_hu = removal.hu;
  result.removed_mm3 = static_cast<double>(removal.parts) * units.part_mm3;
  const double unit_n_mm = PressureTable::kUnitMpa * units.part_mm3;
  result.work_n_mm = static_cast<double>(removal.pressure) * unit_n_mm;
  Vec3 moment;
  for (int n = 0; n < 3; ++n) {
    moment[n] = static_cast<double>(removal.moment[static_cast<std::size_t>(n)]) * (unit_n_mm / units.places_per_mm);
  }
  for (std::size_t n = 0; n < result.work_back_n_mm.size(); ++n) {
    result.work_back_n_mm[n] = static_cast<double>(removal.pressure_back[n]) * unit_n_mm;
  }
  moment -= result.work_n_mm * tip_mm;
  result.moment_n_mm2 = frame.to_patient(Pose{tip_mm, moment}).axis;
  return result;
}

}  // namespace spinaltap
