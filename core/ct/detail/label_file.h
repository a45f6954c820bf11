#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>

#include "core/ct/grid_geometry.h"

namespace spinaltap::detail {

/// A label map's file: where its voxels lie, and the names that it gives its labels.
struct LabelFile {
  std::array<int, 3> size{0, 0, 0};
  Mat3 index_to_patient;  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm;         ///< centre of voxel (0, 0, 0), LPS
  /// What the file calls its labels, in its own words: 3D Slicer's segments, or the label table of a NIfTI extension.
  std::map<long long, std::string> names;

  std::size_t voxel_count() const;
};

/// Is given the voxels' values from first to last, some at a time; not a number where the file has none.
using TakeLabels = std::function<void(std::span<const double>)>;

/// Reads .nii, .nii.gz and .nrrd (.seg.nrrd is one). `begin`, which may be empty, is given the file's head, without
/// names, before `take` its voxels. Throws Error when the file is neither or is damaged.
LabelFile read_label_file(const std::filesystem::path& file, const std::function<void(const LabelFile&)>& begin,
                          const TakeLabels& take);

/// For each voxel of `grid` whose centre lies in one of the file's: its offset and the file's. Called from many
/// threads, once a voxel of `grid`.
void for_each_nearest(const LabelFile& file, const GridGeometry& grid,
                      const std::function<void(std::size_t, std::size_t)>& visit);

/// "1, 2, 22"; the first of them where there are many; "none".
std::string list_for_people(const std::set<long long>& labels);

/// Rejects steps that are not finite or give voxels no volume. `what` names the file.
void check_transform(const LabelFile& labels, const std::string& what);

/// The labels of a CARET label table in XML, as TotalSegmentator writes it into a NIfTI extension: `<Label Key="27"
/// ...><![CDATA[vertebrae_L5]]></Label>`. Takes what it understands and leaves the rest.
std::map<long long, std::string> names_of_label_table(const std::string& xml);

// One file each.
LabelFile read_nifti_labels(const std::filesystem::path& file, const std::function<void(const LabelFile&)>& begin,
                            const TakeLabels& take);
/// Three axes, or four where the first counts one layer; raw or gzip; header and voxels in one file.
LabelFile read_nrrd_labels(const std::filesystem::path& file, const std::function<void(const LabelFile&)>& begin,
                           const TakeLabels& take);

}  // namespace spinaltap::detail
