#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct DicomWriteOptions {
  std::string series_description = "SpinalTap virtual scan";
  double slice_thickness_mm = 0.0;  ///< written as SliceThickness; 0: the slice step
};

/// Writes one CT Image Storage file a slice (0001.dcm, 0002.dcm, ...) into an existing folder: explicit VR little
/// endian, 16 bit signed, rescale slope 1 and intercept 0. UIDs derive from the volume's hash, so the same volume gives
/// the same bytes. Throws Error when a file cannot be written.
void write_dicom(const CtVolume& ct, const std::filesystem::path& folder, const DicomWriteOptions& options = {},
                 const Progress& progress = {});

}  // namespace spinaltap
