#pragma once

#include <filesystem>

#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// Writes STL (binary), PLY (binary) or OBJ, by the extension of `path`, which must be a staged (temporary) name.
/// Throws Error on another extension, on a mesh without triangles or with triangles that OpenMesh cannot hold
/// (degenerate ones, or three at an edge), and when the disk is full.
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path);

/// Reads STL, PLY, OBJ or OFF (text); coordinates are taken as patient LPS, mm. Faces of more corners are cut into
/// triangles. Takes memory in proportion to the file, whatever counts stand in it. Throws Error when the file is
/// missing, damaged, names a vertex that it has not, has a coordinate that is no number, or no triangle.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace spinaltap
