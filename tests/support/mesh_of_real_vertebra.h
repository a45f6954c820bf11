#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "mesh/mesh_io.h"

namespace spinaltap::test {

/// The real vertebra of L3_mesh, turned into patient LPS: its file has the back at -x.
inline TriangleMesh read_real_vertebra(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".stl") continue;
    TriangleMesh mesh = read_mesh(entry.path());
    for (Eigen::Vector3f& vertex : mesh.vertices_mm) vertex = Eigen::Vector3f(vertex.y(), -vertex.x(), vertex.z());
    return mesh;
  }
  fail("no .stl in ", folder.string());
}

}  // namespace spinaltap::test
