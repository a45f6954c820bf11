#include "core/ct/label_map.h"

#include <nifti1.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include "core/base/error.h"
#include "core/base/gzip.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_label_writer.h"
#include "core/ct/detail/label_colour.h"
#include "core/ct/detail/label_file.h"
#include "core/ct/label_volume.h"
#include "core/ct/nrrd_head.h"

namespace spinaltap {
namespace {

static_assert(std::endian::native == std::endian::little, "the formats are written in little-endian order");

/// What a label map's file holds beside its voxels.
struct Segment {
  int label = 0;
  std::string id;
  std::string name;
  std::string colour;  ///< red, green and blue from 0 to 1, as 3D Slicer writes them
};

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

/// The names as an extension of NIfTI's: a label table in XML.
std::string nifti_extension(const std::vector<Segment>& segments) {
  TextWriter xml;
  xml << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CaretExtension>\n<VolumeInformation "
         "Index=\"0\">\n<LabelTable>\n";
  for (const Segment& segment : segments) {
    std::istringstream colour(segment.colour);
    colour.imbue(std::locale::classic());
    double red = 0.0, green = 0.0, blue = 0.0;
    colour >> red >> green >> blue;
    xml << "<Label Key=\"" << segment.label << "\" Red=\"" << red << "\" Green=\"" << green << "\" Blue=\"" << blue
        << "\" Alpha=\"1\"><![CDATA[" << segment.name << "]]></Label>\n";
  }
  xml << "</LabelTable>\n</VolumeInformation>\n</CaretExtension>\n";
  constexpr std::size_t kStep = 16;    // of an extension's size
  constexpr std::int32_t kCaret = 30;  // the registered code of such XML
  std::string content = xml.str();
  content.resize((content.size() + 8 + kStep - 1) / kStep * kStep - 8, '\0');
  const std::int32_t head[2] = {static_cast<std::int32_t>(content.size() + 8), kCaret};
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), head, sizeof head);
  return bytes + content;
}

/// The same place as a quaternion: ITK 5.2 takes no sform alone whose 32 bits leave its axes at right angles by less
/// than 1e-4.
void set_qform(const GridGeometry& geometry, nifti_1_header& header) {
  Mat3 turn = Vec3(-1.0, -1.0, 1.0).asDiagonal() * geometry.directions;
  const bool is_mirrored = turn.determinant() < 0.0;
  if (is_mirrored) turn.col(2) *= -1.0;
  header.pixdim[0] = is_mirrored ? -1.0F : 1.0F;
  Eigen::Quaterniond quaternion(turn);
  quaternion.normalize();
  if (quaternion.w() < 0.0) quaternion.coeffs() *= -1.0;
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.quatern_b = static_cast<float>(quaternion.x());
  header.quatern_c = static_cast<float>(quaternion.y());
  header.quatern_d = static_cast<float>(quaternion.z());
  header.qoffset_x = static_cast<float>(-geometry.origin_mm.x());
  header.qoffset_y = static_cast<float>(-geometry.origin_mm.y());
  header.qoffset_z = static_cast<float>(geometry.origin_mm.z());
}

/// NIfTI's frame is RAS (x to the right, y anterior): both turn round here.
std::string nifti_header(const GridGeometry& geometry, bool is_wide, const std::string& extension) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  header.dim[0] = 3;
  for (std::size_t axis = 0; axis < 7; ++axis) header.dim[axis + 1] = 1;
  const Mat3 matrix = geometry.index_to_patient_matrix();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.dim[axis + 1] = static_cast<short>(geometry.size[axis]);
    header.pixdim[axis + 1] = static_cast<float>(geometry.spacing_mm[static_cast<Eigen::Index>(axis)]);
  }
  header.datatype = is_wide ? DT_INT16 : DT_UINT8;
  header.bitpix = is_wide ? 16 : 8;
  header.vox_offset = static_cast<float>(352 + extension.size());
  header.scl_slope = 1.0F;
  header.xyzt_units = NIFTI_UNITS_MM;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  float* const rows[3] = {header.srow_x, header.srow_y, header.srow_z};
  for (int row = 0; row < 3; ++row) {
    const double sign = row < 2 ? -1.0 : 1.0;
    for (int column = 0; column < 3; ++column) rows[row][column] = static_cast<float>(sign * matrix(row, column));
    rows[row][3] = static_cast<float>(sign * geometry.origin_mm[row]);
  }
  set_qform(geometry, header);
  std::memcpy(header.magic, "n+1", 4);
  std::string bytes(352, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!extension.empty()) bytes[sizeof header] = 1;
  return bytes + extension;
}

std::string nrrd_header(const GridGeometry& geometry, bool is_wide, const std::vector<Segment>& segments) {
  TextWriter text;
  text << nrrd_head(geometry, is_wide ? "short" : "unsigned char", "gzip");
  int number = 0;
  for (const Segment& segment : segments) {
    const std::string key = "Segment" + std::to_string(number++);
    text << key << "_ID:=" << segment.id << '\n'
         << key << "_Name:=" << segment.name << '\n'
         << key << "_Color:=" << segment.colour << '\n'
         << key << "_LabelValue:=" << segment.label << '\n'
         << key << "_Layer:=0\n"
         << key << "_Extent:=0 " << geometry.size[0] - 1 << " 0 " << geometry.size[1] - 1 << " 0 "
         << geometry.size[2] - 1 << '\n';
  }
  if (!segments.empty()) text << "Segmentation_MasterRepresentation:=Binary labelmap\n";
  text << '\n';
  return text.str();
}

/// `bytes`: one a voxel, or two where `is_wide`.
std::string encode(const GridGeometry& geometry, const std::string& bytes, bool is_wide,
                   const std::vector<Segment>& segments, bool names_in_nifti, const std::filesystem::path& name) {
  const std::string file = name.filename().string();
  if (file.ends_with(".nrrd")) {
    const bool is_segmentation = file.ends_with(".seg.nrrd");
    return nrrd_header(geometry, is_wide, is_segmentation ? segments : std::vector<Segment>{}) + gzip(bytes);
  }
  if (file.ends_with(".nii") || file.ends_with(".nii.gz")) {
    for (const int size : geometry.size) {
      if (size > 32767) fail("expected at most 32767 voxels along each axis for NIfTI, found ", size);
    }
    const std::string extension = names_in_nifti ? nifti_extension(segments) : "";
    const std::string whole = nifti_header(geometry, is_wide, extension) + bytes;
    return file.ends_with(".gz") ? gzip(whole) : whole;
  }
  fail(
      "expected a label map's name to end in .nii, .nii.gz, .nrrd, .seg.nrrd, .dcm (DICOM segmentation) or "
      ".rtstruct.dcm (DICOM structure set), found ",
      name.string());
}

std::string colour_of(int number) {
  const Vec3 colour = detail::label_colour(number);
  return fixed_text(colour[0], 2) + " " + fixed_text(colour[1], 2) + " " + fixed_text(colour[2], 2);
}

}  // namespace

BoneMask read_label_map(const std::filesystem::path& file, int label, const GridGeometry& ct_geometry,
                        NiftiAffine affine, std::vector<std::string>* warnings) {
  check_geometry(ct_geometry, "CT");
  std::vector<std::uint8_t> has_label;  // of the file's voxels
  std::set<long long> present;          // without 0
  long long last = 0;
  const detail::LabelFile labels = detail::read_label_file(
      file, ct_geometry, {.only = label, .affine = affine},
      [&](const detail::LabelFile& head) { has_label.reserve(head.voxel_count()); },
      [&](std::span<const double> values) {
        for (const double value : values) {
          const std::optional<long long> whole = detail::label_in(value);
          if (!whole && std::isfinite(value)) {
            fail("expected labels that are whole numbers, found ", value, " in ", file.string());
          }
          const long long found = whole.value_or(0);
          if (found != last && found != 0) present.insert(found);
          last = found;
          has_label.push_back(found == label ? 1 : 0);
        }
      });
  if (warnings != nullptr) *warnings = labels.warnings;
  if (label == 0 || !present.contains(label)) {
    fail("no label ", label, " in ", file.string(), "; there are: ", detail::list_for_people(present));
  }
  BoneMask mask{ct_geometry, std::vector<std::uint8_t>(ct_geometry.voxel_count(), 0)};
  std::atomic<bool> found{false};
  detail::for_each_nearest(labels, ct_geometry, [&](std::size_t at, std::size_t at_file) {
    if (has_label[at_file] == 0) return;
    mask.inside[at] = 1;
    found.store(true, std::memory_order_relaxed);
  });
  if (!found) fail("expected label ", label, " within the CT, found it only outside: ", file.string());
  return mask;
}

std::string encode_label_map(const BoneMask& mask, int label, const std::filesystem::path& name) {
  check_geometry(mask.geometry, "label map");
  if (label < 1 || label > 32767) fail("expected a label from 1 to 32767, found ", label);
  if (is_dicom_label_name(name)) {
    // Its segments count from 1, whatever the label.
    LabelVolume volume{mask.geometry, mask.inside, {{1, {"vertebra", Level::kNone}}}};
    for (std::uint8_t& voxel : volume.labels) voxel = voxel != 0 ? 1 : 0;
    return encode_label_volume(volume, name);
  }
  return encode(mask.geometry, voxel_bytes(mask, label), label > 255,
                {{label, "vertebra", "vertebra", "0.95 0.84 0.57"}}, false, name);
}

bool is_dicom_label_name(const std::filesystem::path& name) { return name.filename().string().ends_with(".dcm"); }

std::string encode_label_volume(const LabelVolume& volume, const std::filesystem::path& name,
                                const DicomSource& source) {
  check_geometry(volume.geometry, "label map");
  if (volume.labels.size() != volume.geometry.voxel_count()) {
    fail("expected ", volume.geometry.voxel_count(), " voxels in the label map, found ", volume.labels.size());
  }
  std::vector<Segment> segments;
  for (const auto& [number, label] : volume.names) {
    if (number < 1 || number > 255) fail("expected labels from 1 to 255, found ", number);
    const auto breaks_line = [](char c) { return static_cast<unsigned char>(c) < ' '; };
    if (std::any_of(label.name.begin(), label.name.end(), breaks_line) || label.name.find("]]>") != std::string::npos) {
      fail("expected a label's name on one line, found another for label ", number);
    }
    const std::string own_name = label.name.empty() ? "label " + std::to_string(number) : label.name;
    // 3D Slicer asks for IDs that no two segments share.
    const std::string id = label.level == Level::kNone ? "label_" + std::to_string(number) : level_name(label.level);
    segments.push_back({number, id, own_name, colour_of(number)});
  }
  if (is_dicom_label_name(name)) {
    const bool is_set = name.filename().string().ends_with(".rtstruct.dcm");
    return is_set ? detail::encode_dicom_contours(volume, source) : detail::encode_dicom_segmentation(volume, source);
  }
  return encode(volume.geometry, std::string(volume.labels.begin(), volume.labels.end()), false, segments, true, name);
}

std::string encode_label_volume(const LabelVolume& volume, const std::filesystem::path& name) {
  return encode_label_volume(volume, name, DicomSource{});
}

}  // namespace spinaltap
