#include "core/ct/label_map.h"

#include <nifti2_io.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <sstream>

#include "core/base/error.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using NiftiImage = std::unique_ptr<nifti_image, void (*)(nifti_image*)>;

/// Which voxels of the file carry the label, i fastest, and where they lie.
struct LabelVoxels {
  GridGeometry grid;      ///< only the size is used
  Mat3 index_to_patient;  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm;         ///< centre of voxel (0, 0, 0), LPS
  std::vector<std::uint8_t> has_label;
};

NiftiImage open_nifti(const fs::path& file) {
  static const bool silent = [] {
    nifti_set_debug_level(0);
    return true;
  }();
  static_cast<void>(silent);
  std::error_code error;
  if (!fs::exists(file, error)) fail("no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a NIfTI file, found something else: ", file.string());
  // The library takes the format from the name, and complains aloud about other names.
  const std::string name = file.filename().string();
  if (!name.ends_with(".nii") && !name.ends_with(".nii.gz")) {
    fail("expected a NIfTI file (.nii or .nii.gz), found ", file.string());
  }
  NiftiImage image(is_nifti_file(file.c_str()) > 0 ? nifti_image_read(file.c_str(), 0) : nullptr, nifti_image_free);
  if (!image) fail("expected a NIfTI file, found one that is not or is broken: ", file.string());
  return image;
}

/// Refuses sizes that the file cannot hold, before memory is taken for them.
GridGeometry checked_size(const nifti_image& image, const fs::path& file) {
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
  GridGeometry grid;
  grid.size = {static_cast<int>(image.nx), static_cast<int>(image.ny), static_cast<int>(image.nz)};
  return grid;
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
  const double volume_mm3 = std::abs(voxels.index_to_patient.determinant());
  if (!voxels.index_to_patient.allFinite() || !voxels.origin_mm.allFinite() || !(volume_mm3 > 1e-12)) {
    fail("expected a NIfTI transform that gives voxels a volume, found one that does not in ", file.string());
  }
}

template <class Stored>
std::vector<std::uint8_t> find_label(const nifti_image& image, int label, std::set<long long>& present) {
  const bool is_scaled = std::isfinite(image.scl_slope) && image.scl_slope != 0.0 && std::isfinite(image.scl_inter) &&
                         (image.scl_slope != 1.0 || image.scl_inter != 0.0);
  const auto count = static_cast<std::size_t>(image.nvox);
  std::vector<std::uint8_t> has_label(count, 0);
  const auto* bytes = static_cast<const char*>(image.data);
  long long last = 0;
  present.insert(last);
  for (std::size_t n = 0; n < count; ++n) {
    Stored stored;
    std::memcpy(&stored, bytes + n * sizeof stored, sizeof stored);
    double value = static_cast<double>(stored);
    if (is_scaled) value = value * image.scl_slope + image.scl_inter;
    if (!(std::abs(value) < 1e15)) continue;  // no label: also not a number
    const long long found = std::llround(value);
    if (found != last) present.insert(found);
    last = found;
    has_label[n] = found == label ? 1 : 0;
  }
  present.erase(0);
  return has_label;
}

std::vector<std::uint8_t> find_label(const nifti_image& image, int label, std::set<long long>& present,
                                     const fs::path& file) {
  switch (image.datatype) {
    case NIFTI_TYPE_INT8:
      return find_label<std::int8_t>(image, label, present);
    case NIFTI_TYPE_UINT8:
      return find_label<std::uint8_t>(image, label, present);
    case NIFTI_TYPE_INT16:
      return find_label<std::int16_t>(image, label, present);
    case NIFTI_TYPE_UINT16:
      return find_label<std::uint16_t>(image, label, present);
    case NIFTI_TYPE_INT32:
      return find_label<std::int32_t>(image, label, present);
    case NIFTI_TYPE_UINT32:
      return find_label<std::uint32_t>(image, label, present);
    case NIFTI_TYPE_INT64:
      return find_label<std::int64_t>(image, label, present);
    case NIFTI_TYPE_UINT64:
      return find_label<std::uint64_t>(image, label, present);
    case NIFTI_TYPE_FLOAT32:
      return find_label<float>(image, label, present);
    case NIFTI_TYPE_FLOAT64:
      return find_label<double>(image, label, present);
    default:
      fail("expected labels stored as whole numbers or floats, found ", nifti_datatype_string(image.datatype), " in ",
           file.string());
  }
}

/// "1, 2, 22"; the first of them where there are many.
std::string list_for_people(const std::set<long long>& labels) {
  constexpr int kMost = 40;
  if (labels.empty()) return "none";
  std::ostringstream text;
  int count = 0;
  for (const long long label : labels) {
    if (++count > kMost) {
      text << ", ... (" << labels.size() << " in all)";
      break;
    }
    text << (count > 1 ? ", " : "") << label;
  }
  return text.str();
}

LabelVoxels load(const fs::path& file, int label) {
  const NiftiImage image = open_nifti(file);
  LabelVoxels voxels;
  voxels.grid = checked_size(*image, file);
  set_transform(*image, file, voxels);
  if (nifti_image_load(image.get()) != 0 || image->data == nullptr) {
    fail("cannot read the voxels (file cut short?) of ", file.string());
  }
  std::set<long long> present;
  voxels.has_label = find_label(*image, label, present, file);
  if (label == 0 || !present.contains(label)) {
    fail("no label ", label, " in ", file.string(), "; there are: ", list_for_people(present));
  }
  return voxels;
}

}  // namespace

BoneMask read_label_map(const fs::path& file, int label, const GridGeometry& ct_geometry) {
  check_geometry(ct_geometry, "CT");
  const LabelVoxels voxels = load(file, label);
  const Mat3 to_file = voxels.index_to_patient.inverse();
  const Mat3 step = to_file * ct_geometry.index_to_patient_matrix();
  const Vec3 start = to_file * (ct_geometry.origin_mm - voxels.origin_mm);

  BoneMask mask{ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0)};
  std::atomic<bool> found{false};
  tbb::parallel_for(0, ct_geometry.size[2], [&](int k) {
    for (int j = 0; j < ct_geometry.size[1]; ++j) {
      for (int i = 0; i < ct_geometry.size[0]; ++i) {
        const Vec3 p_file = start + step * Vec3(i, j, k);
        const Eigen::Array3d nearest = (p_file.array() + 0.5).floor();
        const auto inside_axis = [&](int axis) {
          return nearest[axis] >= 0.0 && nearest[axis] < voxels.grid.size[static_cast<std::size_t>(axis)];
        };
        if (!inside_axis(0) || !inside_axis(1) || !inside_axis(2)) continue;
        const std::size_t offset = voxels.grid.offset(static_cast<int>(nearest[0]), static_cast<int>(nearest[1]),
                                                      static_cast<int>(nearest[2]));
        if (voxels.has_label[offset] == 0) continue;
        mask.inside[ct_geometry.offset(i, j, k)] = 1;
        found.store(true, std::memory_order_relaxed);
      }
    }
  });
  if (!found) fail("expected label ", label, " within the CT, found it only outside: ", file.string());
  return mask;
}

}  // namespace spinaltap
