#pragma once

#include "core/force/detail/contact_stiffness_sum.h"
#include "core/points/occupied_bone.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// The wall of its hole, which holds a turning drill that is pushed sideways. The lands behind a drill's lips do not
/// cut sideways as lips do: they press on the wall, by its stiffness (Material::contact_n_mm), and ream what they press
/// on away within a turn. So a push is held at once and gives way slowly: a spring and a damper in a row (Maxwell). Of
/// burrs and other tools that cut with their sides there is none.
class WallSupport {
 public:
  WallSupport(const OccupiedBone& bone, const DrillBit& bit);

  void reset() noexcept { pressed_mm_.setZero(), turned_.setZero(); }
  /// Force on the drill, N, after a cycle in which its tip went by `moved_mm` and its axis changed by `turned`, `turns`
  /// of its own long; all in the bone's coordinates. `stiffness`, where it is given, has the wall's part added to it,
  /// also of a wall that is not pressed.
  Vec3 force_n(const Pose& pose, const Vec3& moved_mm, const Vec3& turned, double turns,
               ContactStiffnessSum* stiffness = nullptr) noexcept;

 private:
  const OccupiedBone* bone_;
  bool has_lands_;
  double radius_mm_, section_mm2_;
  double begin_mm_, end_mm_;        ///< of the lands, behind the tip
  Vec3 pressed_mm_ = Vec3::Zero();  ///< how far the tip is pressed aside and not yet reamed, mm
  Vec3 turned_ = Vec3::Zero();      ///< and how far the axis is turned
};

}  // namespace spinaltap
