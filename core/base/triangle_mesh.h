#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Triangles that share vertices. Faces wind outward: counter-clockwise when seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_mm;             ///< patient LPS
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices_mm
};

}  // namespace spinaltap
