#include "mesh/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "mesh/mesh_quality.h"
#include "tests/support/full_disk.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

class MeshFile : public testing::TestWithParam<const char*> {
 protected:
  fs::path file(const std::string& stem) const { return folder_.path() / (stem + GetParam()); }
  fs::path folder() const { return folder_.path(); }

 private:
  test::TemporaryFolder folder_;
};

/// A mesh whose coordinates need all digits of a float, far from the origin.
TriangleMesh torus() {
  TriangleMesh mesh = test::torus_mesh(10.0, 3.0, 24, 12);
  for (auto& p : mesh.vertices_mm) p += Eigen::Vector3f(-63.1F, 12.7F, 812.3F);
  return mesh;
}

/// The corners of all triangles, in an order that does not depend on how vertices are numbered.
std::vector<std::array<float, 9>> corners_of(const TriangleMesh& mesh) {
  std::vector<std::array<float, 9>> all;
  for (const auto& t : mesh.triangles) {
    // Start at the smallest corner; the turn of the face stays.
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t n = 0; n < 3; ++n) {
      const Eigen::Vector3f& p = mesh.vertices_mm[t[n]];
      corners[n] = {p.x(), p.y(), p.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<float, 9> flat{};
    for (std::size_t n = 0; n < 9; ++n) flat[n] = corners[n / 3][n % 3];
    all.push_back(flat);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST_P(MeshFile, GivesBackEveryTriangleToTheLastBit) {
  write_mesh(torus(), file("torus"));
  const TriangleMesh back = read_mesh(file("torus"));
  EXPECT_EQ(corners_of(back), corners_of(torus()));
  EXPECT_EQ(back.vertices_mm.size(), torus().vertices_mm.size());
  EXPECT_TRUE(measure_mesh(back).closed());
}

TEST_P(MeshFile, HasTheSameBytesUnderAnyName) {
  write_mesh(torus(), file("first"));
  StagedOutput output;
  write_mesh(torus(), output.stage(file("second")));
  output.commit();
  const std::string bytes = read_whole_file(file("second"));
  EXPECT_EQ(bytes, read_whole_file(file("first")));
  EXPECT_THAT(bytes, Not(HasSubstr("partial")));
  EXPECT_THAT(bytes, Not(HasSubstr("second")));
}

TEST_P(MeshFile, TakesAnExtensionInCapitals) {
  std::string capitals = GetParam();
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const fs::path path = folder() / ("torus" + capitals);
  write_mesh(torus(), path);
  EXPECT_EQ(corners_of(read_mesh(path)), corners_of(torus()));
}

TEST_P(MeshFile, IsNotLeftBehindOnAFullDisk) {
  write_mesh(torus(), file("whole"));
  const auto size = fs::file_size(file("whole"));
  fs::remove(file("whole"));
  for (const std::uintmax_t room : {std::uintmax_t{16}, size / 2, size - 1}) {
    StagedOutput output;
    const fs::path staged = output.stage(file("torus"));
    const test::FullDisk full(room);
    EXPECT_THAT([&] { write_mesh(torus(), staged); }, ThrowsMessage<Error>(HasSubstr("cannot write"))) << room;
  }
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_P(MeshFile, KeepsTrianglesThatAreNeedlesOrPoints) {
  // Dual contouring may put two vertices of a triangle onto one place.
  TriangleMesh mesh = torus();
  mesh.vertices_mm[1] = mesh.vertices_mm[0];
  EXPECT_NO_THROW(write_mesh(mesh, file("needle")));
  EXPECT_TRUE(fs::exists(file("needle")));
}

TEST_P(MeshFile, RejectsAMeshThatItCannotHold) {
  TriangleMesh fin = test::tetrahedron();
  fin.vertices_mm.emplace_back(-1.0F, -1.0F, 3.0F);
  fin.triangles.push_back({0, 1, 4});
  // OpenMesh knows no edge with three faces; a face must not get lost silently.
  EXPECT_THAT([&] { write_mesh(fin, file("fin")); }, ThrowsMessage<Error>(HasSubstr("1 of 5")));
  TriangleMesh out_of_range = test::tetrahedron();
  out_of_range.triangles[0][0] = 17;
  EXPECT_THROW(write_mesh(out_of_range, file("range")), Error);
  EXPECT_THROW(write_mesh({}, file("empty")), Error);
}

TEST_P(MeshFile, IsRejectedWhenItIsNoMesh) {
  std::ofstream(file("text")) << "hello\n";
  EXPECT_THAT([&] { read_mesh(file("text")); }, ThrowsMessage<Error>(HasSubstr("text")));
  std::ofstream(file("empty")) << "";
  EXPECT_THROW(read_mesh(file("empty")), Error);
  EXPECT_THAT([&] { read_mesh(file("missing")); }, ThrowsMessage<Error>(HasSubstr("no such file")));
  fs::create_directory(file("directory"));
  EXPECT_THAT([&] { read_mesh(file("directory")); }, ThrowsMessage<Error>(HasSubstr("something else")));
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  EXPECT_THAT([&] { read_mesh(file("pipe")); }, ThrowsMessage<Error>(HasSubstr("something else")));
}

INSTANTIATE_TEST_SUITE_P(Formats, MeshFile, testing::Values(".stl", ".ply", ".obj"),
                         [](const auto& instance) { return std::string(instance.param + 1); });

TEST(MeshFiles, OfBinaryFormatsAreRejectedWhenCutShort) {
  const test::TemporaryFolder folder;
  for (const char* name : {"torus.stl", "torus.ply"}) {
    write_mesh(torus(), folder.path() / name);
    const std::string whole = read_whole_file(folder.path() / name);
    for (const std::size_t keep : {std::size_t{40}, whole.size() / 2, whole.size() - 1}) {
      const fs::path cut = folder.path() / ("cut" + fs::path(name).extension().string());
      std::ofstream(cut, std::ios::binary | std::ios::trunc) << whole.substr(0, keep);
      EXPECT_THROW(read_mesh(cut), Error) << name << ", " << keep << " of " << whole.size() << " bytes";
    }
  }
}

TEST(MeshFiles, WithAnotherExtensionAreRejected) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { write_mesh(torus(), folder.path() / "torus.vtk"); },
              ThrowsMessage<Error>(AllOf(HasSubstr(".stl, .ply, .obj"), HasSubstr("torus.vtk"))));
  EXPECT_THROW(write_mesh(torus(), folder.path() / "torus"), Error);
  EXPECT_THROW(write_mesh(torus(), folder.path() / "torus.off"), Error);
  EXPECT_THROW(read_mesh(folder.path() / "torus.vtk"), Error);
}

TEST(MeshFiles, CanBeAsciiStlAndOff) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "face.stl")
      << "solid face\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
         "   vertex 2 0 0\n   vertex 0 3 0\n  endloop\n endfacet\nendsolid face\n";
  EXPECT_NEAR(measure_mesh(read_mesh(folder.path() / "face.stl")).area_mm2, 3.0, 1e-6);
  std::ofstream(folder.path() / "face.off") << "OFF\n3 1 0\n0 0 0\n2 0 0\n0 3 0\n3 0 1 2\n";
  EXPECT_NEAR(measure_mesh(read_mesh(folder.path() / "face.off")).area_mm2, 3.0, 1e-6);
}

TEST(MeshFiles, CanHaveFacesOfManyCornersAndCountBack) {
  const test::TemporaryFolder folder;
  const auto area_of = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return measure_mesh(read_mesh(folder.path() / name)).area_mm2;
  };
  const std::string corners = "v 0 0 0\nv 2 0 0 0.5 0.5 0.5\nv 2 3 0\nv 0 3 0\n";
  EXPECT_NEAR(area_of("a.obj", "# made\n" + corners + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n"), 6.0, 1e-6);
  EXPECT_NEAR(area_of("b.obj", corners + "f -4/1/1 -3/1/1 -2/1/1\n"), 3.0, 1e-6);
  EXPECT_NEAR(area_of("c.off", "OFF # made\n4 1 0\n0 0 0\n2 0 0\n\n2 3 0\n0 3 0\n4 0 1 2 3 255 0 0\n"), 6.0, 1e-6);
  EXPECT_NEAR(area_of("d.ply",
                      "ply\nformat ascii 1.0\nelement face 1\nproperty uchar red\nproperty list uchar int "
                      "vertex_index\nelement vertex 4\nproperty float y\nproperty double x\nproperty short z\n"
                      "end_header\n7 4 3 2 1 0\n0 0 0\n0 2 0\n3 2 0\n3 0 0\n"),
              6.0, 1e-6);
}

// OpenMesh's readers took gigabytes, did not end, or crashed on such files.
TEST(MeshFiles, AreRejectedWhereCountsAndCornersAreNotTheirs) {
  const test::TemporaryFolder folder;
  const auto expect_rejected = [&](const char* name, const std::string& text, const char* said) {
    std::ofstream(folder.path() / name, std::ios::binary | std::ios::trunc) << text;
    EXPECT_THAT([&] { read_mesh(folder.path() / name); }, ThrowsMessage<Error>(AllOf(HasSubstr(name), HasSubstr(said))))
        << text;
  };
  const std::string corners = "v 0 0 0\nv 2 0 0\nv 0 3 0\n";
  expect_rejected("far.obj", corners + "f 1 2 2000000000\n", "vertex 2000000000");
  expect_rejected("back.obj", corners + "f 1 2 -4\n", "vertex's number");
  expect_rejected("zero.obj", corners + "f 0 1 2\n", "vertex's number");
  expect_rejected("two.obj", corners + "f 1 2\n", "three corners");
  expect_rejected("nan.obj", "v 0 0 nan\n" + corners + "f 1 2 3\n", "no number");
  expect_rejected("large.obj", "v 0 0 1e300\n" + corners + "f 1 2 3\n", "no number");
  expect_rejected("short.obj", "v 0 0\n" + corners + "f 1 2 3\n", "three numbers");
  expect_rejected("one.obj", corners + "f 1 2 1\n", "found none");
  expect_rejected("many.off", "OFF\n2000000000 1 0\n0 0 0\n2 0 0\n0 3 0\n3 0 1 2\n", "no room");
  expect_rejected("corners.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 3 0\n2000000000 0 1 2\n", "corners");
  expect_rejected("binary.off", "OFF BINARY\n", "OFF file of text");
  const auto ply = [](const std::string& vertices, const std::string& list) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list " + list +
           " int vertex_indices\nend_header\n" + std::string(36, '\0');
  };
  expect_rejected("many.ply", ply("4000000000", "uchar"), "found room for");
  expect_rejected("list.ply", ply("3", "uint") + std::string(3, '\0') + "\x7f" + std::string(12, '\0'),
                  "list that fits");
  expect_rejected("no.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n", "x, y and z");
  std::string stl(84, 'x');
  stl.replace(80, 4, "\xff\xff\xff\x7f");
  expect_rejected("many.stl", stl, "cut short");
  expect_rejected("open.stl", "solid s\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" + std::string(40, ' '),
                  "cut short");
}

TEST(MeshFiles, PrintNothing) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "text.ply") << "hello\n";
  std::ofstream(folder.path() / "bad.obj") << "v 0 0 0\nf 1 2 3\n";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_THROW(read_mesh(folder.path() / "text.ply"), Error);
  EXPECT_THROW(read_mesh(folder.path() / "bad.obj"), Error);
  write_mesh(torus(), folder.path() / "torus.stl");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace spinaltap
