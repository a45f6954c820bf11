#include <cstdio>
#include <memory>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/mesh_figures.h"
#include "core/base/staged_output.h"
#include "mesh/display_mesh.h"
#include "mesh/mesh_io.h"

namespace spinaltap {

Json report_mesh(const MeshQuality& quality) {
  print_figure("triangles", static_cast<double>(quality.triangles), "", 0);
  print_figure("pieces", static_cast<double>(quality.pieces), "", 0);
  print_figure("closed", quality.closed() ? "yes" : "no");
  print_figure("Euler number", static_cast<double>(quality.euler_number), "", 0);
  print_figure("volume", quality.volume_mm3, "mm3", 1);
  print_figure("area", quality.area_mm2, "mm2", 1);
  print_figure("smallest angle", quality.smallest_angle_deg, "degrees", 2);
  print_figure("worst aspect", quality.worst_aspect, "(1: equilateral)", 2);
  return {{"vertices", quality.vertices},
          {"triangles", quality.triangles},
          {"pieces", quality.pieces},
          {"closed", quality.closed()},
          {"boundary_edges", quality.boundary_edges},
          {"non_manifold_faces", quality.rejected_faces},
          {"euler_number", quality.euler_number},
          {"volume_mm3", quality.volume_mm3},
          {"area_mm2", quality.area_mm2},
          {"smallest_angle_deg", quality.smallest_angle_deg},
          {"largest_angle_deg", quality.largest_angle_deg},
          {"share_below_30_deg", quality.share_below_30_deg},
          {"mean_aspect", quality.mean_aspect},
          {"worst_aspect", quality.worst_aspect},
          {"sharpest_edge_deg", quality.sharpest_edge_deg}};
}

namespace {

Json distance_json(const MeshDistance& distance) {
  return {{"mean_mm", distance.mean_mm}, {"p99_mm", distance.p99_mm}, {"max_mm", distance.max_mm}};
}

void report_remeshing(const RemeshReport& remeshed, Json& figures) {
  print_figure("mesh to surface, max", remeshed.to_surface.max_mm, "mm", 4);
  print_figure("surface to mesh, max", remeshed.from_surface.max_mm, "mm", 4);
  print_figure("self-intersections", static_cast<double>(remeshed.self_intersections), "", 0);
  if (!remeshed.reached) print_figure("as asked", "no, see the distances");
  figures["mesh_to_surface"] = distance_json(remeshed.to_surface);
  figures["surface_to_mesh"] = distance_json(remeshed.from_surface);
  figures["self_intersections"] = remeshed.self_intersections;
  figures["rounds"] = remeshed.rounds;
  figures["reached"] = remeshed.reached;
}

}  // namespace

void add_mesh(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path bone;
    Level level = Level::kNone;
    std::filesystem::path output = "bone.stl";
    DisplayMeshOptions surface;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(program, command, "mesh", "Write the surface of a bone.vdb as STL, PLY or OBJ (mm, LPS)",
                              "Example: spinaltap mesh bone.vdb -o bone.stl --max-error 0.05");
  app->add_option("bone", options->bone, "bone.vdb, spine.vdb or drilled.vdb")->required()->type_name("FILE");
  add_level(*app, options->level);
  app->add_option("-o,--output", options->output, "The mesh to write: .stl, .ply or .obj")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_option("--max-error", options->surface.max_error_mm, "How far the mesh may lie from the surface, mm")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);

  command.run = [options, &command](const Progress& progress) {
    const BoneModel bone = read_bone(options->bone, options->level);
    RemeshReport remeshed;
    const TriangleMesh mesh = display_mesh(bone, options->surface, &remeshed, progress);
    StagedOutput output;
    write_mesh(mesh, output.stage(options->output));
    output.commit();
    Json figures = report_mesh(measure_mesh(mesh));
    report_remeshing(remeshed, figures);
    if (!remeshed.reached) command.exit_code = kAnswerIsNo;
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
