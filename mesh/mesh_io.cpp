#include "mesh/mesh_io.h"

// OpenMesh asks for its readers and writers before its mesh types.
#include <OpenMesh/Core/IO/MeshIO.hh>
//
#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/staged_output.h"
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

/// OpenMesh believes the counts in a file's head: a file cut short would be read for hours, or be taken for a whole
/// one. Returns whether it is a binary STL, which OpenMesh wants to be told.
bool require_whole(const fs::path& path, const std::string& bytes) {
  const std::string extension = lower_extension(path);
  const std::string_view text(bytes);
  if (extension == ".stl") {
    constexpr std::size_t kHead = 80 + 4;
    constexpr std::size_t kTriangle = 50;
    std::uint32_t triangles = 0;
    if (bytes.size() >= kHead) std::memcpy(&triangles, bytes.data() + 80, sizeof triangles);
    const bool whole_binary = bytes.size() >= kHead && bytes.size() >= kHead + kTriangle * std::size_t{triangles};
    const bool whole_text = text.starts_with("solid") && text.find("endsolid") != std::string_view::npos;
    if (!whole_binary && !whole_text) fail("cannot read ", path.string(), ": cut short, or no STL file");
    return whole_binary;
  }
  if (extension == ".ply") {
    const std::size_t head_end = text.find("end_header");
    if (head_end == std::string_view::npos) fail("cannot read ", path.string(), ": cut short, or no PLY file");
    std::istringstream head(bytes.substr(0, head_end));
    for (std::string line; std::getline(head, line);) {
      std::istringstream words(line);
      std::string element;
      std::string name;
      double count = 0.0;
      if (words >> element >> name >> count && element == "element" && !(count <= static_cast<double>(bytes.size()))) {
        fail("cannot read ", path.string(), ": its head promises ", count, " times ", name);
      }
    }
  }
  return false;
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
  require_extension(path, {".stl", ".ply", ".obj", ".off"});
  constexpr std::size_t kMaxBytes = std::size_t{4} << 30;
  const std::string bytes = read_whole_file(path, kMaxBytes);
  const bool binary_stl = require_whole(path, bytes);
  const detail::SilencedOutput silenced;
  detail::HalfEdgeMesh mesh;
  std::istringstream stream(bytes, std::ios::binary);
  OpenMesh::IO::Options options;
  if (binary_stl) options += OpenMesh::IO::Options::Binary;
  const bool read = OpenMesh::IO::read_mesh(mesh, stream, lower_extension(path), options);
  if (!read || mesh.n_faces() == 0) fail("cannot read triangles from ", path.string());
  // A PLY's elements are counted, so reading them must not run out of bytes.
  if (lower_extension(path) == ".ply" && stream.fail()) fail("cannot read ", path.string(), ": cut short");
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
  std::ostringstream bytes(std::ios::binary);
  if (!OpenMesh::IO::write_mesh(linked.mesh, bytes, lower_extension(path), options, kDigits)) {
    fail("cannot write ", path.string());
  }
  write_whole_file(path, bytes.str());
}

}  // namespace spinaltap
