#include "apps/spinaltap/mesh_options.h"

#include <cstdio>

#include "core/base/error.h"
#include "mesh/mesh_io.h"
#include "mesh/vertebra_mesh.h"

namespace spinaltap {

void MeshCommandOptions::add_to(CLI::App& app) {
  app.add_option("--units", units, "Unit of the meshes; default: mm, if they have the size of a vertebra")
      ->check(CLI::IsMember({"mm", "cm", "in", "m"}))
      ->type_name("UNIT");
  app.add_option("--axes", axes,
                 "Sides of the patient to which the meshes' x, y and z point, such as RAS; default: LPS, if they look "
                 "like it")
      ->type_name("AXES");
}

TriangleMesh MeshCommandOptions::read(const std::filesystem::path& path, Level level) const {
  VertebraMeshOptions options;
  if (!units.empty()) options.scale = mm_per_unit(*length_unit_from_name(units));
  if (!axes.empty()) options.axes = axes;
  options.level = level;
  const TriangleMesh mesh = read_mesh(path);
  try {
    VertebraMesh vertebra = to_vertebra_mesh(mesh, options);
    for (const std::string& warning : vertebra.warnings) {
      std::fprintf(stderr, "warning: %s: %s\n", path.string().c_str(), warning.c_str());
    }
    return std::move(vertebra.mesh);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what(), " (--units and --axes say what they are, of any closed mesh)");
  }
}

}  // namespace spinaltap
