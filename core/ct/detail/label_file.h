#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap::detail {

/// A label map's file: where its voxels lie, and the names that it gives its labels.
struct LabelFile {
  std::array<int, 3> size{0, 0, 0};
  Mat3 index_to_patient;  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm;         ///< centre of voxel (0, 0, 0), LPS
  /// What the file calls its labels, in its own words: 3D Slicer's segments, or the label table of a NIfTI extension.
  std::map<long long, std::string> names;
  /// The format makes labels 1, 2, 3, ...: no convention can be seen in them.
  bool numbers_are_ranks = false;
  std::vector<std::string> warnings{};  ///< what speaks against the place of its voxels, a line each

  std::size_t voxel_count() const;
};

/// Is given the voxels' values from first to last, some at a time; not a number where the file has none.
using TakeLabels = std::function<void(std::span<const double>)>;

struct LabelFileOptions {
  std::optional<long long> only{};              ///< of formats where segments may overlap, this one is read alone
  NiftiAffine affine = NiftiAffine::automatic;  ///< of a NIfTI file whose two transforms differ
};

/// Reads NIfTI, NRRD (.seg.nrrd is one), MetaImage, DICOM segmentations, and DICOM structure sets, whose contours are
/// put onto the grid of `ct`. `begin`, which may be empty, is given the file's head, without names, before `take` its
/// voxels. Throws Error when the file is none of them or is damaged.
LabelFile read_label_file(const std::filesystem::path& file, const GridGeometry& ct, const LabelFileOptions& options,
                          const std::function<void(const LabelFile&)>& begin, const TakeLabels& take);

/// The whole number that a voxel holds, but for the rounding of maps that were stored as floats; nothing for others.
std::optional<long long> label_in(double value);

/// For each voxel of `grid` whose centre lies in one of the file's: its offset and the file's. Called from many
/// threads, once a voxel of `grid`.
void for_each_nearest(const LabelFile& file, const GridGeometry& grid,
                      const std::function<void(std::size_t, std::size_t)>& visit);

/// "1, 2, 22"; the first of them where there are many; "none".
std::string list_for_people(const std::set<long long>& labels);

/// The labels of a CARET label table in XML, as TotalSegmentator writes it into a NIfTI extension: `<Label Key="27"
/// ...><![CDATA[vertebrae_L5]]></Label>`. Takes what it understands and leaves the rest. Throws Error where a label has
/// two names.
void add_names_of_label_table(const std::string& xml, const std::filesystem::path& file,
                              std::map<long long, std::string>& names);

LabelFile read_nifti_labels(const std::filesystem::path& file, NiftiAffine affine,
                            const std::function<void(const LabelFile&)>& begin, const TakeLabels& take);

}  // namespace spinaltap::detail
