#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/detail/dicom_elements.h"
#include "core/ct/detail/dicom_level_codes.h"
#include "core/ct/detail/label_file.h"

// Label maps as DICOM objects: segmentations (PS3.3, A.51) and structure sets (A.19).
namespace spinaltap::detail {

/// What a DICOM file is, by its SOP class.
enum class DicomKind { kNone, kSegmentation, kLabelMapSegmentation, kStructureSet, kSurfaceSegmentation, kOther };

/// kNone for what is not a DICOM file or cannot be opened.
DicomKind dicom_kind_of(const std::filesystem::path& file);

/// A segment, or a region of interest, as a file describes it.
struct DicomSegment {
  long long number = 0;
  std::string label;        ///< SegmentLabel, ROIName
  std::string description;  ///< SegmentDescription, ROIObservationLabel
  DicomCode type;           ///< SegmentedPropertyTypeCodeSequence, RTROIIdentificationCodeSequence
  DicomCode region;         ///< AnatomicRegionSequence
};

/// The first item of a code sequence, which the walker just gave.
DicomCode read_code(DicomElementWalker& walker, const DicomElement& sequence);

/// What a segment is called: the vertebra by its code, else the vertebra that its label or description names, else its
/// label. Throws Error where codes, label and description are of two vertebrae: a wrong level is worse than none.
std::string name_of_segment(const DicomSegment& segment, const std::filesystem::path& file);

/// What speaks against a segment's being the vertebra that its name says: its type is coded as something else. Nothing
/// where it is none, or nothing does.
std::optional<std::string> doubt_of_segment(const DicomSegment& segment);

/// Reads BINARY, FRACTIONAL (from half of the maximum on) and LABELMAP segmentations, frames in any order and number,
/// on the file's own grid; labels are segment numbers. With `only`, this segment alone.
///
/// Where two segments share voxels, a vertebra goes before what is none; of two that are none, the first stays. Throws
/// Error where two vertebrae share voxels, for frames that are not slices of one grid, and for what is damaged.
LabelFile read_dicom_segmentation(const std::filesystem::path& file, std::optional<long long> only,
                                  const std::function<void(const LabelFile&)>& begin, const TakeLabels& take);

/// Reads the closed planar contours of a structure set, on the CT's grid: a voxel belongs to a region where its centre
/// lies within an odd number of the region's contours of the nearest plane (holes by XOR or keyholes: PS3.3,
/// C.8.8.6.3). Labels are ROI numbers, or 1, 2, ... where those do not fit into a byte. Overlaps as above. Throws Error
/// where contours lie in planes that are not parallel to the CT's, for vertebrae without closed contours, and for what
/// is damaged.
LabelFile read_dicom_contours(const std::filesystem::path& file, const GridGeometry& ct, std::optional<long long> only,
                              const std::function<void(const LabelFile&)>& begin, const TakeLabels& take);

/// Labels of a grid that segments are put into one after the other, and what they share.
class LabelPainter {
 public:
  LabelPainter(std::size_t voxels, std::map<long long, std::string> names);

  /// Puts a voxel into a segment. `fraction`: of two that are told to be there in part, the larger one stays.
  void put(std::size_t voxel, std::uint16_t label, std::uint8_t fraction = 255);

  /// Throws Error where two vertebrae share voxels.
  void check_shared(const std::filesystem::path& file) const;

  const std::vector<std::uint16_t>& labels() const { return labels_; }
  void give_to(const TakeLabels& take) const;

 private:
  std::vector<std::uint16_t> labels_;
  std::vector<std::uint8_t> fractions_;  ///< empty until one is below 255
  std::map<long long, std::string> names_;
  std::vector<bool> is_vertebra_;  ///< by label
  std::size_t shared_ = 0;         ///< voxels of two vertebrae
  std::uint16_t first_shared_ = 0, second_shared_ = 0;
};

}  // namespace spinaltap::detail
