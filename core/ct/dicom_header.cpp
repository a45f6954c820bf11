#include "core/ct/dicom_header.h"

#include "core/base/error.h"
#include "core/ct/dicom_decimal.h"

namespace spinaltap {
namespace {

constexpr std::string_view kCtImageStorage = "1.2.840.10008.5.1.4.1.1.2";

/// The value without its padding. Anything but printable ASCII becomes '?', so that it fits into a message.
std::string text_of(std::string text) {
  const std::string padding(" \0", 2);
  const std::size_t first = text.find_first_not_of(padding);
  if (first == std::string::npos) return {};
  text = text.substr(first, text.find_last_not_of(padding) - first + 1);
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

/// An unsigned short; 0 where the value is shorter.
int short_of(const std::string& value) {
  if (value.size() < 2) return 0;
  return static_cast<unsigned char>(value[0]) | static_cast<unsigned char>(value[1]) << 8;
}

std::vector<double> decimals_of(std::string value) { return parse_decimal_string(text_of(std::move(value))); }

/// Takes what the element says; false for the pixels, after which nothing of interest comes.
bool take(DicomElementWalker& walker, const DicomElement& element, DicomHeader& header) {
  const auto value = [&] { return walker.value(element); };
  switch (element.tag) {
    case 0x00020002:
      header.sop_class = text_of(value());
      return true;
    case 0x00020010:
      header.transfer_syntax = text_of(value());
      return true;
    case 0x00080016:
      if (std::string uid = text_of(value()); !uid.empty()) header.sop_class = std::move(uid);
      return true;
    case 0x00080060:
      header.modality = text_of(value());
      return true;
    case 0x0020000e:
      header.series_uid = text_of(value());
      return true;
    case 0x00200032:
      header.position_mm = decimals_of(value());
      return true;
    case 0x00200037:
      header.orientation = decimals_of(value());
      return true;
    case 0x00280002:
      header.samples = short_of(value());
      return true;
    case 0x00280004:
      header.photometric = text_of(value());
      return true;
    case 0x00280008:
      header.frames = decimals_of(value());
      return true;
    case 0x00280010:
      header.rows = short_of(value());
      return true;
    case 0x00280011:
      header.columns = short_of(value());
      return true;
    case 0x00280030:
      header.pixel_spacing_mm = decimals_of(value());
      return true;
    case 0x00280100:
      header.bits_allocated = short_of(value());
      return true;
    case 0x00280101:
      header.bits_stored = short_of(value());
      return true;
    case 0x00280102:
      header.high_bit = short_of(value());
      return true;
    case 0x00280103:
      header.is_signed = short_of(value()) != 0;
      return true;
    case 0x00281052:
      header.rescale_intercept = decimals_of(value());
      return true;
    case 0x00281053:
      header.rescale_slope = decimals_of(value());
      return true;
    case 0x7fe00010:
      header.encapsulated = element.undefined_length;
      if (header.encapsulated) {
        header.pixels = walker.fragments();
      } else {
        header.pixels = {{element.offset, element.length}};
      }
      return false;
    default:
      walker.skip(element);
      return true;
  }
}

}  // namespace

std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& file) {
  DicomElementWalker walker;
  if (!walker.open(file)) return std::nullopt;
  DicomHeader header;
  header.file = file;
  const auto may_be_ct = [&] {
    return header.sop_class == kCtImageStorage || header.modality == "CT" ||
           (header.sop_class.empty() && header.modality.empty());
  };
  try {
    for (DicomElement element; walker.next(element) && take(walker, element, header);) {
    }
  } catch (const Error&) {
    if (may_be_ct()) throw;
    return std::nullopt;
  }
  if (header.rows >= 0 && header.columns >= 0) return header;
  // Other objects of modality CT have no pixels: structured reports, raw data.
  if (header.sop_class == kCtImageStorage || (header.sop_class.empty() && may_be_ct())) {
    fail("expected Rows and Columns of a CT slice, found none (file cut short?) in ", file.string());
  }
  return std::nullopt;
}

}  // namespace spinaltap
