#include "mesh/mesh_io.h"

// OpenMesh asks for its readers and writers before its mesh types.
#include <OpenMesh/Core/IO/MeshIO.hh>
//
#include <algorithm>
#include <array>
#include <string>

#include "core/base/error.h"
#include "mesh/detail/half_edge_mesh.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

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
  std::error_code status;
  if (!fs::exists(path, status)) fail("no such file: ", path.string());
  if (!fs::is_regular_file(path, status)) fail("expected a mesh file, found something else: ", path.string());
  const detail::SilencedOutput silenced;
  detail::HalfEdgeMesh mesh;
  if (!OpenMesh::IO::read_mesh(mesh, path.string()) || mesh.n_faces() == 0) {
    fail("cannot read triangles from ", path.string());
  }
  TriangleMesh result;
  for (const auto vertex : mesh.vertices()) {
    const auto& p = mesh.point(vertex);
    result.vertices_mm.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto face : mesh.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t next = 0;
    for (const auto vertex : face.vertices()) corners[next++] = static_cast<std::uint32_t>(vertex.idx());
    result.triangles.push_back(corners);
  }
  return result;
}

void write_mesh(const TriangleMesh& mesh, const fs::path& path) {
  require_extension(path, {".stl", ".ply", ".obj"});
  const detail::SilencedOutput silenced;
  const detail::HalfEdgeMesh linked = detail::to_half_edges(mesh).mesh;
  OpenMesh::IO::Options options;
  if (lower_extension(path) != ".obj") options += OpenMesh::IO::Options::Binary;
  constexpr std::streamsize kDigits = 9;  // enough to give each float back
  bool written = false;
  try {
    written = OpenMesh::IO::write_mesh(linked, path.string(), options, kDigits);
  } catch (const std::exception&) {
    written = false;
  }
  // OpenMesh does not look whether its last bytes reached the disk; reading them back does.
  detail::HalfEdgeMesh back;
  if (!written || !OpenMesh::IO::read_mesh(back, path.string()) || back.n_faces() != linked.n_faces()) {
    fail("cannot write ", path.filename().string(), ": is the disk full, or the folder not writable?");
  }
}

}  // namespace spinaltap
