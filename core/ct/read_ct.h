#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct CtReadOptions {
  std::string series;     ///< SeriesInstanceUID or number, where a folder holds several
  bool resample = false;  ///< interpolate unequal steps, gaps of up to 6 mm and uneven sideways shifts of DICOM slices
};

/// Whether the name is one of a NIfTI file: .nii or .nii.gz.
bool is_nifti_name(const std::filesystem::path& path);

/// Reads a CT from wherever it is: a folder with a DICOM series, one DICOM file of many frames, or a NIfTI file.
/// As read_dicom() and read_nifti_ct(); throws what they throw.
CtVolume read_ct(const std::filesystem::path& path, const CtReadOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
