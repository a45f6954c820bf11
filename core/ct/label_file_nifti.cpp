#include "core/ct/label_file.h"
#include "core/ct/nifti_volume.h"

namespace spinaltap::detail {

LabelVoxels load_nifti_label(const std::filesystem::path& file, int label) {
  const NiftiVolume nifti(file);
  LabelVoxels voxels;
  voxels.size = nifti.size();
  voxels.index_to_patient = nifti.index_to_patient();
  voxels.origin_mm = nifti.origin_mm();
  voxels.has_label.reserve(nifti.voxel_count());
  nifti.read_values([&](std::span<const double> values) { find_label(values, label, voxels); });
  return voxels;
}

}  // namespace spinaltap::detail
