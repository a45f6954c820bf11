#pragma once

#include <vector>

#include "core/ct/detail/dicom_header.h"

namespace spinaltap {

/// The functional groups of a multi-frame file (PS3.3, C.7.6.16): what all frames share, and what each has of its own.
struct DicomFrameGroups {
  std::vector<double> frame_count;  ///< NumberOfFrames as stated; empty where it is missing
  std::vector<DicomFrame> shared;   ///< one, or none
  std::vector<DicomFrame> per_frame;
};

/// Reads a SharedFunctionalGroupsSequence or PerFrameFunctionalGroupsSequence, which the walker just gave: an entry an
/// item. Of the groups, those that place a frame and rescale it: plane position, plane orientation, pixel measures,
/// pixel value transformation, the stack of the frame content, and what tells acquisitions apart.
std::vector<DicomFrame> read_functional_groups(DicomElementWalker& walker, const DicomElement& sequence);

/// All pixels of a file, before they are shared out to frames.
struct DicomPixelData {
  ByteRange plain;
  DicomFragments encapsulated;
};

/// One header a frame, each with its own place, rescaling and pixels. `file` holds what all have in common.
/// Throws Error when the pixels are not enough for the frames or cannot be told apart.
std::vector<DicomHeader> split_into_frames(const DicomHeader& file, const DicomFrameGroups& groups,
                                           const DicomPixelData& pixels);

}  // namespace spinaltap
