#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/ct/level.h"
#include "mesh/mesh_axes.h"
#include "mesh/mesh_io.h"
#include "tests/support/test_data.h"

namespace spinaltap::test {

/// A surface of a real lumbar vertebra among the test data.
struct RealMesh {
  const char* name;
  const char* file;  ///< below the data's folder
  Level level;
  const char* axes;  ///< along which the file lies, as its pictures show
  /// No method was built on it: it was read only when the others' tests passed.
  bool unseen = false;
};

/// L1 of five people, from masks with steps of about a millimetre, and L1 to L5 of the Visible Human.
inline std::vector<RealMesh> real_meshes() {
  const auto level = [](int lumbar) { return static_cast<Level>(static_cast<int>(Level::kL1) + lumbar - 1); };
  return {{"L1 of 010", "L1_meshes/sub-verse010_segment_20.ply", level(1), "LPS", true},
          {"L1 of 013", "L1_meshes/sub-verse013_segment_20.ply", level(1), "LPS"},
          {"L1 of 016", "L1_meshes/sub-verse016_segment_20.ply", level(1), "LPS", true},
          {"L1 of 018", "L1_meshes/sub-verse018_segment_20.ply", level(1), "LPS"},
          {"L1 of 022", "L1_meshes/sub-verse022_segment_20.ply", level(1), "LPS"},
          {"L1 of VHM", "lumbar_meshes/L1_vhm_mm.stl", level(1), "ALS"},
          {"L2 of VHM", "lumbar_meshes/L2_vhm_mm.stl", level(2), "ALS", true},
          {"L3 of VHM", "L3_mesh/L3_vhm_remus_mm.stl", level(3), "ALS"},
          {"L4 of VHM", "lumbar_meshes/L4_vhm_mm.stl", level(4), "ALS"},
          {"L5 of VHM", "lumbar_meshes/L5_vhm_mm.stl", level(5), "ALS", true}};
}

/// As the file has it.
inline TriangleMesh read_as_filed(const RealMesh& mesh) { return read_mesh(test_data_folder() / mesh.file); }

inline TriangleMesh read_in_lps(const RealMesh& mesh) { return turn_axes(read_as_filed(mesh), mesh.axes); }

/// For tests that take an index into real_meshes().
inline std::string name_of_real_mesh(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = real_meshes()[info.param].name;
  std::erase(name, ' ');
  return name;
}

}  // namespace spinaltap::test
