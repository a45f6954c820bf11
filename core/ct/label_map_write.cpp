#include <nifti1.h>

#include <bit>
#include <cstring>
#include <sstream>

#include "core/base/error.h"
#include "core/base/gzip.h"
#include "core/ct/label_map.h"
#include "core/ct/nrrd_head.h"

namespace spinaltap {
namespace {

static_assert(std::endian::native == std::endian::little, "the formats are written in little-endian order");

/// One byte a voxel where the label fits, else two.
std::string voxel_bytes(const BoneMask& mask, int label) {
  if (label <= 255) {
    std::string bytes(mask.inside.size(), '\0');
    for (std::size_t v = 0; v < bytes.size(); ++v) bytes[v] = static_cast<char>(mask.inside[v] != 0 ? label : 0);
    return bytes;
  }
  std::string bytes(2 * mask.inside.size(), '\0');
  for (std::size_t v = 0; v < mask.inside.size(); ++v) {
    const auto value = static_cast<std::int16_t>(mask.inside[v] != 0 ? label : 0);
    std::memcpy(bytes.data() + 2 * v, &value, 2);
  }
  return bytes;
}

/// NIfTI's frame is RAS (x to the right, y anterior): both turn round here.
std::string nifti_header(const GridGeometry& geometry, int label) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  header.dim[0] = 3;
  for (std::size_t axis = 0; axis < 7; ++axis) header.dim[axis + 1] = 1;
  const Mat3 matrix = geometry.index_to_patient_matrix();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.dim[axis + 1] = static_cast<short>(geometry.size[axis]);
    header.pixdim[axis + 1] = static_cast<float>(geometry.spacing_mm[static_cast<Eigen::Index>(axis)]);
  }
  header.pixdim[0] = 1.0F;
  header.datatype = label <= 255 ? DT_UINT8 : DT_INT16;
  header.bitpix = label <= 255 ? 8 : 16;
  header.vox_offset = 352.0F;
  header.scl_slope = 1.0F;
  header.xyzt_units = NIFTI_UNITS_MM;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  float* const rows[3] = {header.srow_x, header.srow_y, header.srow_z};
  for (int row = 0; row < 3; ++row) {
    const double sign = row < 2 ? -1.0 : 1.0;
    for (int column = 0; column < 3; ++column) rows[row][column] = static_cast<float>(sign * matrix(row, column));
    rows[row][3] = static_cast<float>(sign * geometry.origin_mm[row]);
  }
  std::memcpy(header.magic, "n+1", 4);
  std::string bytes(352, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

std::string nrrd_header(const GridGeometry& geometry, int label, bool is_segmentation) {
  std::ostringstream text;
  text << nrrd_head(geometry, label <= 255 ? "unsigned char" : "short", "gzip");
  if (is_segmentation) {
    text << "Segment0_ID:=vertebra\nSegment0_Name:=vertebra\nSegment0_Color:=0.95 0.84 0.57\nSegment0_LabelValue:="
         << label << "\nSegment0_Layer:=0\nSegment0_Extent:=0 " << geometry.size[0] - 1 << " 0 " << geometry.size[1] - 1
         << " 0 " << geometry.size[2] - 1 << "\nSegmentation_MasterRepresentation:=Binary labelmap\n";
  }
  text << '\n';
  return text.str();
}

}  // namespace

std::string encode_label_map(const BoneMask& mask, int label, const std::filesystem::path& name) {
  check_geometry(mask.geometry, "label map");
  if (label < 1 || label > 32767) fail("expected a label from 1 to 32767, found ", label);
  const std::string file = name.filename().string();
  if (file.ends_with(".nrrd")) {
    return nrrd_header(mask.geometry, label, file.ends_with(".seg.nrrd")) + gzip(voxel_bytes(mask, label));
  }
  if (file.ends_with(".nii") || file.ends_with(".nii.gz")) {
    for (const int size : mask.geometry.size) {
      if (size > 32767) fail("expected at most 32767 voxels along each axis for NIfTI, found ", size);
    }
    const std::string bytes = nifti_header(mask.geometry, label) + voxel_bytes(mask, label);
    return file.ends_with(".gz") ? gzip(bytes) : bytes;
  }
  fail("expected a label map's name to end in .nii, .nii.gz, .nrrd or .seg.nrrd, found ", name.string());
}

}  // namespace spinaltap
