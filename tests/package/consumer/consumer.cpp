// Uses each installed library from outside: core, vdb and mesh.

#include <cstdio>
#include <vector>

#include "core/base/version.h"
#include "core/phantom/vertebra.h"
#include "mesh/mesh_quality.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

int main() {
  const spinaltap::Vertebra vertebra;
  const spinaltap::BoneModel bone = spinaltap::bake_solid(vertebra, {.voxel_mm = 1.0}, 40.0);
  const spinaltap::MeshQuality quality = spinaltap::measure_mesh(spinaltap::bone_surface(bone));
  std::printf("SpinalTap %s: %zu triangles, %.0f mm3\n", std::string(spinaltap::version()).c_str(), quality.triangles,
              quality.volume_mm3);
  return quality.closed() && quality.volume_mm3 > 1e4 ? 0 : 1;
}
