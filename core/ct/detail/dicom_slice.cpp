#include "core/ct/detail/dicom_slice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_codec.h"

namespace spinaltap {
namespace {

struct Rescale {
  double slope = 1.0;
  double intercept = 0.0;
};

/// Everything that decoding takes for granted.
void check_pixel_format(const DicomHeader& header) {
  const std::string file = path_of(header);
  if (!is_known_syntax(header.transfer_syntax)) {
    fail("expected a DICOM transfer syntax for pictures, found ", in_quotes(header.transfer_syntax), " in ", file);
  }
  if (header.samples != 1 || !header.photometric.starts_with("MONOCHROME")) {
    fail("expected a grey picture, found ", shown(header.photometric), " with ", header.samples, " values a pixel in ",
         file);
  }
  const int bits = header.bits_allocated;
  if ((bits != 8 && bits != 16 && bits != 32) || header.bits_stored < 1 || header.bits_stored > bits ||
      header.high_bit != header.bits_stored - 1) {
    fail("expected values of 8, 16 or 32 bits, the lowest ones used, found ", header.bits_stored, " of ", bits,
         " bits with the highest at ", header.high_bit, " in ", file);
  }
  const bool is_compressed = is_compressed_syntax(header.transfer_syntax);
  if (header.pixels.empty() || header.encapsulated != is_compressed) {
    fail("expected ", is_compressed ? "compressed" : "plain", " pixels, found ",
         header.pixels.empty() ? "none" : "others", " in ", file);
  }
}

/// RescaleType (PS3.3, C.11.1.1.2): without one, a CT's values are HU. US is "unspecified", which some converters write
/// into any CT; HU_MOD are Hounsfield units that were calculated. Both are read and warned of: see read_dicom().
bool is_hu(const std::string& type) { return type.empty() || type == "HU" || type == "US" || type == "HU_MOD"; }

/// `takes_stored`: stored values without a rescaling are taken as they are.
Rescale rescale_of(const DicomHeader& header, bool takes_stored) {
  const bool has_slope = !header.rescale_slope.empty();
  const bool has_intercept = !header.rescale_intercept.empty();
  if (header.has_modality_lut) {
    fail("expected RescaleSlope and RescaleIntercept, found a Modality LUT, which is not read, in ", path_of(header));
  }
  if (!is_hu(header.rescale_type)) {
    fail("expected CT numbers in HU, found the RescaleType ", shown(header.rescale_type),
         " (electron density, effective atomic number and the like are no CT numbers) in ", path_of(header));
  }
  if (!has_slope && !has_intercept && takes_stored) return {};
  if (!has_slope || !has_intercept) {
    fail(
        "expected RescaleSlope and RescaleIntercept, which a CT image must have (PS3.3, C.8.2.1) and without which "
        "stored values have no unit, found no ",
        has_slope       ? "RescaleIntercept"
        : has_intercept ? "RescaleSlope"
                        : "RescaleSlope and no RescaleIntercept",
        " in ", path_of(header), " (export the series anew; who knows its unit says it: CtReadOptions::hu)");
  }
  if (header.rescale_slope.size() > 1 || header.rescale_intercept.size() > 1) {
    fail("expected one RescaleSlope and one RescaleIntercept, found ", header.rescale_slope.size(), " and ",
         header.rescale_intercept.size(), " in ", path_of(header));
  }
  const Rescale rescale{header.rescale_slope.front(), header.rescale_intercept.front()};
  if (!(rescale.slope > 0.0) || !std::isfinite(rescale.slope) || !std::isfinite(rescale.intercept)) {
    fail("expected a RescaleSlope above 0 and a RescaleIntercept, found ", rescale.slope, " and ", rescale.intercept,
         " in ", path_of(header));
  }
  return rescale;
}

/// Plain pixels, made little endian.
std::vector<char> plain_frame(const DicomHeader& header) {
  std::vector<char> bytes = std::move(read_fragments(header).front());
  const auto word = static_cast<std::size_t>(header.swapped_bytes ? std::max(2, header.bits_allocated / 8)
                                             : header.big_endian  ? header.bits_allocated / 8
                                                                  : 1);
  for (std::size_t n = 0; word > 1 && n + word <= bytes.size(); n += word) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(n), bytes.begin() + static_cast<std::ptrdiff_t>(n + word));
  }
  return bytes;
}

/// The bits of a value that are used, with its sign.
class StoredValues {
 public:
  explicit StoredValues(const DicomHeader& header)
      : mask_(header.bits_stored == 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << header.bits_stored) - 1),
        sign_(header.is_signed ? std::uint32_t{1} << (header.bits_stored - 1) : 0) {}

  double operator()(std::uint32_t raw) const {
    const std::uint32_t used = raw & mask_;
    return (used & sign_) != 0 ? static_cast<double>(used) - static_cast<double>(mask_) - 1.0 : used;
  }
  std::uint32_t used(std::uint32_t raw) const { return raw & mask_; }

 private:
  std::uint32_t mask_;
  std::uint32_t sign_;
};

/// Which stored values are padding and not measured (PS3.3, C.7.5.1.1.2). A padding value may use bits above those
/// stored, as some scanners write it, and then meets no other value.
class Padding {
 public:
  explicit Padding(const DicomHeader& header) : value_(header) {
    if (!header.padding) return;
    const std::uint32_t all =
        header.bits_allocated == 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << header.bits_allocated) - 1;
    raw_ = *header.padding & all;
    const std::uint32_t above = *raw_ >> (header.bits_stored - 1);
    fits_ = *raw_ == value_.used(*raw_) || (header.is_signed && above == all >> (header.bits_stored - 1));
    low_ = high_ = value_(*raw_);
    if (header.padding_limit) high_ = value_(*header.padding_limit);
    if (high_ < low_) std::swap(low_, high_);
  }
  bool meets_stored_values() const { return raw_ && fits_; }
  double low() const { return low_; }
  double high() const { return high_; }
  bool holds(std::uint32_t raw, double value) const {
    return raw_ && (raw == *raw_ || (fits_ && value >= low_ && value <= high_));
  }

 private:
  StoredValues value_;
  std::optional<std::uint32_t> raw_;
  bool fits_ = false;
  double low_ = 0.0;
  double high_ = 0.0;
};

template <class Word>
void to_hu(const std::vector<char>& bytes, const DicomHeader& header, Rescale rescale, std::span<std::int16_t> hu) {
  constexpr double kMin = std::numeric_limits<std::int16_t>::min();
  constexpr double kMax = std::numeric_limits<std::int16_t>::max();
  const StoredValues value_of(header);
  const Padding padding(header);
  for (std::size_t n = 0; n < hu.size(); ++n) {
    Word raw;
    std::memcpy(&raw, bytes.data() + n * sizeof raw, sizeof raw);
    const double stored = value_of(raw);
    if (padding.holds(raw, stored)) {
      hu[n] = kAirHu;
      continue;
    }
    const double value = std::clamp(stored * rescale.slope + rescale.intercept, kMin, kMax);
    hu[n] = static_cast<std::int16_t>(static_cast<std::int32_t>(value + (value < 0.0 ? -0.5 : 0.5)));
  }
}

}  // namespace

std::optional<std::array<double, 2>> padded_hu(const DicomHeader& header) {
  const Padding padding(header);
  if (!padding.meets_stored_values() || header.rescale_slope.size() != 1 || header.rescale_intercept.size() != 1) {
    return std::nullopt;
  }
  const auto hu = [&](double stored) { return stored * header.rescale_slope[0] + header.rescale_intercept[0]; };
  const double a = hu(padding.low()), b = hu(padding.high());
  return std::array{std::min(a, b), std::max(a, b)};
}

void check_dicom_slice(const DicomHeader& header, bool takes_stored) {
  check_pixel_format(header);
  static_cast<void>(rescale_of(header, takes_stored));
  const std::uint64_t wanted = frame_bytes(header);
  std::uint64_t found = 0;
  for (const ByteRange& range : header.pixels) found += range.length;
  // What compresses a plain picture best, JPEG 2000, needs a byte for a few thousand.
  constexpr std::uint64_t kMaxCompression = 4096;
  constexpr std::uint64_t kAlwaysAllowed = std::uint64_t{1} << 20;
  const bool is_enough =
      header.encapsulated ? found > 0 && wanted <= kAlwaysAllowed + found * kMaxCompression : found >= wanted;
  if (!is_enough) fail("expected ", wanted, " bytes of pixels, found ", found, " in ", path_of(header));
}

void decode_dicom_slice(const DicomHeader& header, std::span<std::int16_t> hu, bool takes_stored) {
  static_assert(std::endian::native == std::endian::little, "stored values are little endian");
  check_dicom_slice(header, takes_stored);
  const Rescale rescale = rescale_of(header, takes_stored);
  const std::vector<char> bytes = header.encapsulated ? decompress_frame(header) : plain_frame(header);
  if (header.bits_allocated == 8) return to_hu<std::uint8_t>(bytes, header, rescale, hu);
  if (header.bits_allocated == 16) return to_hu<std::uint16_t>(bytes, header, rescale, hu);
  to_hu<std::uint32_t>(bytes, header, rescale, hu);
}

}  // namespace spinaltap
