#include "core/force/detail/tip_bone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spinaltap {

TipBone::Mean TipBone::ahead_of(const Pose& pose) const noexcept {
  // A centre and six around it stand for equal shares of the disc: radius² of the centre's share is a seventh of the
  // whole, and the six lie at their share's centroid.
  constexpr int kAround = 6;
  constexpr double kShare = 1.0 / (kAround + 1);
  const double off_mm = 0.724 * edge_radius_mm_;
  const Vec3 u = any_perpendicular(pose.axis);
  const Vec3 v = pose.axis.cross(u);
  Mean mean;
  const auto add = [&](const Vec3& p, double weight) {
    const BonePoints::Bone* bone = bone_->living_at(p);
    if (bone == nullptr) return;
    mean.density_g_cm3 += weight * bone->density_g_cm3;
    mean.chisel_mpa += weight * bone->chisel_mpa;
  };
  // Axes nearer to the discs' planes than this (cosine) look one spacing ahead; no disc is ahead of them.
  constexpr double kSteepest = 0.25;
  const double along = pose.axis.z();
  for (int n = 0; n <= kAround; ++n) {
    Vec3 p = pose.tip_mm;
    if (n > 0) {
      const double angle = 2.0 * std::numbers::pi * n / kAround;
      p += off_mm * (std::cos(angle) * u + std::sin(angle) * v);
    }
    const std::size_t volume = bone_->volume_at(p.z());
    const double spacing_mm = bone_->volume(volume).pattern().spacing_mm();
    if (!(std::abs(along) >= kSteepest)) {
      add(p + spacing_mm * pose.axis, kShare);
      continue;
    }
    // In discs towards which the bit points. The disc at the tip itself is cut; rounding does not make it the next.
    const double sign = along > 0.0 ? 1.0 : -1.0;
    const double at = sign * (p.z() - bone_->start_mm(volume)) / spacing_mm;
    const double next = std::floor(at + 1e-6) + 1.0;
    const double nearer = std::clamp(next - at, 0.0, 1.0);
    const auto on_disc = [&](double disc) -> Vec3 {
      return p + (disc - at) * spacing_mm / std::abs(along) * pose.axis;
    };
    add(on_disc(next), kShare * nearer);
    add(on_disc(next + 1.0), kShare * (1.0 - nearer));
  }
  return mean;
}

}  // namespace spinaltap
