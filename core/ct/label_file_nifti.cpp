#include <nifti2_io.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/error.h"
#include "core/ct/label_file.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;
using NiftiImage = std::unique_ptr<nifti_image, void (*)(nifti_image*)>;

NiftiImage open_nifti(const fs::path& file) {
  static const bool silent = [] {
    nifti_set_debug_level(0);
    return true;
  }();
  static_cast<void>(silent);
  NiftiImage image(is_nifti_file(file.c_str()) > 0 ? nifti_image_read(file.c_str(), 0) : nullptr, nifti_image_free);
  if (!image) fail("expected a NIfTI file, found one that is not or is broken: ", file.string());
  return image;
}

/// Refuses sizes that the file cannot hold, before memory is taken for them.
std::array<int, 3> checked_size(const nifti_image& image, const fs::path& file) {
  constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 30;
  std::int64_t voxels = 1;
  for (int axis = 1; axis <= 7; ++axis) {
    const std::int64_t size = axis <= image.ndim ? image.dim[axis] : 1;
    if (size < 1 || size > kMaxVoxels / voxels || (axis > 3 && size != 1)) {
      fail("expected one volume of at most ", kMaxVoxels, " voxels, found ", image.nx, " x ", image.ny, " x ", image.nz,
           " x ", image.nt, " in ", file.string());
    }
    voxels *= size;
  }
  // Deflate shrinks by a factor of 1032 at most.
  std::error_code error;
  const std::uintmax_t bytes_on_disk = fs::file_size(file, error);
  const std::uintmax_t most_bytes = file.extension() == ".gz" ? bytes_on_disk * 1032 : bytes_on_disk;
  const auto wanted = static_cast<std::uintmax_t>(voxels) * static_cast<std::uintmax_t>(std::max(image.nbyper, 0));
  if (error || image.nvox != voxels || wanted > most_bytes) {
    fail("expected ", wanted, " bytes of voxels, found a file of ", bytes_on_disk,
         " bytes (cut short?): ", file.string());
  }
  return {static_cast<int>(image.nx), static_cast<int>(image.ny), static_cast<int>(image.nz)};
}

double unit_in_mm(const nifti_image& image) {
  switch (image.xyz_units) {
    case NIFTI_UNITS_METER:
      return 1000.0;
    case NIFTI_UNITS_MICRON:
      return 0.001;
    default:
      return 1.0;
  }
}

/// NIfTI's frame is RAS (x to the right, y anterior): both turn round here.
void set_transform(const nifti_image& image, const fs::path& file, LabelVoxels& voxels) {
  if (image.sform_code <= 0 && image.qform_code <= 0) {
    fail("expected a NIfTI sform or qform that says where the voxels lie, found neither in ", file.string());
  }
  const nifti_dmat44& ras = image.sform_code > 0 ? image.sto_xyz : image.qto_xyz;
  for (int row = 0; row < 3; ++row) {
    const double scale = unit_in_mm(image) * (row < 2 ? -1.0 : 1.0);
    for (int column = 0; column < 3; ++column) voxels.index_to_patient(row, column) = scale * ras.m[row][column];
    voxels.origin_mm[row] = scale * ras.m[row][3];
  }
  check_transform(voxels, file.string());
}

Stored stored_as(const nifti_image& image, const fs::path& file) {
  switch (image.datatype) {
    case NIFTI_TYPE_INT8:
      return Stored::kInt8;
    case NIFTI_TYPE_UINT8:
      return Stored::kUint8;
    case NIFTI_TYPE_INT16:
      return Stored::kInt16;
    case NIFTI_TYPE_UINT16:
      return Stored::kUint16;
    case NIFTI_TYPE_INT32:
      return Stored::kInt32;
    case NIFTI_TYPE_UINT32:
      return Stored::kUint32;
    case NIFTI_TYPE_INT64:
      return Stored::kInt64;
    case NIFTI_TYPE_UINT64:
      return Stored::kUint64;
    case NIFTI_TYPE_FLOAT32:
      return Stored::kFloat32;
    case NIFTI_TYPE_FLOAT64:
      return Stored::kFloat64;
    default:
      fail("expected labels stored as whole numbers or floats, found ", nifti_datatype_string(image.datatype), " in ",
           file.string());
  }
}

}  // namespace

LabelVoxels load_nifti_label(const fs::path& file, int label) {
  const NiftiImage image = open_nifti(file);
  LabelVoxels voxels;
  voxels.size = checked_size(*image, file);
  set_transform(*image, file, voxels);
  const Stored stored = stored_as(*image, file);
  if (nifti_image_load(image.get()) != 0 || image->data == nullptr) {
    fail("cannot read the voxels (file cut short?) of ", file.string());
  }
  const bool is_scaled = std::isfinite(image->scl_slope) && image->scl_slope != 0.0 && std::isfinite(image->scl_inter);
  find_label(stored, {static_cast<const char*>(image->data), static_cast<std::size_t>(image->nvox) * bytes_of(stored)},
             is_scaled ? image->scl_slope : 1.0, is_scaled ? image->scl_inter : 0.0, label, voxels);
  return voxels;
}

}  // namespace spinaltap::detail
