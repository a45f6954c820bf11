#include "core/anatomy/vertebra_parts.h"

#include <cmath>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"

namespace spinaltap {
namespace {

std::size_t side_of(const Vec3& own_mm) { return own_mm.x() >= 0.0 ? 0 : 1; }

const PedicleLandmarks& pedicle_of(const Landmarks& landmarks, std::size_t side) {
  return side == 0 ? landmarks.left_pedicle : landmarks.right_pedicle;
}

}  // namespace

VertebraParts::VertebraParts(const BoneShape& bone, const Landmarks& landmarks) : landmarks_(landmarks) {
  // The tip is the highest place behind the pedicle, not as far out as the transverse process.
  constexpr double kBesideMm = 4.0;
  for (const Vec3& p_mm : bone.points_mm()) {
    const Vec3 own_mm = landmarks.to_own(p_mm);
    const std::size_t side = side_of(own_mm);
    const PedicleLandmarks& pedicle = pedicle_of(landmarks, side);
    const Vec3 isthmus_mm = landmarks.to_own(pedicle.isthmus_mm);
    if (own_mm.y() < isthmus_mm.y() + 2.0 || own_mm.z() < isthmus_mm.z() + 0.5 * pedicle.height_mm) continue;
    const double out_mm = std::abs(own_mm.x());
    const double isthmus_out_mm = std::abs(isthmus_mm.x());
    if (out_mm > isthmus_out_mm + 0.5 * pedicle.width_mm + kBesideMm || out_mm < 0.5 * isthmus_out_mm) continue;
    if (has_tip_[side] && own_mm.z() <= tips_mm_[side].z()) continue;
    has_tip_[side] = true;
    tips_mm_[side] = own_mm;
  }
}

bool VertebraParts::is_joint(const Vec3& p_mm, const Vec3& normal) const {
  constexpr double kFacing = 0.5;  // cosine of 60 degrees
  const Vec3 own_mm = landmarks_.to_own(p_mm);
  const std::size_t side = side_of(own_mm);
  if (!has_tip_[side] || (own_mm - tips_mm_[side]).norm() > kJointMm) return false;
  const PedicleLandmarks& pedicle = pedicle_of(landmarks_, side);
  const Vec3 isthmus_mm = landmarks_.to_own(pedicle.isthmus_mm);
  if (own_mm.z() < isthmus_mm.z() + 0.1 * pedicle.height_mm || own_mm.y() < isthmus_mm.y()) return false;
  const Vec3 own = landmarks_.axes.transpose() * normal;
  const double medial = side == 0 ? -own.x() : own.x();
  return own.y() > kFacing || (own.y() > 0.0 && medial > kFacing);
}

VertebraPart VertebraParts::at(const Vec3& p_mm, const Vec3& normal) const {
  constexpr double kAroundMm = 1.5, kBehindMm = 5.0;        // of a pedicle's section and its length
  constexpr double kSpinousMm = 4.0, kBehindCanalMm = 5.0;  // half its thickness, and where it leaves the lamina
  const Vec3 own_mm = landmarks_.to_own(p_mm);
  const std::size_t side = side_of(own_mm);
  const PedicleLandmarks& pedicle = pedicle_of(landmarks_, side);
  const Landmarks::Body& body = landmarks_.body;
  if (own_mm.y() < landmarks_.to_own(body.centre_mm).y() + 0.5 * body.depth_mm) return VertebraPart::body;
  const Vec3 from_mm = p_mm - pedicle.isthmus_mm;
  if (std::abs(from_mm.dot(pedicle.width_axis)) < 0.5 * pedicle.width_mm + kAroundMm &&
      std::abs(from_mm.dot(pedicle.height_axis)) < 0.5 * pedicle.height_mm + kAroundMm &&
      from_mm.dot(pedicle.axis) > -kBehindMm) {
    return VertebraPart::pedicle;
  }
  if (is_joint(p_mm, normal)) return VertebraPart::superior_joint;
  const Vec3 isthmus_mm = landmarks_.to_own(pedicle.isthmus_mm);
  const double out_mm = std::abs(own_mm.x());
  if (out_mm < kSpinousMm && own_mm.y() > 0.5 * landmarks_.canal.depth_mm + kBehindCanalMm) {
    return VertebraPart::spinous_process;
  }
  const double pedicle_out_mm = std::abs(isthmus_mm.x()) + 0.5 * pedicle.width_mm;
  if (out_mm > pedicle_out_mm + 4.0) return VertebraPart::transverse_process;
  if (own_mm.z() > isthmus_mm.z() + 0.5 * pedicle.height_mm - 1.0 && out_mm > 0.5 * std::abs(isthmus_mm.x())) {
    return VertebraPart::superior_articular_process;
  }
  if (own_mm.z() < isthmus_mm.z() - 0.5 * pedicle.height_mm - 4.0 && out_mm > kSpinousMm) {
    return VertebraPart::inferior_articular_process;
  }
  return VertebraPart::lamina;
}

}  // namespace spinaltap
