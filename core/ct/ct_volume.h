#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// What whoever knows better made of the numbers that were read: value * scale + offset.
struct HuChange {
  double scale = 1.0;
  double offset = 0.0;

  bool is_none() const { return scale == 1.0 && offset == 0.0; }
};

/// A CT: Hounsfield units on a regular grid. Holds nothing that identifies a patient.
struct CtVolume {
  GridGeometry geometry;
  std::vector<std::int16_t> hu;  ///< geometry.voxel_count() values, i fastest
  std::string source_hash;       ///< hexadecimal FNV-1a of geometry and voxels: same CT, same hash
  /// What speaks against it or how it was read, a line each, without names of files or anything of the patient; no part
  /// of the hash. Kept as a bone's metadata: add_input_warnings().
  std::vector<std::string> warnings{};
  /// Which CT it is: the same in another format, whose text or floats round places, and of a part that was cropped from
  /// it. Plans name it.
  std::string whole_hash{};
  /// How it was read where that may surprise, a line each; as warnings, but no doubt.
  std::vector<std::string> notes{};
  HuChange hu_change{};  ///< that was made of its numbers
  /// How it was read where someone decided that; no part of the hash. Goes into a bone's metadata.
  std::map<std::string, std::string> choices{};
  /// Of a DICOM CT a hash of its FrameOfReferenceUID, for maps that name theirs; empty where it has none or several.
  std::string frame_hash{};
  /// How thick its slices are, as its header says, mm: more than their step where they overlap. 0: not said.
  double slice_thickness_mm = 0.0;

  std::int16_t at(int i, int j, int k) const { return hu[geometry.offset(i, j, k)]; }
};

/// Voxels of a CT that belong to the bone: 1 inside, 0 outside, on the CT's grid.
struct BoneMask {
  GridGeometry geometry;
  std::vector<std::uint8_t> inside;  ///< geometry.voxel_count() values, i fastest

  bool at(int i, int j, int k) const { return inside[geometry.offset(i, j, k)] != 0; }
};

/// Where a CT shows nothing that was scanned: slabs between slices that stand too far apart, filled by interpolation
/// because someone asked for it.
struct MadeUpSlices {
  Vec3 normal = Vec3::UnitZ();       ///< of the slices: unit, patient LPS
  std::vector<Interval> slabs_mm{};  ///< along it, from patient LPS' origin; ascending, apart from each other

  /// Whether one of them reaches to within `reach_mm` of a point, along the normal.
  bool holds(const Vec3& p_mm, double reach_mm = 0.0) const;
};

/// Checks sizes and geometry and fills in the hashes. Throws Error.
CtVolume make_ct_volume(const GridGeometry& geometry, std::vector<std::int16_t> hu);

/// HU at a patient position (mm) by tri-linear interpolation; `outside_hu` beyond the outermost voxel centres.
double sample_hu(const CtVolume& ct, const Vec3& p_patient, double outside_hu = -1024.0);
/// The same at a place in the grid, as GridGeometry::to_index() has it.
double sample_hu_at_index(const CtVolume& ct, const Vec3& p_index, double outside_hu = -1024.0);

}  // namespace spinaltap
