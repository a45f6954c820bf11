#include "core/ct/detail/nifti_read.h"

#include "core/ct/detail/nifti_volume.h"
#include "core/ct/detail/volume_file.h"

namespace spinaltap {

CtVolume read_nifti_ct(const std::filesystem::path& file, NiftiAffine affine, const Progress& progress) {
  const NiftiVolume nifti(file, affine);
  detail::VolumeFile volume;
  volume.format = "NIfTI";
  volume.size = nifti.size();
  volume.index_to_patient = nifti.index_to_patient();
  volume.origin_mm = nifti.origin_mm();
  volume.read_values = [&](const detail::TakeValues& take) { nifti.read_values(take); };
  CtVolume ct = detail::ct_of_volume(volume, file, progress);
  ct.warnings = nifti.warnings();
  return ct;
}

}  // namespace spinaltap
