#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/ct/detail/dicom_frames.h"
#include "core/ct/detail/dicom_labels.h"

namespace spinaltap::detail {

/// What functional groups say of a frame; lists are empty where they say nothing.
struct SegmentFrame {
  std::vector<double> position_mm, orientation, pixel_spacing_mm, step_mm, thickness_mm;
  std::uint32_t segment = 0;
};

/// What a DICOM segmentation says before its pixels are decoded.
struct DicomSegmentation {
  DicomHeader header;
  std::string type;                ///< BINARY, FRACTIONAL, LABELMAP
  std::uint32_t max_fraction = 0;  ///< MaximumFractionalValue; 0: not said
  std::vector<DicomSegment> segments;
  std::vector<double> frame_count;
  SegmentFrame shared;
  std::vector<SegmentFrame> frames;
  DicomPixelData pixels;
  bool has_pixels = false;
};

/// Frames come with what all share: each has a place, a segment and pixels. Throws Error for what is damaged, of
/// another type, or does not say these.
DicomSegmentation read_segmentation_head(const std::filesystem::path& file);

}  // namespace spinaltap::detail
