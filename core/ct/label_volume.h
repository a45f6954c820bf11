#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/ct_volume.h"
#include "core/ct/dicom_source.h"
#include "core/ct/level.h"

namespace spinaltap {

/// What the numbers of a label map stand for; docs/label-maps.md has the tables.
enum class LabelConvention {
  automatic,            ///< the file's own names, else numbers where only one convention can be meant
  names,                ///< the names that the file gives its labels
  any_names,            ///< those too, also where none of them is a vertebra's: never the numbers
  verse,                ///< VerSe and SPINEPS: 8 is T1, 20 is L1, 26 the sacrum, 28 T13
  totalsegmentator,     ///< task `total` of TotalSegmentator 2: 50 is C1, 27 is L5, 25 the sacrum
  totalsegmentator_v1,  ///< TotalSegmentator 1: 41 is C1, 18 is L5
};

/// One label of a map.
struct LabelName {
  std::string name;            ///< "T11"; for what is no vertebra as the file has it, or empty
  Level level = Level::kNone;  ///< kNone: no whole vertebra
  bool operator==(const LabelName&) const = default;
};

/// A label map on a CT's grid: which voxel belongs to which bone.
struct LabelVolume {
  GridGeometry geometry;
  std::vector<std::uint8_t> labels;  ///< geometry.voxel_count() values, i fastest; 0: none
  std::map<int, LabelName> names;    ///< by label, those that occur in `labels`; no level twice
};

/// Reads all labels of a map as 3D Slicer, TotalSegmentator and SPINEPS write them, NIfTI (.nii, .nii.gz), NRRD (.nrrd,
/// .nhdr, .seg.nrrd), MetaImage (.mha, .mhd), DICOM segmentation or structure set, on any grid: each voxel of
/// `ct_geometry` takes the label of the file's voxel that its centre lies in. Where none of the labels is a vertebra,
/// all have level kNone. Throws Error when the file is none of them or damaged, has labels that are not whole numbers
/// from 0 to 255, or none within the CT; when two labels have the same level; and when `convention` is automatic and
/// the numbers can be meant in several ways (the message has them), or names and the file names no vertebra.
LabelVolume read_label_volume(const std::filesystem::path& file, const GridGeometry& ct_geometry,
                              LabelConvention convention = LabelConvention::automatic);

/// The label of a level, where the map has one.
std::optional<int> label_of(const LabelVolume& volume, Level level);

/// The levels in the map, from the head down.
std::vector<Level> levels_of(const LabelVolume& volume);

/// The voxels that carry the label. Throws Error where none does.
BoneMask mask_of(const LabelVolume& volume, int label);
/// As above; the message lists the levels that there are.
BoneMask mask_of(const LabelVolume& volume, Level level);

/// The label map as bytes, in the format of the name's ending: .nii, .nii.gz, .nrrd, or .seg.nrrd, which 3D Slicer
/// opens as a segmentation with a segment of its own name and colour a label; .dcm or .seg.dcm for a DICOM
/// segmentation, .rtstruct.dcm for a DICOM structure set, which name the images of `source` and nothing else of them.
/// NIfTI carries the names in an extension, as TotalSegmentator writes it; .nrrd carries none. read_label_volume()
/// reads them again; a DICOM segmentation's labels are then 1, 2, 3, ... The same volume gives the same bytes. Throws
/// Error on another ending, and on names with line breaks.
std::string encode_label_volume(const LabelVolume& volume, const std::filesystem::path& name,
                                const DicomSource& source = {});

/// Whether a label map of that name is a DICOM object, which wants to name its CT's images.
bool is_dicom_label_name(const std::filesystem::path& name);

}  // namespace spinaltap
