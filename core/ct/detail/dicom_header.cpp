#include "core/ct/detail/dicom_header.h"

#include <algorithm>
#include <limits>

#include "core/base/error.h"
#include "core/ct/detail/dicom_frames.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap {
namespace {

/// CT Image Storage, Enhanced CT, Legacy Converted Enhanced CT.
bool is_ct_class(const std::string& uid) {
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  return uid == ct || uid == ct + ".1" || uid == ct + ".2";
}

/// Segmentations of voxels and of surfaces, label maps: pictures of no scanner, which people keep beside their CT.
bool is_segmentation_class(const std::string& uid) { return uid.starts_with("1.2.840.10008.5.1.4.1.1.66."); }

/// What a file says, while it is read.
struct Reading {
  DicomElementWalker walker;
  DicomHeader header;
  DicomFrameGroups groups;
  DicomPixelData pixels;
  std::string acquisition_date, acquisition_date_time;

  bool take(const DicomElement& element);
  void take_pixels(const DicomElement& element);
  std::string text(const DicomElement& element) { return dicom_text(walker.value(element)); }
  std::vector<double> decimals(const DicomElement& element) { return dicom_decimals(walker.value(element)); }
  std::uint32_t number(const DicomElement& element) {
    return dicom_unsigned(walker.value(element), walker.is_big_endian());
  }
  /// As number(), small enough for an int.
  int small(const DicomElement& element) {
    return static_cast<int>(std::min<std::uint32_t>(number(element), std::numeric_limits<int>::max()));
  }
};

void Reading::take_pixels(const DicomElement& element) {
  header.encapsulated = element.undefined_length;
  header.big_endian = walker.is_big_endian();
  header.swapped_bytes = header.big_endian && !element.is_bytes;
  if (walker.is_deflated()) header.deflated_at = walker.data_set_offset();
  if (header.encapsulated) {
    pixels.encapsulated = walker.fragments();
  } else {
    pixels.plain = {element.offset, element.length};
  }
}

/// Takes what the element says; false for the pixels, after which nothing of interest comes.
bool Reading::take(const DicomElement& element) {
  switch (element.tag) {
    case 0x00020002:
      header.sop_class = text(element);
      return true;
    case 0x00020010:
      header.transfer_syntax = text(element);
      walker.set_transfer_syntax(header.transfer_syntax);
      return true;
    case 0x00080008:
      header.image_type = text(element);
      return true;
    case 0x00080016:
      if (std::string uid = text(element); !uid.empty()) header.sop_class = std::move(uid);
      return true;
    case 0x00080018:
      header.instance_uid = text(element);
      return true;
    case 0x00080022:
      acquisition_date = text(element);
      return true;
    case 0x0008002a:
      acquisition_date_time = text(element);
      return true;
    case 0x00080032:
      header.acquisition_time = text(element);
      return true;
    case 0x00080060:
      header.modality = text(element);
      return true;
    case 0x00180010:
      header.contrast = text(element);
      return true;
    case 0x00180050:
      header.slice_thickness_mm = decimals(element);
      return true;
    case 0x00180060:
      header.kvp = text(element);
      return true;
    case 0x00180088:
      header.slice_spacing_mm = decimals(element);
      return true;
    case 0x00181100:
      header.reconstruction_mm = decimals(element);
      return true;
    case 0x00181120:
      header.gantry_tilt_deg = decimals(element);
      return true;
    case 0x00181060:
      header.cardiac_phase = text(element);
      return true;
    case 0x00181210:
      header.kernel = text(element);
      return true;
    case 0x0020000e:
      header.series_uid = text(element);
      return true;
    case 0x00200012:
      header.acquisition_number = text(element);
      return true;
    case 0x00200013:
      header.instance_number = decimals(element);
      return true;
    case 0x00200020:
      header.patient_orientation = text(element);
      return true;
    case 0x00201041:
      header.slice_location_mm = decimals(element);
      return true;
    case 0x00200032:
      header.position_mm = decimals(element);
      return true;
    case 0x00200037:
      header.orientation = decimals(element);
      return true;
    case 0x00200052:
      header.frame_of_reference = text(element);
      return true;
    case 0x00200100:
      header.temporal_position = text(element);
      return true;
    case 0x00209241:
      header.cardiac_phase = text(element);
      return true;
    case 0x00280002:
      header.samples = small(element);
      return true;
    case 0x00280004:
      header.photometric = text(element);
      return true;
    case 0x00280008:
      groups.frame_count = decimals(element);
      return true;
    case 0x00280010:
      header.rows = small(element);
      return true;
    case 0x00280011:
      header.columns = small(element);
      return true;
    case 0x00280030:
      header.pixel_spacing_mm = decimals(element);
      return true;
    case 0x00280100:
      header.bits_allocated = small(element);
      return true;
    case 0x00280101:
      header.bits_stored = small(element);
      return true;
    case 0x00280102:
      header.high_bit = small(element);
      return true;
    case 0x00280103:
      header.is_signed = number(element) != 0;
      return true;
    case 0x00280120:
      if (element.length > 0)
        header.padding = number(element);
      else
        walker.skip(element);
      return true;
    case 0x00280121:
      if (element.length > 0)
        header.padding_limit = number(element);
      else
        walker.skip(element);
      return true;
    case 0x00281052:
      header.rescale_intercept = decimals(element);
      return true;
    case 0x00281053:
      header.rescale_slope = decimals(element);
      return true;
    case 0x00281054:
      header.rescale_type = text(element);
      return true;
    case 0x00283000:
      header.has_modality_lut = element.undefined_length || element.length > 0;
      walker.skip(element);
      return true;
    case 0x52009229:
      groups.shared = read_functional_groups(walker, element);
      return true;
    case 0x52009230:
      groups.per_frame = read_functional_groups(walker, element);
      return true;
    case 0x7fe00010:
      take_pixels(element);
      return false;
    default:
      walker.skip(element);
      return true;
  }
}

std::string with_frame(const std::string& name, const DicomHeader& header) {
  return header.frames > 1 ? name + ", frame " + std::to_string(header.frame + 1) : name;
}

}  // namespace

std::string name_of(const DicomHeader& header) { return with_frame(header.file.filename().string(), header); }
std::string path_of(const DicomHeader& header) { return with_frame(header.file.string(), header); }

std::vector<DicomHeader> read_dicom_headers(const std::filesystem::path& file, std::string* why_none) {
  const auto pass_over = [&](const std::string& why) -> std::vector<DicomHeader> {
    if (why_none != nullptr) *why_none = why;
    return {};
  };
  Reading reading;
  if (!reading.walker.open(file)) return pass_over("not DICOM");
  DicomHeader& header = reading.header;
  header.file = file;
  const bool has_preamble = reading.walker.has_preamble();
  const auto may_be_ct = [&] {
    return is_ct_class(header.sop_class) || header.modality == "CT" ||
           (has_preamble && header.sop_class.empty() && header.modality.empty());
  };
  constexpr const char* kDirectory = "1.2.840.10008.1.3.10";
  try {
    for (DicomElement element; reading.walker.next(element) && reading.take(element);) {
    }
    if (is_segmentation_class(header.sop_class)) return pass_over("a segmentation");
    if (!has_preamble && header.transfer_syntax.empty()) header.transfer_syntax = reading.walker.plain_syntax();
    if (!reading.acquisition_date_time.empty()) {
      header.acquisition_time = reading.acquisition_date_time;
    } else if (!header.acquisition_time.empty()) {
      header.acquisition_time = reading.acquisition_date + header.acquisition_time;
    }
    const bool is_image = header.rows >= 0 && header.columns >= 0;
    if (is_image) return split_into_frames(header, reading.groups, reading.pixels);
  } catch (const Error&) {
    if (may_be_ct()) throw;
    const bool is_dicom = has_preamble || !header.sop_class.empty() || !header.modality.empty();
    return pass_over(is_dicom ? "cut short or broken, of another modality" : "not DICOM");
  }
  // Other objects of modality CT have no pixels: structured reports, raw data.
  if (is_ct_class(header.sop_class) || (header.sop_class.empty() && may_be_ct())) {
    fail("expected Rows and Columns of a CT slice, found none (file cut short?) in ", file.string());
  }
  if (header.sop_class == kDirectory) return pass_over("a directory (DICOMDIR)");
  if (header.sop_class.empty() && header.modality.empty()) return pass_over("not DICOM");
  return pass_over("without pictures" + (header.modality.empty() ? std::string() : ", " + header.modality));
}

}  // namespace spinaltap
