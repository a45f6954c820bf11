#pragma once

#include <string>

#include "core/ct/dicom_source.h"
#include "core/ct/label_volume.h"

namespace spinaltap::detail {

/// A label map as a DICOM segmentation (PS3.3, A.51): BINARY, one segment a label in the order of their numbers, frames
/// of the slices that have any of it, explicit little endian. Codes say which vertebra a segment is.
std::string encode_dicom_segmentation(const LabelVolume& volume, const DicomSource& source);

/// A label map as a DICOM structure set (PS3.3, A.19): closed planar contours half-way between voxels in and out, holes
/// as keyholes, so that the centres within one of a slice's contours are the label's voxels again; implicit little
/// endian, whose contours may have any length.
std::string encode_dicom_contours(const LabelVolume& volume, const DicomSource& source);

}  // namespace spinaltap::detail
