#pragma once

#include <string>
#include <vector>

#include "core/ct/detail/dicom_header.h"

namespace spinaltap {

/// Slices of one acquisition in one frame of reference, which may be put together.
struct DicomPart {
  std::vector<DicomHeader> headers;
  std::string told_apart_by;          ///< the attributes that part it from others of its series; empty: none do
  std::vector<std::string> notes;     ///< what was assumed
  std::vector<std::string> warnings;  ///< what one slice says otherwise than the rest
};

/// Parts slices of one series, size and orientation into acquisitions:
/// - by FrameOfReferenceUID, since positions of two frames cannot be compared (PS3.3, C.7.4.1); where each slice has
/// one
///   of its own, or there are more than eight, as after some anonymizers, it says nothing;
/// - by ConvolutionKernel, KVP, ImageType and ContrastBolusAgent, where two slices or more share each value; a single
///   slice that differs is warned of;
/// - by temporal position, cardiac phase, AcquisitionNumber and AcquisitionTime only where two slices lie at one place,
///   or where the values take turns along the stack: ordinary helical and step-and-shoot series count on from slice to
///   slice.
/// Copies of a slice (the same SOPInstanceUID, or the same place and attributes, with the same pixels) count once.
/// Throws Error for one SOPInstanceUID with two contents. In an order that files' names do not change.
std::vector<DicomPart> part_into_acquisitions(std::vector<DicomHeader> headers);

}  // namespace spinaltap
