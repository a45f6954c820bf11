#include <cstdio>
#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/mesh_figures.h"
#include "core/base/staged_output.h"
#include "mesh/mesh_io.h"
#include "vdb/isosurface.h"

namespace spinaltap {

Json report_mesh(const MeshQuality& quality) {
  print_figure("triangles", static_cast<double>(quality.triangles), "", 0);
  print_figure("pieces", static_cast<double>(quality.pieces), "", 0);
  print_figure("closed", quality.closed() ? "yes" : "no");
  print_figure("Euler number", static_cast<double>(quality.euler_number), "", 0);
  print_figure("volume", quality.volume_mm3, "mm3", 1);
  print_figure("area", quality.area_mm2, "mm2", 1);
  print_figure("smallest angle", quality.smallest_angle_deg, "degrees", 2);
  return {{"vertices", quality.vertices},
          {"triangles", quality.triangles},
          {"pieces", quality.pieces},
          {"closed", quality.closed()},
          {"boundary_edges", quality.boundary_edges},
          {"non_manifold_faces", quality.refused_faces},
          {"euler_number", quality.euler_number},
          {"volume_mm3", quality.volume_mm3},
          {"area_mm2", quality.area_mm2},
          {"smallest_angle_deg", quality.smallest_angle_deg}};
}

void add_mesh(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path bone;
    std::filesystem::path output = "bone.stl";
    IsosurfaceOptions surface;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "mesh", "Write the surface of a bone.vdb as STL, PLY or OBJ (mm, LPS)",
                              "Example: spinaltap mesh bone.vdb -o bone.stl --adaptivity 0.02");
  app->add_option("bone", options->bone, "bone.vdb or drilled.vdb")->required()->type_name("FILE");
  app->add_option("-o,--output", options->output, "The mesh to write: .stl, .ply or .obj")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_option("--adaptivity", options->surface.adaptivity,
                  "0: even triangles; up to 1: larger ones where it is flat")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));

  command.run = [options](const Progress& progress) {
    const BoneModel bone = read_bone(options->bone);
    progress.report("meshing", 0.0);
    const TriangleMesh mesh = bone_surface(bone, options->surface);
    StagedOutput output;
    write_mesh(mesh, output.stage(options->output));
    output.commit();
    Json figures = report_mesh(measure_mesh(mesh));
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
