#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/ct_volume.h"
#include "core/ct/grid_geometry.h"
#include "core/ct/level.h"

namespace spinaltap {

struct DicomSource;

/// What the numbers of a label map stand for; docs/label-maps.md has the tables and their sources.
enum class LabelConvention {
  automatic,              ///< the file's own names, else numbers where order and sizes leave one meaning
  names,                  ///< the names that the file gives its labels
  any_names,              ///< those too, also where none of them is a vertebra's: never the numbers
  none,                   ///< nothing: no label is known to be a vertebra
  verse,                  ///< VerSe, SPINEPS, TPTBox: 8 is T1, 20 is L1, 26 the sacrum, 28 T13
  ctspine1k,              ///< 8 is T1, 20 is L1, 25 is L6
  totalsegmentator,       ///< task `total` of TotalSegmentator 2: 50 is C1, 27 is L5, 25 the sacrum
  totalsegmentator_v1,    ///< of TotalSegmentator 1: 41 is C1, 18 is L5
  totalsegmentator_mr,    ///< task `vertebrae_mr`: 25 is C1, 2 is L5, 1 the sacrum
  totalsegmentator_part,  ///< the vertebrae's part of `total`: 26 is C1, 3 is L5, 1 the sacrum
  totalsegmentator_body,  ///< task `vertebrae_body`: 1 is every body, 2 every disc
  totalspineseg,          ///< 11 is C1, 21 is T1, 41 is L1, 50 the sacrum
  vertebralbodiesct,      ///< bodies: 1 is T1, 13 is L1, 19 the sacrum, 21 is T13
  spider,                 ///< 1 is L5, and on upwards
  vista3d,                ///< 56 is C1, 33 is L5, 97 the sacrum, 131 is L6
  lumbar,                 ///< 1 is L1, and on downwards
  thoracic,               ///< 1 is T1, and on downwards
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
  std::vector<std::uint8_t> labels;     ///< geometry.voxel_count() values, i fastest; 0: none
  std::map<int, LabelName> names;       ///< by label, those that occur in `labels`; no level twice
  std::string level_source{};           ///< how it is known what is which vertebra, in words; empty where nothing is
  std::vector<std::string> warnings{};  ///< what speaks against the place of the file's voxels, a line each
};

/// How read_label_volume() takes a file.
struct LabelReadOptions {
  LabelConvention convention = LabelConvention::automatic;
  NiftiAffine affine = NiftiAffine::automatic;  ///< of a NIfTI file whose two transforms differ
  /// Other than 0: only this label is wanted, whatever it is. Messages are about it, a map with no other label and no
  /// names is taken without a level, and voxels that hold no whole number from 0 to 255 count as 0.
  int wanted = 0;
};

/// Reads all labels of a map as 3D Slicer, TotalSegmentator and SPINEPS write them, NIfTI (.nii, .nii.gz), NRRD (.nrrd,
/// .nhdr, .seg.nrrd), MetaImage (.mha, .mhd), DICOM segmentation or structure set, on any grid: each voxel of
/// `ct_geometry` takes the label of the file's voxel that its centre lies in. Where no known numbering has any of the
/// labels, or the format counts its segments and names none as a vertebra, all have level kNone. Throws Error when the
/// file is none of them or damaged, has labels that are not whole numbers from 0 to 255, or none within the CT; when
/// two labels have the same level; and when the convention is automatic and the numbers can be meant in several ways or
/// in none that is known (the message lists what they would be in each), or names and the file names no vertebra.
LabelVolume read_label_volume(const std::filesystem::path& file, const GridGeometry& ct_geometry,
                              const LabelReadOptions& options = {});

/// The conventions that a map can be said to have, by the words that options and files use: "verse".
const std::map<std::string, LabelConvention>& label_conventions();

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
                                const DicomSource& source);
/// The same, naming no images.
std::string encode_label_volume(const LabelVolume& volume, const std::filesystem::path& name);

/// Whether a label map of that name is a DICOM object, which wants to name its CT's images.
bool is_dicom_label_name(const std::filesystem::path& name);

}  // namespace spinaltap
