#pragma once

#include <filesystem>

#include "tests/support/made_bone.h"

namespace spinaltap::test {

inline const Vec3 kBoneCentre(10.0, -4.0, 30.0);
inline constexpr double kBoneRadiusMm = 6.0;

/// Writes a ball of bone in a box that does not depend on the radius.
inline void write_bone_ball(const std::filesystem::path& path, double radius_mm = kBoneRadiusMm) {
  const Vec3 corner = Vec3::Constant(kBoneRadiusMm + 2.0);
  write_bone(made_bone([=](const Vec3& p) { return (p - kBoneCentre).norm() - radius_mm; },
                       {kBoneCentre - corner, kBoneCentre + corner}, 0.25),
             path);
}

}  // namespace spinaltap::test
