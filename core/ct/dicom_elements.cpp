#include "core/ct/dicom_elements.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr std::uint32_t kItem = 0xfffee000;
constexpr std::uint32_t kItemEnd = 0xfffee00d;
constexpr std::uint32_t kSequenceEnd = 0xfffee0dd;
constexpr std::uint32_t kUndefinedLength = 0xffffffff;
constexpr int kMaxDepth = 32;

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

/// Value representations whose length has four bytes, after two unused ones (PS3.5, table 7.1-1).
bool has_long_length(std::string_view vr) {
  for (const std::string_view known : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"}) {
    if (vr == known) return true;
  }
  return false;
}

}  // namespace

bool DicomElementWalker::open(const std::filesystem::path& file) {
  file_ = file;
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (error || size_ < 132) return false;
  stream_.open(file, std::ios::binary);
  std::array<char, 132> start{};
  if (!stream_.read(start.data(), start.size())) return false;
  position_ = start.size();
  return std::memcmp(start.data() + 128, "DICM", 4) == 0;
}

void DicomElementWalker::fail_short() const {
  fail("expected a whole DICOM file, found one that is cut short or broken: ", file_.string());
}

void DicomElementWalker::read(void* bytes, std::uint64_t count) {
  if (count > left()) fail_short();
  if (!stream_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count))) fail_short();
  position_ += count;
}

void DicomElementWalker::seek(std::uint64_t position) {
  if (position > size_) fail_short();
  constexpr std::uint64_t kShortWay = 1024;
  if (position >= position_ && position - position_ <= kShortWay) {
    stream_.ignore(static_cast<std::streamsize>(position - position_));  // keeps what the stream has buffered
  } else {
    stream_.seekg(static_cast<std::streamoff>(position));
  }
  position_ = position;
}

std::uint16_t DicomElementWalker::read_u16() {
  std::array<unsigned char, 2> bytes{};
  read(bytes.data(), bytes.size());
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

std::uint32_t DicomElementWalker::read_u32() {
  const std::uint32_t low = read_u16();
  return low | static_cast<std::uint32_t>(read_u16()) << 16;
}

std::uint32_t DicomElementWalker::read_tag() {
  const std::uint32_t group = read_u16();
  return group << 16 | read_u16();
}

DicomElement DicomElementWalker::read_element(bool implicit) {
  DicomElement element;
  element.tag = read_tag();
  const bool is_delimiter = element.tag >> 16 == 0xfffe;  // these never have a value representation
  if (implicit || is_delimiter) {
    element.length = read_u32();
    element.implicit_inside = implicit;
  } else {
    std::array<char, 2> vr{};
    read(vr.data(), vr.size());
    if (!is_upper(vr[0]) || !is_upper(vr[1])) fail_short();
    const std::string_view name(vr.data(), vr.size());
    if (has_long_length(name)) {
      static_cast<void>(read_u16());
      element.length = read_u32();
    } else {
      element.length = read_u16();
    }
    element.implicit_inside = name == "UN";  // PS3.5, 6.2.2: unknown sequences are implicit
  }
  element.undefined_length = element.length == kUndefinedLength;
  element.offset = position_;
  if (!element.undefined_length && element.length > left()) fail_short();
  return element;
}

bool DicomElementWalker::next(DicomElement& element) {
  if (left() == 0) return false;
  if (!past_meta_) {
    const std::uint64_t start = position_;
    std::array<char, 6> head{};
    read(head.data(), head.size());
    past_meta_ = head[0] != 2 || head[1] != 0;
    // Files exist that name one syntax and use the other: what they use shows in the first element.
    implicit_ = past_meta_ && !(is_upper(head[4]) && is_upper(head[5]));
    seek(start);
  }
  element = read_element(implicit_);
  return true;
}

void DicomElementWalker::skip(const DicomElement& element) {
  if (element.undefined_length) {
    skip_sequence(element.implicit_inside, 0);
  } else {
    seek(element.offset + element.length);
  }
}

void DicomElementWalker::skip_sequence(bool implicit, int depth) {
  if (depth > kMaxDepth) fail_short();
  while (true) {
    const DicomElement item = read_element(implicit);
    if (item.tag == kSequenceEnd) return;
    if (item.tag != kItem) fail_short();
    if (item.undefined_length) {
      skip_item(implicit, depth);
    } else {
      seek(item.offset + item.length);
    }
  }
}

void DicomElementWalker::skip_item(bool implicit, int depth) {
  while (true) {
    const DicomElement inner = read_element(implicit);
    if (inner.tag == kItemEnd) return;
    if (inner.undefined_length) {
      skip_sequence(inner.implicit_inside, depth + 1);
    } else {
      seek(inner.offset + inner.length);
    }
  }
}

std::string DicomElementWalker::value(const DicomElement& element, std::uint32_t max_bytes) {
  if (element.undefined_length) {
    skip(element);
    return {};
  }
  std::string bytes(std::min(element.length, max_bytes), '\0');
  read(bytes.data(), bytes.size());
  skip(element);
  return bytes;
}

std::vector<ByteRange> DicomElementWalker::fragments() {
  std::vector<ByteRange> ranges;
  while (true) {
    const DicomElement item = read_element(false);
    if (item.tag == kSequenceEnd) break;
    if (item.tag != kItem || item.undefined_length) fail_short();
    ranges.push_back({item.offset, item.length});
    seek(item.offset + item.length);
  }
  if (!ranges.empty()) ranges.erase(ranges.begin());
  return ranges;
}

}  // namespace spinaltap
