#include "core/ct/detail/dicom_item.h"

#include "core/base/error.h"
#include "core/ct/detail/dicom_uid.h"

namespace spinaltap::detail {
namespace {

std::string little_endian(std::uint64_t value, int count) {
  std::string bytes;
  for (int n = 0; n < count; ++n) bytes.push_back(static_cast<char>(value >> (8 * n) & 0xff));
  return bytes;
}

std::string tag_bytes(std::uint32_t tag) { return little_endian(tag >> 16, 2) + little_endian(tag & 0xffff, 2); }

bool has_long_length(std::string_view vr) { return vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UT"; }

std::string length_bytes(std::uint32_t tag, std::size_t length, int count) {
  const std::uint64_t max = count == 2 ? 0xfffe : 0xfffffffe;
  if (length > max) fail("cannot write a DICOM element ", tag, " of ", length, " bytes, more than its length can say");
  return little_endian(length, count);
}

}  // namespace

DicomItem& DicomItem::put(std::uint32_t tag, std::string_view vr, std::string value) {
  if (value.size() % 2 != 0) value.push_back(vr == "UI" || vr == "OB" ? '\0' : ' ');
  elements_[tag] = {std::string(vr), std::move(value), {}};
  return *this;
}

DicomItem& DicomItem::put_short(std::uint32_t tag, int value) {
  return put(tag, "US", little_endian(static_cast<std::uint64_t>(value), 2));
}

DicomItem& DicomItem::put_tag(std::uint32_t tag, std::uint32_t value) { return put(tag, "AT", tag_bytes(value)); }

DicomItem& DicomItem::put_longs(std::uint32_t tag, const std::vector<std::uint32_t>& values) {
  std::string bytes;
  for (const std::uint32_t value : values) bytes += little_endian(value, 4);
  return put(tag, "UL", bytes);
}

DicomItem& DicomItem::put_items(std::uint32_t tag, std::vector<DicomItem> items) {
  elements_[tag] = {"SQ", "", std::move(items)};
  return *this;
}

DicomItem& DicomItem::put_code(std::uint32_t tag, const DicomCode& code) {
  DicomItem item;
  item.put(0x00080100, "SH", code.value).put(0x00080102, "SH", code.scheme).put(0x00080104, "LO", code.meaning);
  return put_items(tag, {item});
}

std::string DicomItem::bytes(bool is_explicit) const {
  std::string all;
  for (const auto& [tag, element] : elements_) {
    std::string inside;
    for (const DicomItem& item : element.items) {
      const std::string content = item.bytes(is_explicit);
      inside += tag_bytes(0xfffee000) + length_bytes(tag, content.size(), 4) + content;
    }
    const std::string& value = element.vr == "SQ" ? inside : element.value;
    all += tag_bytes(tag);
    if (!is_explicit) {
      all += length_bytes(tag, value.size(), 4);
    } else if (has_long_length(element.vr)) {
      all += element.vr + std::string(2, '\0') + length_bytes(tag, value.size(), 4);
    } else {
      all += element.vr + length_bytes(tag, value.size(), 2);
    }
    all += value;
  }
  return all;
}

std::string dicom_file(const DicomItem& data, const std::string& sop_class, const std::string& sop_instance,
                       bool is_explicit) {
  DicomItem meta;
  meta.put(0x00020001, "OB", std::string("\0\1", 2))
      .put(0x00020002, "UI", sop_class)
      .put(0x00020003, "UI", sop_instance)
      .put(0x00020010, "UI", is_explicit ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2")
      .put(0x00020012, "UI", dicom_uid_of("SpinalTap"))
      .put(0x00020013, "SH", "SPINALTAP");
  const std::string meta_bytes = meta.bytes(true);
  DicomItem length;
  length.put_longs(0x00020000, {static_cast<std::uint32_t>(meta_bytes.size())});
  return std::string(128, '\0') + "DICM" + length.bytes(true) + meta_bytes + data.bytes(is_explicit);
}

}  // namespace spinaltap::detail
