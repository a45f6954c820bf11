#include "mesh/mesh_io.h"

// OpenMesh asks for its readers and writers before its mesh types.
#include <OpenMesh/Core/IO/MeshIO.hh>
//
#include <algorithm>
#include <string>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/detail/parse_mesh.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& path) { return lower_case(path.extension().string()); }

void require_extension(const fs::path& path, std::initializer_list<const char*> allowed) {
  const std::string extension = lower_extension(path);
  std::string list;
  for (const char* candidate : allowed) {
    if (extension == candidate) return;
    list += list.empty() ? candidate : std::string(", ") + candidate;
  }
  fail("expected a mesh file that ends in ", list, ", found ", path.filename().string());
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
  require_extension(path, {".stl", ".ply", ".obj", ".off"});
  const std::string extension = lower_extension(path);
  if (extension == ".stl") return detail::parse_stl(path);
  if (extension == ".ply") return detail::parse_ply(path);
  return extension == ".obj" ? detail::parse_obj(path) : detail::parse_off(path);
}

void write_mesh(const TriangleMesh& mesh, const fs::path& path) {
  require_extension(path, {".stl", ".ply", ".obj"});
  if (mesh.triangles.empty()) fail("cannot write ", path.string(), ": the mesh has no triangles");
  const detail::SilencedOutput silenced;
  const detail::HalfEdgeResult linked = detail::to_half_edges(mesh);
  if (linked.rejected_faces > 0) {
    fail("cannot write ", path.string(), ": ", linked.rejected_faces, " of ", mesh.triangles.size(),
         " triangles are degenerate or share an edge with two others");
  }
  OpenMesh::IO::Options options;
  if (lower_extension(path) != ".obj") options += OpenMesh::IO::Options::Binary;
  constexpr std::streamsize kDigits = 9;  // enough to give each float back
  // OpenMesh does not look whether its bytes reach the disk, so it writes to memory.
  TextStream bytes;
  if (!OpenMesh::IO::write_mesh(linked.mesh, bytes, lower_extension(path), options, kDigits)) {
    fail_as(ErrorKind::disk, "cannot write ", path.string());
  }
  write_whole_file(path, bytes.str());
}

}  // namespace spinaltap
