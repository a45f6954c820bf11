#include "core/ct/detail/dicom_codec.h"

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>

#include <array>
#include <exception>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/error.h"
#include "core/base/process_changes.h"
#include "core/ct/detail/dicom_bytes.h"
#include "core/ct/detail/dicom_rle.h"
#include "core/ct/detail/dicom_silence.h"
#include "core/ct/detail/jpeg_stream.h"

namespace spinaltap {
namespace {

struct Syntax {
  std::string_view uid;
  std::string_view name;
};

constexpr std::string_view kRle = "1.2.840.10008.1.2.5";

constexpr std::array<Syntax, 13> kSyntaxes{{
    {"1.2.840.10008.1.2", "implicit, little endian"},
    {"1.2.840.10008.1.2.1", "explicit, little endian"},
    {"1.2.840.10008.1.2.1.99", "deflated"},
    {"1.2.840.10008.1.2.2", "explicit, big endian"},
    {"1.2.840.10008.1.2.4.50", "JPEG baseline, lossy"},
    {"1.2.840.10008.1.2.4.51", "JPEG extended, lossy"},
    {"1.2.840.10008.1.2.4.57", "JPEG, lossless"},
    {"1.2.840.10008.1.2.4.70", "JPEG, lossless, first order"},
    {"1.2.840.10008.1.2.4.80", "JPEG-LS, lossless"},
    {"1.2.840.10008.1.2.4.81", "JPEG-LS, near-lossless"},
    {"1.2.840.10008.1.2.4.90", "JPEG 2000, lossless"},
    {"1.2.840.10008.1.2.4.91", "JPEG 2000"},
    {kRle, "RLE"},
}};

const Syntax* find_syntax(const std::string& uid) {
  for (const Syntax& syntax : kSyntaxes) {
    if (syntax.uid == uid) return &syntax;
  }
  return nullptr;
}

/// A codestream that disagrees with the header about signs cannot be read: either may be right, and 2^bits lies
/// between the two.
void check_sign(const DicomHeader& header, const CodestreamSize& found) {
  if (found.is_signed && *found.is_signed != header.is_signed) {
    fail("expected ", header.is_signed ? "signed" : "unsigned", " values as PixelRepresentation says, found ",
         *found.is_signed ? "signed" : "unsigned", " ones of ", found.bits, " bits in the codestream of ",
         path_of(header), " (a converter's fault: write the pixels anew)");
  }
  // JPEG and JPEG-LS keep two's complement, whose sign is the codestream's highest bit.
  if (!found.is_signed && header.is_signed && found.bits < header.bits_stored) {
    fail("expected signed values of BitsStored ", header.bits_stored, ", found ", found.bits,
         " bits in the codestream, whose sign cannot be told, of ", path_of(header));
  }
}

CodestreamSize check_codestream(const DicomHeader& header, std::span<const char> bytes) {
  const std::optional<CodestreamSize> found = codestream_size(bytes);
  if (!found)
    fail_as(ErrorKind::unsupported, "cannot decode the compressed pixels, which have no readable header, of ",
            path_of(header));
  const int bits_allocated = found->bits <= 8 ? 8 : found->bits <= 16 ? 16 : 32;
  if (found->columns != header.columns || found->rows != header.rows || found->components != 1 ||
      bits_allocated != header.bits_allocated) {
    fail("expected compressed pixels of ", header.columns, " x ", header.rows, " values of ", header.bits_allocated,
         " bits, found ", found->columns, " x ", found->rows, " x ", found->components, " of ", found->bits,
         " bits in ", path_of(header));
  }
  check_sign(header, *found);
  return *found;
}

/// Where the codestream has more bits than the header says are used, those above must repeat the sign or be 0.
void check_upper_bits(const DicomHeader& header, const CodestreamSize& found, const std::vector<char>& bytes) {
  if (found.bits <= header.bits_stored || header.bits_stored >= 32) return;
  const auto size = static_cast<std::size_t>(header.bits_allocated / 8);
  const std::uint32_t all =
      header.bits_allocated == 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << header.bits_allocated) - 1;
  const int sign_bits = header.is_signed ? 1 : 0;
  for (std::size_t n = 0; n + size <= bytes.size(); n += size) {
    std::uint32_t value = 0;
    for (std::size_t byte = 0; byte < size; ++byte) {
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[n + byte])) << (8 * byte);
    }
    const std::uint32_t above = value >> (header.bits_stored - sign_bits);
    const bool is_padding = header.padding && value == (*header.padding & all);
    const bool fits =
        value >> header.bits_stored == 0 || (header.is_signed && above == all >> (header.bits_stored - sign_bits));
    if (is_padding || fits) continue;
    fail("expected compressed values of BitsStored ", header.bits_stored, ", found ", found.bits,
         " bits in use in the codestream of ", path_of(header));
  }
}

/// Baseline, extended and lossless, not JPEG-LS or JPEG 2000.
bool is_jpeg(const std::string& uid) {
  return uid.starts_with("1.2.840.10008.1.2.4.5") || uid == "1.2.840.10008.1.2.4.70";
}

bool is_jpeg_ls(const std::string& uid) { return uid == "1.2.840.10008.1.2.4.80" || uid == "1.2.840.10008.1.2.4.81"; }

std::vector<char> decode_with_gdcm(const DicomHeader& header, const std::vector<char>& codestream) {
  silence_gdcm();
  const auto bits = [](int value) { return static_cast<unsigned short>(value); };
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence = new gdcm::SequenceOfFragments;
  gdcm::Fragment fragment;
  fragment.SetByteValue(codestream.data(), static_cast<std::uint32_t>(codestream.size()));
  sequence->AddFragment(fragment);
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  element.SetValue(*sequence);

  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(header.columns));
  image.SetDimension(1, static_cast<unsigned>(header.rows));
  image.SetPixelFormat(gdcm::PixelFormat(1, bits(header.bits_allocated), bits(header.bits_stored),
                                         bits(header.high_bit), header.is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(gdcm::TransferSyntax(gdcm::TransferSyntax::GetTSType(header.transfer_syntax.c_str())));
  image.SetDataElement(element);

  std::vector<char> bytes(frame_bytes(header));
  bool decoded = false;
  std::optional<QuietStderr> quiet;
  if (allowed_process_changes().silences_decoders) quiet.emplace();
  try {
    decoded = image.GetBufferLength() == bytes.size() && image.GetBuffer(bytes.data());
  } catch (const std::exception&) {
    decoded = false;  // GDCM throws on some broken pixels
  }
  if (!decoded) fail_as(ErrorKind::unsupported, "cannot decode the pixels of ", path_of(header));
  return bytes;
}

}  // namespace

std::size_t frame_bytes(const DicomHeader& header) {
  return static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows) *
         static_cast<std::size_t>(header.bits_allocated / 8);
}

bool is_known_syntax(const std::string& uid) { return find_syntax(uid) != nullptr; }

bool is_compressed_syntax(const std::string& uid) { return uid.starts_with("1.2.840.10008.1.2.4.") || uid == kRle; }

std::string transfer_syntax_name(const std::string& uid) {
  const Syntax* syntax = find_syntax(uid);
  return syntax != nullptr ? std::string(syntax->name) : uid;
}

std::vector<std::vector<char>> read_fragments(const DicomHeader& header) {
  DicomBytes file;
  bool is_whole = file.open(header.file);
  if (is_whole && header.deflated_at) {
    is_whole = file.skip(*header.deflated_at);
    file.inflate_from_here();
  }
  std::vector<std::vector<char>> fragments;
  for (const ByteRange& range : header.pixels) {
    is_whole = is_whole && range.offset >= file.position() && file.skip(range.offset - file.position()) &&
               file.may_hold(range.length);
    if (!is_whole) break;
    std::vector<char>& bytes = fragments.emplace_back(range.length);
    is_whole = file.read(bytes.data(), bytes.size());
  }
  if (!is_whole) fail("cannot read the pixels of ", path_of(header));
  return fragments;
}

std::vector<char> decompress_frame(const DicomHeader& header) {
  const std::vector<std::vector<char>> fragments = read_fragments(header);
  if (fragments.empty()) fail("expected compressed pixels, found none in ", path_of(header));
  std::vector<char> whole;
  for (const std::vector<char>& part : fragments) whole.insert(whole.end(), part.begin(), part.end());
  if (header.transfer_syntax == kRle) {
    std::vector<char> bytes(frame_bytes(header));
    if (!decode_dicom_rle(whole, header.bits_allocated / 8, bytes)) {
      fail("cannot decode the RLE pixels of ", path_of(header));
    }
    return bytes;
  }
  const CodestreamSize codestream = check_codestream(header, whole);
  if (is_jpeg(header.transfer_syntax)) {
    const std::optional<std::vector<char>> plain = plain_jpeg_stream(whole);
    if (!plain)
      fail_as(ErrorKind::unsupported, "cannot decode the JPEG pixels, which are broken or of another process, of ",
              path_of(header));
    whole = *plain;
  }
  if (is_jpeg_ls(header.transfer_syntax)) {
    // Where a scan stops within a code and no marker follows, CharLS 2.4 reads 2^32 bits beyond the end, which takes
    // seconds. A second end of image after the first does no harm.
    constexpr std::array<char, 2> kEndOfImage{'\xff', '\xd9'};
    whole.insert(whole.end(), kEndOfImage.begin(), kEndOfImage.end());
  }
  std::vector<char> bytes = decode_with_gdcm(header, whole);
  check_upper_bits(header, codestream, bytes);
  return bytes;
}

}  // namespace spinaltap
