#include "core/ct/detail/dicom_elements.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
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

/// Whether the first eight bytes are those of an element of group 0002 or of the first of group 0008, little endian.
bool begins_data_set(const std::array<char, 8>& head) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(head[n]); };
  constexpr unsigned kLastTag = 0x70;  // Manufacturer: a data set begins with one of the tags before it
  constexpr unsigned kMaxLength = 256;
  if ((byte(0) != 2 && byte(0) != 8) || byte(1) != 0 || byte(2) > kLastTag || byte(3) != 0) return false;
  if (is_upper(head[4]) && is_upper(head[5])) return true;
  const unsigned length = byte(4) | static_cast<unsigned>(byte(5)) << 8;
  return byte(6) == 0 && byte(7) == 0 && length <= kMaxLength && length % 2 == 0;
}

}  // namespace

bool DicomElementWalker::open(const std::filesystem::path& file) {
  file_ = file;
  if (!bytes_.open(file)) return false;
  std::array<char, 8> head{};
  const bool begins_at_once = bytes_.peek(head.data(), head.size()) && begins_data_set(head);
  std::array<char, 132> start{};
  has_preamble_ = bytes_.read(start.data(), start.size()) && std::memcmp(start.data() + 128, "DICM", 4) == 0;
  return has_preamble_ || (begins_at_once && bytes_.rewind());
}

std::string DicomElementWalker::plain_syntax() const {
  if (big_endian_) return "1.2.840.10008.1.2.2";
  return implicit_ ? "1.2.840.10008.1.2" : "1.2.840.10008.1.2.1";
}

void DicomElementWalker::set_transfer_syntax(std::string_view uid) { deflated_ = uid == "1.2.840.10008.1.2.1.99"; }

void DicomElementWalker::fail_short() const {
  fail("expected a whole DICOM file, found one that is cut short or broken: ", file_.string());
}

void DicomElementWalker::read(char* bytes, std::uint64_t count) {
  if (!bytes_.read(bytes, count)) fail_short();
}

void DicomElementWalker::move_to(std::uint64_t position) {
  if (position < bytes_.position() || !bytes_.skip(position - bytes_.position())) fail_short();
}

std::uint16_t DicomElementWalker::read_u16() {
  std::array<char, 2> bytes{};
  read(bytes.data(), bytes.size());
  const auto at = [&](std::size_t n) { return static_cast<unsigned char>(bytes[n]); };
  return static_cast<std::uint16_t>(big_endian_ ? at(0) << 8 | at(1) : at(0) | at(1) << 8);
}

std::uint32_t DicomElementWalker::read_u32() {
  const std::uint32_t first = read_u16();
  const std::uint32_t second = read_u16();
  return big_endian_ ? first << 16 | second : first | second << 16;
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
    element.is_bytes = name == "OB";
    element.implicit_inside = name == "UN";  // PS3.5, 6.2.2: unknown sequences are implicit
  }
  element.undefined_length = element.length == kUndefinedLength;
  element.offset = bytes_.position();
  if (!element.undefined_length && !bytes_.may_hold(element.length)) fail_short();
  return element;
}

/// Behind the file's own group 0002, which is always explicit little endian.
void DicomElementWalker::begin_data_set() {
  past_meta_ = true;
  data_set_offset_ = bytes_.position();
  if (deflated_) bytes_.inflate_from_here();
  std::array<char, 6> head{};
  if (!bytes_.peek(head.data(), head.size())) fail_short();
  // Files exist that name one syntax and use the other: what they use shows in the first element, whose group is 0008.
  big_endian_ = head[0] == 0 && head[1] != 0;
  implicit_ = !(is_upper(head[4]) && is_upper(head[5]));
}

bool DicomElementWalker::next(DicomElement& element) {
  if (!past_meta_) {
    if (bytes_.at_end()) return false;
    std::array<char, 2> group{};
    if (!bytes_.peek(group.data(), group.size())) fail_short();
    if (group[0] != 2 || group[1] != 0) begin_data_set();
  }
  if (bytes_.at_end()) return false;
  element = read_element(implicit_);
  return true;
}

void DicomElementWalker::skip(const DicomElement& element) {
  if (element.undefined_length) {
    skip_sequence(element.implicit_inside, 0);
  } else {
    move_to(element.offset + element.length);
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
      move_to(item.offset + item.length);
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
      move_to(inner.offset + inner.length);
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

void DicomElementWalker::items(const DicomElement& element,
                               const std::function<void(std::size_t item, const DicomElement&)>& visit) {
  constexpr std::uint64_t kNoEnd = std::numeric_limits<std::uint64_t>::max();
  const auto end_of = [](const DicomElement& e) { return e.undefined_length ? kNoEnd : e.offset + e.length; };
  const std::uint64_t end = end_of(element);
  for (std::size_t item = 0; bytes_.position() < end; ++item) {
    const DicomElement head = read_element(element.implicit_inside);
    if (head.tag == kSequenceEnd && element.undefined_length) return;
    if (head.tag != kItem || (!head.undefined_length && end_of(head) > end)) fail_short();
    while (bytes_.position() < end_of(head)) {
      const DicomElement inner = read_element(element.implicit_inside);
      if (inner.tag == kItemEnd && head.undefined_length) break;
      if (!inner.undefined_length && end_of(inner) > std::min(end, end_of(head))) fail_short();
      visit(item, inner);
    }
  }
}

DicomFragments DicomElementWalker::fragments() {
  DicomFragments pixels;
  bool is_first = true;  // the offset table
  while (true) {
    const DicomElement item = read_element(false);
    if (item.tag == kSequenceEnd) break;
    if (item.tag != kItem || item.undefined_length) fail_short();
    if (is_first) {
      for (std::uint32_t n = 0; n < item.length / 4; ++n) pixels.frames_at.push_back(read_u32());
    } else {
      pixels.fragments.push_back({item.offset, item.length});
    }
    move_to(item.offset + item.length);
    if (is_first) pixels.start = bytes_.position();
    is_first = false;
  }
  return pixels;
}

}  // namespace spinaltap
