#include "core/ct/detail/nifti_volume.h"

#include <nifti2_io.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/stored_voxels.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using NiftiImage = std::unique_ptr<nifti_image, void (*)(nifti_image*)>;
using GzFile = std::unique_ptr<gzFile_s, int (*)(gzFile)>;

constexpr std::array<const char*, 4> kEndings{".nii", ".nii.gz", ".NII", ".NII.GZ"};
constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 30;
constexpr std::size_t kHeader1 = 348;  ///< bytes of a NIfTI-1 header
constexpr std::size_t kHeader2 = 540;  ///< and of a NIfTI-2 header

[[noreturn]] void fail_not_nifti(const fs::path& file) {
  fail("expected a NIfTI file, found one that is not or is broken: ", file.string());
}

/// A plain file or a gzipped one.
GzFile open_bytes(const fs::path& file) {
  GzFile bytes(::gzopen(file.c_str(), "rb"), ::gzclose);
  if (!bytes) fail_as(ErrorKind::file, "cannot open ", file.string());
  ::gzbuffer(bytes.get(), 1 << 17);
  return bytes;
}

template <class Number>
Number number_at(const std::vector<char>& bytes, std::size_t at, bool swapped) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), bytes.data() + at, raw.size());
  if (swapped) std::reverse(raw.begin(), raw.end());
  Number number;
  std::memcpy(&number, raw.data(), raw.size());
  return number;
}

/// What the library takes for granted, so that it can be given any file: marks, sizes, and where the voxels begin.
/// Gives the voxels' steps as the header has them, in its unit: the library would put 1 where there are none.
Vec3 check_header(const fs::path& file) {
  std::vector<char> bytes(kHeader2, '\0');
  const int found = ::gzread(open_bytes(file).get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (found < static_cast<int>(kHeader1)) fail_not_nifti(file);
  const auto is_size = [&](bool swapped) {
    const auto size = number_at<std::int32_t>(bytes, 0, swapped);
    return size == kHeader1 || (size == kHeader2 && found == static_cast<int>(kHeader2));
  };
  const bool swapped = !is_size(false);
  if (!is_size(swapped)) fail_not_nifti(file);
  const bool is_second = number_at<std::int32_t>(bytes, 0, swapped) == kHeader2;
  if (std::memcmp(bytes.data() + (is_second ? 4 : 344), is_second ? "n+2" : "n+1", 4) != 0) {
    fail("expected a NIfTI file with header and voxels in one, found another: ", file.string());
  }
  const auto dim = [&](std::size_t n) -> std::int64_t {
    return is_second ? number_at<std::int64_t>(bytes, 16 + 8 * n, swapped)
                     : number_at<std::int16_t>(bytes, 40 + 2 * n, swapped);
  };
  const std::int64_t axes = dim(0);
  if (axes < 1 || axes > 7) fail_not_nifti(file);
  std::int64_t voxels = 1;
  for (std::int64_t axis = 1; axis <= axes; ++axis) {
    const std::int64_t size = dim(static_cast<std::size_t>(axis));
    if (size < 1 || size > kMaxVoxels / voxels || (axis > 3 && size != 1)) {
      fail("expected one volume of at most ", kMaxVoxels, " voxels, found ", size, " along axis ", axis, " in ",
           file.string());
    }
    voxels *= size;
  }
  // Extensions stand before the voxels; no known one is this long.
  constexpr double kMaxOffset = 1 << 24;
  const double offset = is_second ? static_cast<double>(number_at<std::int64_t>(bytes, 168, swapped))
                                  : static_cast<double>(number_at<float>(bytes, 108, swapped));
  if (!(offset >= 0.0 && offset <= kMaxOffset)) fail_not_nifti(file);
  const auto real = [&](std::size_t first, std::size_t second) -> double {
    return is_second ? number_at<double>(bytes, second, swapped)
                     : static_cast<double>(number_at<float>(bytes, first, swapped));
  };
  // The library would take a scale that is no number for none.
  const double slope = real(112, 176);
  const double intercept = real(116, 184);
  if (!std::isfinite(slope) || !std::isfinite(intercept)) {
    fail("expected scl_slope and scl_inter to be numbers, found ", slope, " and ", intercept, " in ", file.string());
  }
  return {real(80, 112), real(84, 120), real(88, 128)};
}

NiftiImage open_nifti(const fs::path& file, Vec3& pixdim) {
  static const bool silent = [] {
    nifti_set_debug_level(0);
    return true;
  }();
  static_cast<void>(silent);
  std::error_code error;
  if (!fs::exists(file, error)) fail_as(ErrorKind::file, "no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a NIfTI file, found something else: ", file.string());
  // The library takes the format from the name, and complains aloud about other names.
  const std::string name = file.filename().string();
  const bool is_known =
      std::any_of(kEndings.begin(), kEndings.end(), [&](const char* one) { return name.ends_with(one); });
  if (!is_known) {
    fail("expected a name that ends in .nii or .nii.gz, all in small letters or in capitals, found ", file.string());
  }
  pixdim = check_header(file);
  NiftiImage image(nifti_image_read(file.c_str(), 0), nifti_image_free);
  if (!image) fail_not_nifti(file);
  return image;
}

/// Rejects sizes that the file cannot hold, before memory is taken for them.
void check_size(const nifti_image& image, const fs::path& file) {
  // Deflate shrinks by a factor of 1032 at most.
  std::error_code error;
  const std::uintmax_t bytes_on_disk = fs::file_size(file, error);
  const std::uintmax_t max_bytes =
      lower_case(file.extension().string()) == ".gz" ? bytes_on_disk * 1032 : bytes_on_disk;
  const auto wanted = static_cast<std::uintmax_t>(image.nvox) * static_cast<std::uintmax_t>(std::max(image.nbyper, 0));
  if (error || image.nvox < 1 || image.nvox > kMaxVoxels || image.nvox != image.nx * image.ny * image.nz ||
      wanted > max_bytes) {
    fail("expected ", wanted, " bytes of voxels, found a file of ", bytes_on_disk,
         " bytes (cut short?): ", file.string());
  }
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

template <class Stored>
void convert(const std::vector<char>& bytes, bool swapped, std::span<double> values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    std::array<char, sizeof(Stored)> raw{};
    std::memcpy(raw.data(), bytes.data() + n * raw.size(), raw.size());
    if (swapped) std::reverse(raw.begin(), raw.end());
    Stored stored;
    std::memcpy(&stored, raw.data(), raw.size());
    values[n] = static_cast<double>(stored);
  }
}

NiftiTransform transform_of(int code, const nifti_dmat44& ras, double unit_mm) {
  NiftiTransform form;
  form.code = code;
  if (!form.is_there()) return form;
  for (int row = 0; row < 3; ++row) {
    const double scale = unit_mm * (row < 2 ? -1.0 : 1.0);
    for (int column = 0; column < 3; ++column) form.steps_mm(row, column) = scale * ras.m[row][column];
    form.origin_mm[row] = scale * ras.m[row][3];
  }
  return form;
}

/// The fourth part of a quaternion is the root of what the other three leave of 1. Near half a turn it is small, and
/// the rounding of the others to 32 bits is large beside it; the library takes it for 0 where its square is below 1e-7.
double rounding_of_qform(const nifti_image& image) {
  constexpr double kFloat = 6e-8;
  const double squares =
      image.quatern_b * image.quatern_b + image.quatern_c * image.quatern_c + image.quatern_d * image.quatern_d;
  const double fourth = std::sqrt(std::max(0.0, 1.0 - squares));
  return 6.0 * kFloat + 2.0 * std::min(2.0 * kFloat / std::max(fourth, 1e-9), std::sqrt(1e-7));
}

NiftiForms forms_of(const nifti_image& image, const Vec3& pixdim, const fs::path& file) {
  constexpr double kMaxSquares = 1.001;  // of what a quaternion of length 1 can have, with rounding
  const double unit_mm = unit_in_mm(image);
  NiftiForms forms;
  forms.size = {static_cast<int>(image.nx), static_cast<int>(image.ny), static_cast<int>(image.nz)};
  forms.sform = transform_of(image.sform_code, image.sto_xyz, unit_mm);
  forms.qform = transform_of(image.qform_code, image.qto_xyz, unit_mm);
  forms.pixdim_mm = unit_mm * pixdim;
  forms.qform_rounding_rad = rounding_of_qform(image);
  forms.unit = image.xyz_units;
  const double squares =
      image.quatern_b * image.quatern_b + image.quatern_c * image.quatern_c + image.quatern_d * image.quatern_d;
  if (forms.qform.is_there() && !forms.sform.is_there() && !(squares <= kMaxSquares)) {
    fail("expected a quaternion whose squares add to 1 at most, found ", squares, " in ", file.string());
  }
  return forms;
}

using Convert = void (*)(const std::vector<char>&, bool, std::span<double>);

/// Null for types that are not one plain number a voxel.
Convert convert_of(int type) {
  switch (type) {
    case NIFTI_TYPE_INT8:
      return convert<std::int8_t>;
    case NIFTI_TYPE_UINT8:
      return convert<std::uint8_t>;
    case NIFTI_TYPE_INT16:
      return convert<std::int16_t>;
    case NIFTI_TYPE_UINT16:
      return convert<std::uint16_t>;
    case NIFTI_TYPE_INT32:
      return convert<std::int32_t>;
    case NIFTI_TYPE_UINT32:
      return convert<std::uint32_t>;
    case NIFTI_TYPE_INT64:
      return convert<std::int64_t>;
    case NIFTI_TYPE_UINT64:
      return convert<std::uint64_t>;
    case NIFTI_TYPE_FLOAT32:
      return convert<float>;
    case NIFTI_TYPE_FLOAT64:
      return convert<double>;
    default:
      return nullptr;
  }
}

}  // namespace

NiftiVolume::NiftiVolume(const fs::path& file, NiftiAffine affine) : file_(file) {
  Vec3 pixdim;
  const NiftiImage image = open_nifti(file, pixdim);
  check_size(*image, file);
  size_ = {static_cast<int>(image->nx), static_cast<int>(image->ny), static_cast<int>(image->nz)};
  place_ = place_nifti(forms_of(*image, pixdim, file), affine, file.string());
  type_ = image->datatype;
  value_bytes_ = image->nbyper;
  if (convert_of(type_) == nullptr) {
    fail("expected values stored as whole numbers or floats, found ", nifti_datatype_string(type_), " in ",
         file.string());
  }
  is_swapped_ = image->byteorder != nifti_short_order();
  values_at_ = image->iname_offset;
  // A slope of 0 means that values are stored as they are.
  if (image->scl_slope == 0.0) return;
  slope_ = image->scl_slope;
  intercept_ = image->scl_inter;
}

std::size_t NiftiVolume::voxel_count() const {
  return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]);
}

// Not the library's own reading: it makes 0 of what is not a number, and takes memory for the whole file at once.
void NiftiVolume::read_values(const std::function<void(std::span<const double>)>& take) const {
  constexpr std::size_t kChunk = 65536;
  const GzFile file = open_bytes(file_);
  const bool is_there = ::gzseek(file.get(), values_at_, SEEK_SET) == values_at_;
  std::vector<char> bytes;
  std::vector<double> values;
  for (std::size_t left = voxel_count(); left > 0; left -= values.size()) {
    values.resize(std::min(kChunk, left));
    bytes.resize(values.size() * static_cast<std::size_t>(value_bytes_));
    const int found = is_there ? ::gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size())) : -1;
    if (found != static_cast<int>(bytes.size())) {
      fail("cannot read the voxels (file cut short?) of ", file_.string());
    }
    convert_of(type_)(bytes, is_swapped_, values);
    if (slope_ != 1.0 || intercept_ != 0.0) {
      for (double& value : values) value = value * slope_ + intercept_;
    }
    take(values);
  }
  std::array<char, detail::kMaxSurplus + 1> more{};
  if (::gzread(file.get(), more.data(), more.size()) > detail::kMaxSurplus) {
    fail("expected ", voxel_count() * static_cast<std::size_t>(value_bytes_),
         " bytes of voxels, found more (other sizes or another type than the header says?): ", file_.string());
  }
}

// Extensions: nifti1.h, "EXTENDED HEADER STRUCTURE". Four bytes behind the header, of which the first says whether
// there are any; then for each its size, sizes included, its code, and its content.
std::vector<std::string> NiftiVolume::read_extensions() const {
  const auto end = static_cast<std::size_t>(std::max<std::int64_t>(values_at_, 0));
  std::vector<char> bytes(end, '\0');
  const int found = ::gzread(open_bytes(file_).get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (end < kHeader1 + 4 || found != static_cast<int>(end)) return {};
  const bool is_second = number_at<std::int32_t>(bytes, 0, is_swapped_) == static_cast<std::int32_t>(kHeader2);
  std::size_t at = (is_second ? kHeader2 : kHeader1) + 4;
  if (at > end || bytes[at - 4] == 0) return {};
  constexpr std::size_t kHead = 8;
  std::vector<std::string> extensions;
  while (at + kHead <= end) {
    const auto size = number_at<std::int32_t>(bytes, at, is_swapped_);
    if (size < static_cast<std::int32_t>(kHead) || static_cast<std::size_t>(size) > end - at) break;
    extensions.emplace_back(bytes.data() + at + kHead, static_cast<std::size_t>(size) - kHead);
    at += static_cast<std::size_t>(size);
  }
  return extensions;
}

}  // namespace spinaltap
