#include "core/ct/stack_layout.h"

#include <array>
#include <cmath>

namespace spinaltap {

std::string plane_name(const Vec3& normal) {
  constexpr std::array<const char*, 3> kNames{"sagittal", "coronal", "axial"};
  constexpr double kWithin = 0.9986;  // cosine of 3 degrees
  Eigen::Index axis = 0;
  const double most = normal.cwiseAbs().maxCoeff(&axis);
  const std::string name = kNames[static_cast<std::size_t>(axis)];
  return most >= kWithin ? name : "oblique, near " + name;
}

}  // namespace spinaltap
