#pragma once

#include <filesystem>

#include "core/base/triangle_mesh.h"

// Each reads the triangles of one format. OpenMesh's readers (9.0) believe what they read: a damaged file makes them
// write past their buffers, take gigabytes, or not end. Faces of more corners are cut into fans, faces that use a
// vertex twice are left out, vertices keep the file's order. All throw Error on a damaged file, a corner that is no
// vertex, and a coordinate that is no number; the memory that they take is in proportion to the file.
namespace spinaltap::detail {

/// Binary or text. Corners in one place are one vertex.
TriangleMesh parse_stl(const std::filesystem::path& path);

/// Text or binary, of either byte order.
TriangleMesh parse_ply(const std::filesystem::path& path);

TriangleMesh parse_obj(const std::filesystem::path& path);

/// Text.
TriangleMesh parse_off(const std::filesystem::path& path);

}  // namespace spinaltap::detail
