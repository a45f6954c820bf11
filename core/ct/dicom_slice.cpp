#include "core/ct/dicom_slice.h"

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/ct/dicom_codestream.h"
#include "core/ct/dicom_library.h"

namespace spinaltap {
namespace {

struct Rescale {
  double slope = 1.0;
  double intercept = 0.0;
};

/// Everything that the decoder takes for granted.
void check_pixel_format(const DicomHeader& header, const gdcm::TransferSyntax& syntax) {
  const std::string file = header.file.string();
  if (syntax == gdcm::TransferSyntax::TS_END || syntax == gdcm::TransferSyntax::ExplicitVRBigEndian ||
      syntax == gdcm::TransferSyntax::ImplicitVRBigEndianPrivateGE ||
      syntax == gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian) {
    fail("expected a little endian DICOM transfer syntax, found \"", header.transfer_syntax, "\" in ", file);
  }
  if (!header.frames.empty() && !(header.frames.front() == 1.0)) {
    fail("expected one slice a file, found ", header.frames.front(), " frames in ", file);
  }
  if (header.samples != 1 || !header.photometric.starts_with("MONOCHROME")) {
    fail("expected a grey picture, found ", header.photometric, " with ", header.samples, " values a pixel in ", file);
  }
  const int bits = header.bits_allocated;
  if ((bits != 8 && bits != 16 && bits != 32) || header.bits_stored < 1 || header.bits_stored > bits ||
      header.high_bit != header.bits_stored - 1) {
    fail("expected values of 8, 16 or 32 bits, the lowest ones used, found ", header.bits_stored, " of ", bits,
         " bits with the highest at ", header.high_bit, " in ", file);
  }
  if (header.pixels.empty() || header.encapsulated != syntax.IsEncapsulated()) {
    fail("expected ", syntax.IsEncapsulated() ? "compressed" : "plain", " pixels, found ",
         header.pixels.empty() ? "none" : "others", " in ", file);
  }
}

Rescale rescale_of(const DicomHeader& header) {
  const bool has_slope = !header.rescale_slope.empty();
  const bool has_intercept = !header.rescale_intercept.empty();
  if (!has_slope && !has_intercept && header.is_signed) return {};  // stored as HU
  if (!has_slope || !has_intercept) {
    fail("expected RescaleSlope and RescaleIntercept, without which stored values have no unit, found ",
         has_slope ? "no RescaleIntercept" : "no RescaleSlope", " in ", header.file.string());
  }
  const Rescale rescale{header.rescale_slope.front(), header.rescale_intercept.front()};
  if (!std::isfinite(rescale.slope) || rescale.slope == 0.0 || !std::isfinite(rescale.intercept)) {
    fail("expected a RescaleSlope other than 0 and a RescaleIntercept, found ", rescale.slope, " and ",
         rescale.intercept, " in ", header.file.string());
  }
  return rescale;
}

void check_codestream(const DicomHeader& header, std::span<const char> bytes) {
  const std::optional<CodestreamSize> found = codestream_size(bytes);
  if (!found) fail("cannot decode the compressed pixels, which have no readable header, of ", header.file.string());
  const int bits_allocated = found->bits <= 8 ? 8 : found->bits <= 16 ? 16 : 32;
  if (found->columns != header.columns || found->rows != header.rows || found->components != 1 ||
      bits_allocated != header.bits_allocated) {
    fail("expected compressed pixels of ", header.columns, " x ", header.rows, " values of ", header.bits_allocated,
         " bits, found ", found->columns, " x ", found->rows, " x ", found->components, " of ", found->bits,
         " bits in ", header.file.string());
  }
}

/// The pixels as they are in the file, for GDCM.
gdcm::DataElement stored_pixels(const DicomHeader& header, const gdcm::TransferSyntax& syntax) {
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
  std::ifstream stream(header.file, std::ios::binary);
  for (const ByteRange& range : header.pixels) {
    std::vector<char> bytes(range.length);
    stream.seekg(static_cast<std::streamoff>(range.offset));
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
      fail("cannot read the pixels of ", header.file.string());
    }
    const auto length = static_cast<std::uint32_t>(bytes.size());
    const bool has_codestream = header.encapsulated && syntax != gdcm::TransferSyntax::RLELossless;
    if (has_codestream && &range == header.pixels.data()) check_codestream(header, bytes);
    if (header.encapsulated) {
      gdcm::Fragment fragment;
      fragment.SetByteValue(bytes.data(), length);
      fragments->AddFragment(fragment);
    } else {
      element.SetVR(gdcm::VR::OW);
      element.SetByteValue(bytes.data(), length);
    }
  }
  if (header.encapsulated) element.SetValue(*fragments);
  return element;
}

std::vector<char> decode(const DicomHeader& header, const gdcm::TransferSyntax& syntax) {
  const auto bits = [](int value) { return static_cast<unsigned short>(value); };
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(header.columns));
  image.SetDimension(1, static_cast<unsigned>(header.rows));
  image.SetPixelFormat(gdcm::PixelFormat(1, bits(header.bits_allocated), bits(header.bits_stored),
                                         bits(header.high_bit), header.is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(syntax);
  image.SetDataElement(stored_pixels(header, syntax));

  const std::size_t wanted = static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows) *
                             static_cast<std::size_t>(header.bits_allocated / 8);
  if (!header.encapsulated && header.pixels.front().length < wanted) {
    fail("expected ", wanted, " bytes of pixels, found ", header.pixels.front().length, " in ", header.file.string());
  }
  std::vector<char> bytes(wanted);
  bool decoded = false;
  try {
    decoded = image.GetBufferLength() == wanted && image.GetBuffer(bytes.data());
  } catch (const std::exception&) {
    decoded = false;  // GDCM throws on some broken pixels
  }
  if (!decoded) fail("cannot decode the pixels of ", header.file.string());
  return bytes;
}

template <class Stored>
void to_hu(const std::vector<char>& bytes, Rescale rescale, std::span<std::int16_t> hu) {
  constexpr double kMin = std::numeric_limits<std::int16_t>::min();
  constexpr double kMax = std::numeric_limits<std::int16_t>::max();
  for (std::size_t n = 0; n < hu.size(); ++n) {
    Stored stored;
    std::memcpy(&stored, bytes.data() + n * sizeof stored, sizeof stored);
    const double value = std::clamp(static_cast<double>(stored) * rescale.slope + rescale.intercept, kMin, kMax);
    hu[n] = static_cast<std::int16_t>(static_cast<std::int32_t>(value + (value < 0.0 ? -0.5 : 0.5)));
  }
}

}  // namespace

void decode_dicom_slice(const DicomHeader& header, std::span<std::int16_t> hu) {
  silence_gdcm();
  const gdcm::TransferSyntax syntax(gdcm::TransferSyntax::GetTSType(header.transfer_syntax.c_str()));
  check_pixel_format(header, syntax);
  const Rescale rescale = rescale_of(header);
  const std::vector<char> bytes = decode(header, syntax);
  switch (header.bits_allocated * (header.is_signed ? -1 : 1)) {
    case 8:
      return to_hu<std::uint8_t>(bytes, rescale, hu);
    case -8:
      return to_hu<std::int8_t>(bytes, rescale, hu);
    case 16:
      return to_hu<std::uint16_t>(bytes, rescale, hu);
    case -16:
      return to_hu<std::int16_t>(bytes, rescale, hu);
    case 32:
      return to_hu<std::uint32_t>(bytes, rescale, hu);
    default:
      return to_hu<std::int32_t>(bytes, rescale, hu);
  }
}

}  // namespace spinaltap
