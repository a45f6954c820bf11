#include "mesh/vertebra_mesh.h"

#include "core/base/error.h"
#include "mesh/mesh_io.h"

namespace spinaltap {

VertebraMesh to_vertebra_mesh(const TriangleMesh& mesh, const VertebraMeshOptions& options) {
  VertebraMesh result;
  result.mesh = scaled_mesh(mesh, options.scale.value_or(1.0));
  if (!options.scale) check_mesh_units(result.mesh, options.level);
  if (options.axes) {
    result.mesh = turn_axes(result.mesh, *options.axes);
  } else {
    result.warnings = check_mesh_axes(result.mesh);
  }
  return result;
}

VertebraMesh read_vertebra_mesh(const std::filesystem::path& path, const VertebraMeshOptions& options) {
  const TriangleMesh mesh = read_mesh(path);
  try {
    return to_vertebra_mesh(mesh, options);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
}

}  // namespace spinaltap
