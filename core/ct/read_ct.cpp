#include "core/ct/read_ct.h"

#include "core/base/error.h"
#include "core/ct/detail/nifti_read.h"
#include "core/ct/dicom_read.h"

namespace spinaltap {

bool is_nifti_name(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".nii") || name.ends_with(".nii.gz");
}

CtVolume read_ct(const std::filesystem::path& path, const CtReadOptions& options, const Progress& progress) {
  std::error_code error;
  if (!is_nifti_name(path) || std::filesystem::is_directory(path, error)) {
    return read_dicom(path, {.series = options.series, .resample = options.resample}, progress);
  }
  if (!options.series.empty()) {
    fail("expected no series for a NIfTI file, which holds one CT, found \"", options.series, "\" for ", path.string());
  }
  return read_nifti_ct(path, progress);
}

}  // namespace spinaltap
