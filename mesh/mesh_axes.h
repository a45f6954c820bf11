#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// Sides of the patient to which a file's x, y and z point, one letter each: L left, R right, P posterior, A anterior,
/// S superior, I inferior. "LPS" is what SpinalTap uses; 24 such names are right-handed and 24 are mirrored ("RPS").
/// Gives the rotation (or mirroring) from the file's coordinates to LPS. Throws Error where a letter is none of the six
/// or two lie along one line.
Mat3 lps_from_axes(std::string_view axes);

/// The right-handed ones, "LPS" first.
const std::array<std::string, 24>& right_handed_axes();

/// The mesh in LPS, of one whose coordinates are along `axes`. Mirrored axes turn its triangles round, so that they
/// still wind outward.
TriangleMesh turn_axes(const TriangleMesh& mesh, std::string_view axes);

/// Along which axes a mesh of a vertebra lies, by its shape.
struct MeshAxes {
  std::string axes = "LPS";  ///< right-handed: what turn_axes() wants
  /// How sure the top is not the bottom and the canal's line the canal's, from 0 (a guess) to 1.
  double sureness = 0.0;
  double canal_radius_mm = 0.0;  ///< of the widest straight way through the bone
  /// How much lower the arch's back lies than the pedicles, in body heights: the cue for the top, above 0.
  double drop = 0.0;
  /// The faces wind inward, as after mirroring along one axis.
  bool is_inside_out = false;
  Vec3 left, posterior, superior;  ///< of the vertebra in the mesh's coordinates, unit; need not lie along its axes
};

/// Finds the axes of a closed mesh of one vertebra, in mm, that is tilted by less than some 40 degrees against them.
///
/// The canal is the widest straight way through the bone (find_canal() along x, y and z), the body its thickest part:
/// these give front and back. The top is where the pedicles are: they leave the body in its upper half, and the lower
/// articular and the spinous processes hang below them. Left and right follow if the mesh is not mirrored, which cannot
/// be seen in a shape that is nearly its own mirror image. Throws Error where there is no canal or no body.
MeshAxes find_mesh_axes(const TriangleMesh& mesh);

/// Throws Error where find_mesh_axes() is sure that the mesh does not lie along LPS, and says which axes it looks like.
/// Returns warnings, a line each: what makes it unsure, and faces that wind inward.
std::vector<std::string> check_mesh_axes(const TriangleMesh& mesh);

}  // namespace spinaltap
