// surface_blocks BONE PLAN MESH: keeps the surface of a bone that is being drilled as a renderer does, a mesh for each
// block: thirty times a second what changed takes the place of what was there. Writes what it has at the end.
#include <spinaltap/mesh/mesh_io.h>
#include <spinaltap/spinaltap.h>

#include <array>
#include <cstdio>
#include <map>

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 4) return 2;
  try {
    const Bone bone = Bone::load(arguments[1]);
    const DrillPath path = read_plan(arguments[2]).front();
    SessionSetup setup;
    setup.volume.spacing_mm = 0.2;
    setup.has_clearances = false;
    Session session(bone, path, setup);

    std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>> meshes;  // a buffer of the renderer's for each
    std::size_t taken = 0;
    const auto draw = [&] {
      for (const SurfaceUpdate& update : session.surface_changes()) {
        if (update.surface) {
          meshes[update.block] = update.surface;  // never changes: any thread may draw it
        } else {
          meshes.erase(update.block);
        }
        ++taken;
      }
    };
    draw();  // the first time all
    const std::size_t whole = taken;
    PlannedMotion tool(path, {.line = {.lead_in_mm = 3.0}, .feed = {.steps = {{.mm_s = 10.0}}}});
    for (std::size_t cycle = 0; const std::optional<ToolInput> input = tool.next(session.feedback()); ++cycle) {
      session.step_input(*input);
      if (cycle % 33 == 0) draw();
    }
    draw();

    TriangleMesh mesh;
    std::size_t walls = 0;
    for (const auto& [place, block] : meshes) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
      mesh.vertices_mm.insert(mesh.vertices_mm.end(), block->vertices_mm.begin(), block->vertices_mm.end());
      for (const auto& [a, b, c] : block->triangles) mesh.triangles.push_back({first + a, first + b, first + c});
      walls += block->triangles.size() - block->wall_begin;  // another colour
    }
    write_mesh(mesh, arguments[3]);
    std::printf("%zu blocks at first, %zu changed; %zu triangles, %zu of them drilled walls\n", whole, taken - whole,
                mesh.triangles.size(), walls);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
