#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap::detail {

/// Which voxels of a label map's file carry the label, i fastest, and where they lie.
struct LabelVoxels {
  std::array<int, 3> size{0, 0, 0};
  Mat3 index_to_patient;  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm;         ///< centre of voxel (0, 0, 0), LPS
  std::vector<std::uint8_t> has_label;
  std::set<long long> present;  ///< the labels in the file, without 0
};

/// How numbers are stored in a label map's file.
enum class Stored { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

std::size_t bytes_of(Stored stored);

/// Fills in has_label and present from voxels in this machine's byte order; value = number * slope + intercept.
void find_label(Stored stored, std::span<const char> bytes, double slope, double intercept, int label,
                LabelVoxels& voxels);

/// Appends to has_label, and adds to present, from the next voxels' values.
void find_label(std::span<const double> values, int label, LabelVoxels& voxels);

/// Refuses steps that are not finite or give voxels no volume. `what` names the file.
void check_transform(const LabelVoxels& voxels, const std::string& what);

/// Reads .nii and .nii.gz. Throws Error.
LabelVoxels load_nifti_label(const std::filesystem::path& file, int label);
/// Reads .nrrd (.seg.nrrd is one): three axes, or four where the first counts one layer; raw or gzip; header and voxels
/// in one file. Throws Error.
LabelVoxels load_nrrd_label(const std::filesystem::path& file, int label);

}  // namespace spinaltap::detail
