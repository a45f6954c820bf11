#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace spinaltap::test {

/// A DICOM file put together byte by byte, so that tests of the reader do not rest on our own writer.
/// Made as a valid CT slice of 4 x 3 pixels, 16 bit unsigned, stored = 100 + index, intercept -1024, at z = 0.
class HandMadeDicom {
 public:
  struct Value {
    std::string vr;
    std::string bytes;
  };

  HandMadeDicom() {
    set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
    set(0x00080060, "CS", "CT");
    set(0x0020000e, "UI", "1.2.3");
    set(0x00200032, "DS", "0\\0\\0");
    set(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    set_short(0x00280002, 1);
    set(0x00280004, "CS", "MONOCHROME2");
    set_short(0x00280010, 3);
    set_short(0x00280011, 4);
    set(0x00280030, "DS", "0.5\\0.25");
    set_short(0x00280100, 16);
    set_short(0x00280101, 16);
    set_short(0x00280102, 15);
    set_short(0x00280103, 0);
    set(0x00281052, "DS", "-1024");
    set(0x00281053, "DS", "1");
    std::vector<std::uint16_t> pixels;
    for (std::uint16_t n = 0; n < 12; ++n) pixels.push_back(static_cast<std::uint16_t>(100 + n));
    set_pixels(pixels);
  }

  HandMadeDicom& set(std::uint32_t tag, const std::string& vr, std::string bytes) {
    if (bytes.size() % 2 != 0) bytes.push_back(vr == "UI" ? '\0' : ' ');
    values_[tag] = {vr, bytes};
    return *this;
  }
  HandMadeDicom& set_short(std::uint32_t tag, int value) { return set(tag, "US", little_endian(value, 2)); }
  HandMadeDicom& set_z(double z_mm) { return set(0x00200032, "DS", "0\\0\\" + std::to_string(z_mm)); }
  HandMadeDicom& set_pixels(const std::vector<std::uint16_t>& pixels) {
    std::string bytes;
    for (const std::uint16_t pixel : pixels) bytes += little_endian(pixel, 2);
    return set(0x7fe00010, "OW", bytes);
  }
  HandMadeDicom& remove(std::uint32_t tag) {
    values_.erase(tag);
    return *this;
  }
  /// The attribute's value; null where there is none.
  const Value* find(std::uint32_t tag) const {
    const auto found = values_.find(tag);
    return found == values_.end() ? nullptr : &found->second;
  }
  HandMadeDicom& make_implicit() {
    implicit_ = true;
    return *this;
  }
  HandMadeDicom& set_transfer_syntax(const std::string& uid) {
    transfer_syntax_ = uid;
    return *this;
  }

  std::string bytes() const {
    std::string meta;
    std::string syntax =
        transfer_syntax_.empty() ? (implicit_ ? "1.2.840.10008.1.2" : "1.2.840.10008.1.2.1") : transfer_syntax_;
    if (syntax.size() % 2 != 0) syntax.push_back('\0');
    append(meta, 0x00020010, {"UI", syntax}, false);
    std::string file(128, '\0');
    file += "DICM";
    append(file, 0x00020000, {"UL", little_endian(static_cast<long long>(meta.size()), 4)}, false);
    file += meta;
    for (const auto& [tag, value] : values_) append(file, tag, value, implicit_);
    return file;
  }

 private:
  static std::string little_endian(long long value, int count) {
    std::string bytes;
    for (int n = 0; n < count; ++n) bytes.push_back(static_cast<char>(value >> (8 * n) & 0xff));
    return bytes;
  }
  static void append(std::string& file, std::uint32_t tag, const Value& value, bool implicit) {
    file += little_endian(tag >> 16, 2) + little_endian(tag & 0xffff, 2);
    const auto length = static_cast<long long>(value.bytes.size());
    if (implicit) {
      file += little_endian(length, 4);
    } else if (value.vr == "OW" || value.vr == "SQ" || value.vr == "UN") {
      file += value.vr + std::string(2, '\0') + little_endian(length, 4);
    } else {
      file += value.vr + little_endian(length, 2);
    }
    file += value.bytes;
  }

  std::map<std::uint32_t, Value> values_;
  std::string transfer_syntax_;
  bool implicit_ = false;
};

}  // namespace spinaltap::test
