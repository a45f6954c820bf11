#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// One of a NIfTI header's transforms from index to patient.
struct NiftiTransform {
  int code = 0;  ///< 0: there is none; 1 scanner, 2 aligned to another scan, 3 Talairach, 4 MNI 152, 5 another template
  Mat3 steps_mm = Mat3::Identity();  ///< column c: step of index c, patient LPS
  Vec3 origin_mm = Vec3::Zero();     ///< centre of voxel (0, 0, 0), patient LPS

  bool is_there() const { return code > 0; }
};

/// All that a NIfTI header says of where its voxels lie. Lengths in mm, whatever the header's unit is.
struct NiftiForms {
  std::array<int, 3> size{1, 1, 1};
  NiftiTransform sform;
  NiftiTransform qform;
  Vec3 pixdim_mm = Vec3::Ones();     ///< as the header has it; 0, negative or no number where it does not say
  double qform_rounding_rad = 1e-7;  ///< how far the 32 bits of a quaternion may turn it
  int unit = 2;                      ///< xyzt_units: 0 not said, 1 m, 2 mm, 3 micron
};

struct NiftiPlace {
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
  std::vector<std::string> warnings;  ///< what speaks against it, a line each
};

/// Where the voxels lie. Two transforms that agree but for rounding are one; where they do not, the sure one is taken
/// and a warning says how far they are apart and what ITK and 3D Slicer take:
/// - an sform into a template's space beside a scanner's qform: the qform;
/// - an sform of the scanner whose steps are as long as pixdim says: the sform, also where its third axis leans (a
///   tilted gantry kept as shear, which a qform cannot hold).
/// Throws Error, with both places, where neither is sure: mirrored against each other, steps that pixdim contradicts,
/// an sform that is only aligned to another scan; and where there is none (orientation unknown), where the chosen one
/// is missing, and on steps that are no CT's in the header's unit. `file` names it in messages.
NiftiPlace place_nifti(const NiftiForms& forms, NiftiAffine choice, const std::string& file);

}  // namespace spinaltap
