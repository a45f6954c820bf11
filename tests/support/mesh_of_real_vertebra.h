#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "mesh/mesh_io.h"

namespace spinaltap::test {

/// The one .stl file in a folder.
inline TriangleMesh read_only_stl(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".stl") return read_mesh(entry.path());
  }
  fail("no .stl in ", folder.string());
}

}  // namespace spinaltap::test
