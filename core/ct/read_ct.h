#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// How read_ct() takes files.
struct CtReadOptions {
  std::string series{};   ///< SeriesInstanceUID or number, where a folder holds several
  int stack = 0;          ///< which of the series' stacks, from 1, where it holds several acquisitions; 0: the only one
  bool resample = false;  ///< interpolate unequal steps, gaps of up to 6 mm and uneven sideways shifts of DICOM slices
  /// What to make of the numbers, for who knows their unit; other than none, DICOM slices that state no rescaling are
  /// read too.
  HuChange hu = {};
  NiftiAffine affine = NiftiAffine::automatic;  ///< of a NIfTI file whose two transforms differ
};

/// Whether the path is a file of a format that holds one CT, NIfTI, NRRD or MetaImage, and not DICOM's.
bool is_one_volume(const std::filesystem::path& path);

/// Throws Error for a file that is none that read_ct() reads, with the formats that are read and what to do. Says
/// nothing of folders, and of what does not exist.
void check_ct_file(const std::filesystem::path& file);

/// Reads a CT from wherever it is: a folder with a DICOM series, one DICOM file of many frames, or a file of NIfTI
/// (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha, .mhd), known by what it begins with; with what check_hu()
/// says of its values. Throws Error for what is damaged, does not say where it lies, or is none of these, with what can
/// be done about that.
CtVolume read_ct(const std::filesystem::path& path, const CtReadOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
