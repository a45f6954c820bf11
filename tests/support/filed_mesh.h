#pragma once

#include <string_view>

#include "mesh/mesh_axes.h"

namespace spinaltap::test {

/// A mesh in LPS as a file along `axes` would hold it: what turn_axes() undoes.
inline TriangleMesh filed_along(const TriangleMesh& in_lps, std::string_view axes) {
  const Eigen::Matrix3f from_lps = lps_from_axes(axes).transpose().cast<float>();
  TriangleMesh filed = in_lps;
  for (Eigen::Vector3f& p : filed.vertices_mm) p = Eigen::Vector3f(from_lps * p);
  return filed;
}

}  // namespace spinaltap::test
