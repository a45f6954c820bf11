#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/level.h"
#include "mesh/mesh_axes.h"
#include "mesh/mesh_units.h"

namespace spinaltap {

/// What a surface file does not say of itself.
struct VertebraMeshOptions {
  std::optional<double> scale = std::nullopt;  ///< to mm; without it the mesh must have the size of a vertebra in mm
  std::optional<std::string> axes =
      std::nullopt;            ///< along which it lies, as "RAS"; without it, LPS, and that is checked
  Level level = Level::kNone;  ///< which vertebra it is, for its size
};

struct VertebraMesh {
  TriangleMesh mesh;                  ///< patient LPS, mm
  std::vector<std::string> warnings;  ///< a line each
};

/// A mesh made one of patient LPS, mm. What the options say is believed; what they leave out is checked by
/// check_mesh_units() and check_mesh_axes(), which throw Error.
VertebraMesh to_vertebra_mesh(const TriangleMesh& mesh, const VertebraMeshOptions& options = {});

/// The same of a file that read_mesh() reads. An Error of the checks names the file.
VertebraMesh read_vertebra_mesh(const std::filesystem::path& path, const VertebraMeshOptions& options = {});

}  // namespace spinaltap
