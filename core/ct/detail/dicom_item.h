#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/ct/detail/dicom_level_codes.h"

namespace spinaltap::detail {

/// A data set, or an item of a sequence, to write: elements in the order of their tags (PS3.5, 7.1).
///
/// Not GDCM's: segmentations and structure sets are sequences within sequences, for which its writer has no more to
/// offer than its data sets, and the same input must give the same bytes.
class DicomItem {
 public:
  /// Text and UIDs, padded to even length (PS3.5, 6.2).
  DicomItem& put(std::uint32_t tag, std::string_view vr, std::string value);
  DicomItem& put_short(std::uint32_t tag, int value);                                 ///< US
  DicomItem& put_tag(std::uint32_t tag, std::uint32_t value);                         ///< AT
  DicomItem& put_longs(std::uint32_t tag, const std::vector<std::uint32_t>& values);  ///< UL
  DicomItem& put_items(std::uint32_t tag, std::vector<DicomItem> items);              ///< SQ
  DicomItem& put_code(std::uint32_t tag, const DicomCode& code);                      ///< SQ of one code

  /// Little endian; explicit value representations, or implicit ones, whose values may be longer than 65,534 bytes.
  std::string bytes(bool is_explicit) const;

 private:
  struct Element {
    std::string vr;
    std::string value;
    std::vector<DicomItem> items;
  };
  std::map<std::uint32_t, Element> elements_;
};

/// A file (PS3.10) of a data set that has its SOPClassUID and SOPInstanceUID.
std::string dicom_file(const DicomItem& data, const std::string& sop_class, const std::string& sop_instance,
                       bool is_explicit);

}  // namespace spinaltap::detail
