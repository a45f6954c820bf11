// NRRD as described at teem.sourceforge.net/nrrd/format.html, and 3D Slicer's segmentations on top of it.

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/base/gzip.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/label_file.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

struct Header {
  std::map<std::string, std::string, std::less<>> fields;  ///< "sizes" to "3 2 2"
  std::map<std::string, std::string> pairs;                ///< "Segment0_Name" to "T11": the format's key/value pairs
  std::size_t data_begins = 0;
};

std::string without_blanks(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

Header read_header(const std::string& content, const std::string& what) {
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  if (!content.starts_with("NRRD")) fail("expected an NRRD file, found one that is not: ", what);
  Header header;
  std::size_t begin = content.find('\n');
  while (begin < kMaxHeader) {
    ++begin;
    const std::size_t end = content.find('\n', begin);
    if (end == std::string::npos) break;
    const std::string line = without_blanks(content.substr(begin, end - begin));
    if (line.empty()) {
      header.data_begins = end + 1;
      return header;
    }
    const std::size_t colon = line.find(": ");
    const std::size_t equals = line.find(":=");
    if (line.front() != '#' && colon < equals) {
      header.fields[line.substr(0, colon)] = without_blanks(line.substr(colon + 2));
    } else if (line.front() != '#' && equals != std::string::npos) {
      header.pairs[line.substr(0, equals)] = without_blanks(line.substr(equals + 2));
    }
    begin = end;
  }
  fail("expected an NRRD header that ends in an empty line, found none in ", what);
}

const std::string& field(const Header& header, std::string_view name, const std::string& what) {
  const auto found = header.fields.find(name);
  if (found == header.fields.end()) fail("expected an NRRD field \"", name, "\", found none in ", what);
  return found->second;
}

/// How numbers are stored.
enum class Stored { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

std::size_t bytes_of(Stored stored) {
  switch (stored) {
    case Stored::kInt8:
    case Stored::kUint8:
      return 1;
    case Stored::kInt16:
    case Stored::kUint16:
      return 2;
    case Stored::kInt32:
    case Stored::kUint32:
    case Stored::kFloat32:
      return 4;
    default:
      return 8;
  }
}

template <class Number>
void take_numbers(std::string_view bytes, const TakeLabels& take) {
  constexpr std::size_t kChunk = 65536;
  std::vector<double> values;
  for (std::size_t left = bytes.size() / sizeof(Number), done = 0; left > 0; left -= values.size()) {
    values.resize(std::min(kChunk, left));
    for (double& value : values) {
      Number number;
      std::memcpy(&number, bytes.data() + done, sizeof number);
      done += sizeof number;
      value = static_cast<double>(number);
    }
    take(values);
  }
}

/// `bytes` in this machine's order.
void take_stored(Stored stored, std::string_view bytes, const TakeLabels& take) {
  switch (stored) {
    case Stored::kInt8:
      return take_numbers<std::int8_t>(bytes, take);
    case Stored::kUint8:
      return take_numbers<std::uint8_t>(bytes, take);
    case Stored::kInt16:
      return take_numbers<std::int16_t>(bytes, take);
    case Stored::kUint16:
      return take_numbers<std::uint16_t>(bytes, take);
    case Stored::kInt32:
      return take_numbers<std::int32_t>(bytes, take);
    case Stored::kUint32:
      return take_numbers<std::uint32_t>(bytes, take);
    case Stored::kInt64:
      return take_numbers<std::int64_t>(bytes, take);
    case Stored::kUint64:
      return take_numbers<std::uint64_t>(bytes, take);
    case Stored::kFloat32:
      return take_numbers<float>(bytes, take);
    case Stored::kFloat64:
      return take_numbers<double>(bytes, take);
  }
}

Stored stored_as(const std::string& type, const std::string& what) {
  static const std::map<std::string, Stored> kTypes{{"signed char", Stored::kInt8},
                                                    {"int8", Stored::kInt8},
                                                    {"int8_t", Stored::kInt8},
                                                    {"uchar", Stored::kUint8},
                                                    {"unsigned char", Stored::kUint8},
                                                    {"uint8", Stored::kUint8},
                                                    {"uint8_t", Stored::kUint8},
                                                    {"short", Stored::kInt16},
                                                    {"short int", Stored::kInt16},
                                                    {"signed short", Stored::kInt16},
                                                    {"signed short int", Stored::kInt16},
                                                    {"int16", Stored::kInt16},
                                                    {"int16_t", Stored::kInt16},
                                                    {"ushort", Stored::kUint16},
                                                    {"unsigned short", Stored::kUint16},
                                                    {"unsigned short int", Stored::kUint16},
                                                    {"uint16", Stored::kUint16},
                                                    {"uint16_t", Stored::kUint16},
                                                    {"int", Stored::kInt32},
                                                    {"signed int", Stored::kInt32},
                                                    {"int32", Stored::kInt32},
                                                    {"int32_t", Stored::kInt32},
                                                    {"uint", Stored::kUint32},
                                                    {"unsigned int", Stored::kUint32},
                                                    {"uint32", Stored::kUint32},
                                                    {"uint32_t", Stored::kUint32},
                                                    {"longlong", Stored::kInt64},
                                                    {"long long", Stored::kInt64},
                                                    {"int64", Stored::kInt64},
                                                    {"int64_t", Stored::kInt64},
                                                    {"ulonglong", Stored::kUint64},
                                                    {"unsigned long long", Stored::kUint64},
                                                    {"uint64", Stored::kUint64},
                                                    {"uint64_t", Stored::kUint64},
                                                    {"float", Stored::kFloat32},
                                                    {"double", Stored::kFloat64}};
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) fail("expected labels stored as numbers, found NRRD type ", in_quotes(type), " in ", what);
  return found->second;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// The sizes of the three spatial axes. A fourth axis in front counts layers, and only one is taken.
std::array<int, 3> sizes_of(const Header& header, const std::string& what) {
  constexpr long long kMaxVoxels = 1LL << 30;
  const std::vector<std::string> words = words_of(field(header, "sizes", what));
  std::vector<long long> sizes;
  long long voxels = 1;
  for (const std::string& word : words) {
    long long size = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), size);
    if (error != std::errc{} || end != word.data() + word.size() || size < 1 || size > kMaxVoxels / voxels) {
      fail("expected at most ", kMaxVoxels, " voxels, found NRRD sizes ", in_quotes(field(header, "sizes", what)),
           " in ", what);
    }
    voxels *= size;
    sizes.push_back(size);
  }
  if (sizes.size() == 4 && sizes.front() == 1) sizes.erase(sizes.begin());
  if (sizes.size() == 4) {
    fail("expected a label map of one layer, found ", sizes.front(), " in ", what,
         " (3D Slicer: Segmentations, Collapse labelmap layers)");
  }
  if (sizes.size() != 3) fail("expected three NRRD axes, found ", words.size(), " in ", what);
  return {static_cast<int>(sizes[0]), static_cast<int>(sizes[1]), static_cast<int>(sizes[2])};
}

/// "(1,0,0)" as a vector; nothing for "none".
std::optional<Vec3> vector_of(std::string word, const std::string& what) {
  if (word == "none") return std::nullopt;
  std::replace_if(
      word.begin(), word.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  std::istringstream in(word);
  in.imbue(std::locale::classic());
  Vec3 vector;
  std::string rest;
  if (!(in >> vector.x() >> vector.y() >> vector.z()) || in >> rest) {
    fail("expected an NRRD vector of three numbers, found ", in_quotes(word), " in ", what);
  }
  return vector;
}

/// Puts what follows a bracket's end apart, for some writers leave out the blank: "(1,0,0)(0,1,0)".
std::vector<std::string> vectors_of(const std::string& text) {
  std::string spaced;
  bool in_brackets = false;
  for (const char c : text) {
    if (c == '(') in_brackets = true;
    if (!(in_brackets && c == ' ')) spaced += c;
    if (c == ')') {
      in_brackets = false;
      spaced += ' ';
    }
  }
  return words_of(spaced);
}

void set_transform(const Header& header, const std::string& what, LabelFile& labels) {
  static const std::map<std::string, Vec3> kToLps{{"left-posterior-superior", {1, 1, 1}},   {"LPS", {1, 1, 1}},
                                                  {"right-anterior-superior", {-1, -1, 1}}, {"RAS", {-1, -1, 1}},
                                                  {"left-anterior-superior", {1, -1, 1}},   {"LAS", {1, -1, 1}}};
  const std::string& space = field(header, "space", what);
  const auto to_lps = kToLps.find(space);
  if (to_lps == kToLps.end()) {
    fail("expected an NRRD space of LPS, RAS or LAS, found ", in_quotes(space), " in ", what);
  }
  Eigen::Index axis = 0;
  for (const std::string& word : vectors_of(field(header, "space directions", what))) {
    const std::optional<Vec3> direction = vector_of(word, what);
    if (!direction) continue;
    if (axis == 3) fail("expected three NRRD space directions, found more in ", what);
    labels.index_to_patient.col(axis++) = direction->cwiseProduct(to_lps->second);
  }
  if (axis != 3) fail("expected three NRRD space directions, found ", axis, " in ", what);
  const std::vector<std::string> origin = vectors_of(field(header, "space origin", what));
  const std::optional<Vec3> origin_mm = origin.size() == 1 ? vector_of(origin.front(), what) : std::nullopt;
  if (!origin_mm)
    fail("expected one NRRD space origin, found ", in_quotes(field(header, "space origin", what)), " in ", what);
  labels.origin_mm = origin_mm->cwiseProduct(to_lps->second);
  check_transform(labels, what);
}

/// The voxels' bytes, in this machine's order.
std::string voxel_bytes(const Header& header, const std::string& content, std::size_t voxel_count, Stored stored,
                        const std::string& what) {
  for (const char* rejected : {"data file", "datafile", "byte skip", "byteskip", "line skip", "lineskip"}) {
    const auto found = header.fields.find(rejected);
    if (found != header.fields.end() && found->second != "0") {
      fail("expected header and voxels in one NRRD file, one after the other, found ",
           in_quotes(std::string(rejected) + ": " + found->second), " in ", what);
    }
  }
  const std::size_t wanted = voxel_count * bytes_of(stored);
  const std::size_t there = content.size() - header.data_begins;
  const std::string& encoding = field(header, "encoding", what);
  // Deflate shrinks by a factor of 1032 at most.
  const bool is_gzip = encoding == "gzip" || encoding == "gz";
  if (!is_gzip && encoding != "raw")
    fail("expected NRRD encoding raw or gzip, found ", in_quotes(encoding), " in ", what);
  if (wanted > there * (is_gzip ? 1032 : 1)) {
    fail("expected ", wanted, " bytes of voxels, found ", there, " (cut short?): ", what);
  }
  std::string bytes;
  try {
    bytes = is_gzip ? gunzip(std::string_view(content).substr(header.data_begins), wanted)
                    : content.substr(header.data_begins, wanted);
  } catch (const Error& error) {
    fail(error.what(), ": ", what);
  }
  const auto endian = header.fields.find("endian");
  const bool is_big = endian != header.fields.end() && endian->second == "big";
  if (bytes_of(stored) > 1 && is_big != (std::endian::native == std::endian::big)) {
    for (auto number = bytes.begin(); number != bytes.end(); number += static_cast<int>(bytes_of(stored))) {
      std::reverse(number, number + static_cast<int>(bytes_of(stored)));
    }
  }
  return bytes;
}

/// 3D Slicer's segments: each has its number in a key of its own, "Segment3_LabelValue". In one layer no two segments
/// can have one value.
std::map<long long, std::string> segment_names(const Header& header, const std::string& what) {
  constexpr std::string_view kPrefix = "Segment";
  constexpr std::string_view kValue = "_LabelValue";
  std::map<long long, std::string> names;
  for (const auto& [key, text] : header.pairs) {
    if (!key.starts_with(kPrefix) || !key.ends_with(kValue)) continue;
    long long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      fail("expected a number as ", key, ", found ", in_quotes(text), " in ", what);
    }
    const auto name = header.pairs.find(key.substr(0, key.size() - kValue.size()) + "_Name");
    const auto [at, is_new] = names.emplace(value, name == header.pairs.end() ? "" : name->second);
    if (!is_new) fail("expected one segment a label, found two of label ", value, " in ", what);
  }
  return names;
}

}  // namespace

LabelFile read_nrrd_labels(const fs::path& file, const std::function<void(const LabelFile&)>& begin,
                           const TakeLabels& take) {
  const std::string what = file.string();
  const std::string content = read_whole_file(file);
  const Header header = read_header(content, what);
  LabelFile labels;
  labels.size = sizes_of(header, what);
  set_transform(header, what, labels);
  const Stored stored = stored_as(field(header, "type", what), what);
  const std::string bytes = voxel_bytes(header, content, labels.voxel_count(), stored, what);
  if (begin) begin(labels);
  take_stored(stored, bytes, take);
  labels.names = segment_names(header, what);
  return labels;
}

}  // namespace spinaltap::detail
