// Surfaces of triangles.

#include "mesh/mesh_io.h"
#include "mesh/mesh_quality.h"
#include "tests/fuzz/readers.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

std::string written_mesh(const std::string& name) {
  return bytes_written(name, [](const fs::path& file) { write_mesh(torus_mesh(10.0, 3.0, 8, 5), file); });
}

std::vector<Seed> stl_seeds() {
  const std::string text =
      "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5e0 0 0\n   vertex 0 1 0\n  endloop\n"
      " endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 0 1 0\n   vertex -1 -0 2\n  endloop\n"
      " endfacet\nendsolid a b\n";
  return {{"binary", {{"a.stl", written_mesh("a.stl")}}}, {"text", {{"a.stl", text}}}};
}

std::vector<Seed> ply_seeds() {
  const std::string text =
      "ply\nformat ascii 1.0\ncomment c\nelement camera 1\nproperty list uchar int views\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty float quality\nend_header\n2 7 8\n0 0 0 1\n1 0 0 2\n1 1 0 3\n"
      "0 1 0 4\n3 0 1 2 0.5\n4 0 1 2 3 1e3\n";
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty float z\n"
      "element face 1\nproperty list ushort uint vertex_index\nend_header\n";
  for (int n = 0; n < 3; ++n)
    big += std::string("\x40\x40\0\0\xbf\xf0\0\0\0\0\0", 11) + static_cast<char>(n) + std::string("\x3f\x80\0\0", 4);
  big += std::string("\0\3\0\0\0\0\0\0\0\1\0\0\0\2", 14);
  return {
      {"binary", {{"a.ply", written_mesh("a.ply")}}}, {"text", {{"a.ply", text}}}, {"big endian", {{"a.ply", big}}}};
}

std::vector<Seed> obj_seeds() {
  return {{"ours", {{"a.obj", written_mesh("a.obj")}}},
          {"another program's",
           {{"a.obj",
             "# c\nmtllib a.mtl\no part\nv 0 0 0 1\nv 1.5e0 0 0\nv 1 1 0\nv 0 1 -2\nvt 0 0\nvn 0 0 1\ng g\nusemtl m\n"
             "s off\nf 1/1/1 2/1/1 3//1\nf -4 -3 -2 -1\nl 1 2\n"}}}};
}

std::vector<Seed> off_seeds() {
  return {{"text", {{"a.off", "OFF\n# c\n4 2 0\n0 0 0\n1.5e0 0 0\n1 1 0\n0 1 -2\n3 0 1 2\n4 0 1 2 3 255 0 0\n"}}},
          {"with colours", {{"a.off", "COFF\n3 1 3\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n"}}}};
}

void read_and_measure(const fs::path& folder) {
  const TriangleMesh mesh = read_mesh(only_file(folder));
  static_cast<void>(measure_mesh(mesh));
}

}  // namespace

void add_mesh_readers(std::vector<Reader>& readers) {
  readers.push_back({"stl", stl_seeds, read_and_measure});
  readers.push_back({"ply", ply_seeds, read_and_measure});
  readers.push_back({"obj", obj_seeds, read_and_measure});
  readers.push_back({"off", off_seeds, read_and_measure});
}

}  // namespace spinaltap::test
