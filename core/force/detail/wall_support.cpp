#include "core/force/detail/wall_support.h"

#include <cmath>
#include <numbers>

namespace spinaltap {

WallSupport::WallSupport(const OccupiedBone& bone, const DrillBit& bit)
    : bone_(&bone),
      has_lands_(bit.has_flutes()),
      radius_mm_(bit.radius_mm()),
      section_mm2_(std::numbers::pi * bit.radius_mm() * bit.radius_mm()),
      begin_mm_(bit.tip_length_mm),
      end_mm_(bit.length_mm) {}

Vec3 WallSupport::force_n(const Pose& pose, const Vec3& moved_mm, const Vec3& turned, double turns,
                          ContactStiffnessSum* stiffness) noexcept {
  constexpr double kRingMm = 2.0;
  constexpr double kFeltMm = 1e-6;
  if (!has_lands_) return Vec3::Zero();
  const auto across = [&](const Vec3& of) { return Vec3(of - of.dot(pose.axis) * pose.axis); };
  const double left = 1.0 / (1.0 + turns);  // of what was pressed, by the implicit Euler method
  pressed_mm_ = left * across(pressed_mm_ + moved_mm);
  turned_ = left * across(turned_ + turned);
  if (stiffness == nullptr && !(pressed_mm_.norm() + end_mm_ * turned_.norm() > kFeltMm)) return Vec3::Zero();
  const Vec3 u = any_perpendicular(pose.axis), v = pose.axis.cross(u);
  const double spacing_mm = bone_->spacing_mm(pose.tip_mm);
  // Half a ring of wall, each place by how far it is pressed along its own radius: its quarter to both sides.
  const double area = 0.5 * std::numbers::pi * radius_mm_ * kRingMm / section_mm2_;
  Vec3 force_n = Vec3::Zero();
  for (double back_mm = begin_mm_ + 0.5 * kRingMm; back_mm < end_mm_; back_mm += kRingMm) {
    const Vec3 centre_mm = pose.tip_mm - back_mm * pose.axis;
    const Vec3 aside_mm = pressed_mm_ - back_mm * turned_;
    for (const Vec3& direction : {u, v}) {
      const double into_mm = aside_mm.dot(direction);
      const Vec3 out = into_mm < 0.0 ? Vec3(-direction) : direction;
      // The engine has taken what the drill swept: the wall begins just beyond.
      const OccupiedBone::Bone* const wall = bone_->occupied_at(centre_mm + (radius_mm_ + spacing_mm) * out);
      if (wall == nullptr) continue;
      const double stiff_n_mm = area * wall->contact_n_mm;
      force_n -= stiff_n_mm * into_mm * direction;
      if (stiffness != nullptr) stiffness->add(-back_mm * pose.axis, direction, stiff_n_mm, -stiff_n_mm * into_mm);
    }
  }
  return force_n;
}

}  // namespace spinaltap
