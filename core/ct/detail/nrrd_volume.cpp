// NRRD as described at teem.sourceforge.net/nrrd/format.html, and 3D Slicer's segmentations on top of it.

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/header_lines.h"
#include "core/ct/detail/stored_voxels.h"
#include "core/ct/detail/volume_file.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

struct NrrdHeader {
  fs::path file;
  std::map<std::string, std::string, std::less<>> fields;  ///< "sizes" to "3 2 2"
  std::map<std::string, std::string, std::less<>> pairs;   ///< "Segment0_Name" to "T11": the format's key/value pairs
  std::vector<std::string> listed;                         ///< lines behind "data file: LIST"
  std::size_t data_begins = 0;

  const std::string* find(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? nullptr : &found->second;
  }
  const std::string& at(std::string_view name) const {
    const std::string* found = find(name);
    if (found == nullptr) fail("expected an NRRD field \"", name, "\", found none in ", file.string());
    return *found;
  }
};

bool has_list(const NrrdHeader& header) {
  const std::string* data = header.find("data file");
  return data != nullptr && (*data == "LIST" || data->starts_with("LIST "));
}

/// One name a field: some have two.
std::string field_name(std::string_view name) {
  static const std::map<std::string, std::string> kOtherNames{
      {"datafile", "data file"},       {"lineskip", "line skip"},
      {"byteskip", "byte skip"},       {"spacedirections", "space directions"},
      {"spaceorigin", "space origin"}, {"spaceunits", "space units"}};
  const std::string lower = lower_case(name);
  const auto other = kOtherNames.find(lower);
  return other == kOtherNames.end() ? lower : other->second;
}

NrrdHeader read_nrrd_header(const fs::path& file) {
  const std::string content = read_header_bytes(file);
  if (!content.starts_with("NRRD")) fail("expected an NRRD file, found one that is not: ", file.string());
  NrrdHeader header;
  header.file = file;
  bool is_listing = false;
  std::size_t begin = content.find('\n');
  while (begin != std::string::npos && begin + 1 < content.size()) {
    ++begin;
    const std::size_t end = content.find('\n', begin);
    const std::string line(trimmed(std::string_view(content).substr(begin, end - begin)));
    const std::string text(line.ends_with('\r') ? trimmed(line.substr(0, line.size() - 1)) : line);
    if (text.empty() && !is_listing) {
      if (end == std::string::npos) break;
      header.data_begins = end + 1;
      return header;
    }
    const std::size_t colon = text.find(": ");
    const std::size_t equals = text.find(":=");
    if (is_listing) {
      if (!text.empty()) header.listed.push_back(text);
    } else if (text.front() != '#' && colon < equals) {
      put_field(header.fields, field_name(text.substr(0, colon)), trimmed(std::string_view(text).substr(colon + 2)),
                "NRRD", file);
      is_listing = has_list(header);
    } else if (text.front() != '#' && equals != std::string::npos) {
      put_field(header.pairs, text.substr(0, equals), trimmed(std::string_view(text).substr(equals + 2)), "NRRD", file);
    } else if (text.front() != '#') {
      fail("expected lines of an NRRD header to be \"field: value\", with a blank, or \"key:=value\", found ",
           in_quotes(text), " in ", file.string());
    }
    begin = end;
  }
  // A header of its own (.nhdr) may end with the file.
  if (header.find("data file") == nullptr) {
    fail("expected an NRRD header that ends in an empty line, found none in ", file.string());
  }
  return header;
}

StoredType stored_type(const NrrdHeader& header) {
  using enum StoredType;
  static const std::map<std::string, StoredType> kTypes{{"signed char", kInt8},
                                                        {"int8", kInt8},
                                                        {"int8_t", kInt8},
                                                        {"uchar", kUint8},
                                                        {"unsigned char", kUint8},
                                                        {"uint8", kUint8},
                                                        {"uint8_t", kUint8},
                                                        {"short", kInt16},
                                                        {"short int", kInt16},
                                                        {"signed short", kInt16},
                                                        {"signed short int", kInt16},
                                                        {"int16", kInt16},
                                                        {"int16_t", kInt16},
                                                        {"ushort", kUint16},
                                                        {"unsigned short", kUint16},
                                                        {"unsigned short int", kUint16},
                                                        {"uint16", kUint16},
                                                        {"uint16_t", kUint16},
                                                        {"int", kInt32},
                                                        {"signed int", kInt32},
                                                        {"int32", kInt32},
                                                        {"int32_t", kInt32},
                                                        {"uint", kUint32},
                                                        {"unsigned int", kUint32},
                                                        {"uint32", kUint32},
                                                        {"uint32_t", kUint32},
                                                        {"longlong", kInt64},
                                                        {"long long", kInt64},
                                                        {"long long int", kInt64},
                                                        {"signed long long", kInt64},
                                                        {"signed long long int", kInt64},
                                                        {"int64", kInt64},
                                                        {"int64_t", kInt64},
                                                        {"ulonglong", kUint64},
                                                        {"unsigned long long", kUint64},
                                                        {"unsigned long long int", kUint64},
                                                        {"uint64", kUint64},
                                                        {"uint64_t", kUint64},
                                                        {"float", kFloat32},
                                                        {"double", kFloat64}};
  const std::string& type = header.at("type");
  const auto found = kTypes.find(lower_case(type));
  if (found == kTypes.end()) {
    fail("expected voxels stored as numbers, found NRRD type ", in_quotes(type), " in ", header.file.string());
  }
  return found->second;
}

/// "(1,0,0)" as a vector; nothing for "none".
std::optional<Vec3> vector_of(std::string word, const fs::path& file) {
  if (lower_case(word) == "none") return std::nullopt;
  std::replace_if(
      word.begin(), word.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  const std::vector<std::string> parts = words_of(word);
  Vec3 vector = Vec3::Zero();
  bool is_vector = parts.size() == 3;
  for (std::size_t n = 0; is_vector && n < 3; ++n) {
    const std::optional<double> number = parse_number(parts[n]);
    is_vector = number.has_value();
    if (is_vector) vector[static_cast<Eigen::Index>(n)] = *number;
  }
  if (!is_vector) fail("expected an NRRD vector of three numbers, found ", in_quotes(word), " in ", file.string());
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

/// Which way the axes of the space run against LPS. Spaces that do not say where the patient's left, back and head are
/// (scanner-xyz, 3D-right-handed) would leave that to chance.
Vec3 space_to_lps(const NrrdHeader& header) {
  static const std::map<std::string, Vec3> kToLps{{"left-posterior-superior", {1, 1, 1}},   {"lps", {1, 1, 1}},
                                                  {"right-anterior-superior", {-1, -1, 1}}, {"ras", {-1, -1, 1}},
                                                  {"left-anterior-superior", {1, -1, 1}},   {"las", {1, -1, 1}}};
  const std::string* space = header.find("space");
  if (space == nullptr) {
    fail("expected an NRRD field \"space\" that says where the patient's left and head are, found none in ",
         header.file.string(), " (save it anew from a program that knows, such as 3D Slicer)");
  }
  const auto to_lps = kToLps.find(lower_case(*space));
  if (to_lps == kToLps.end()) {
    fail("expected an NRRD space of LPS, RAS or LAS, found ", in_quotes(*space), " in ", header.file.string(),
         " (save it anew from a program that knows where the patient's left and head are, such as 3D Slicer)");
  }
  return to_lps->second;
}

/// Of the first three axes that lie in space; 1 where the header does not say, as it may for mm.
double unit_in_mm(const NrrdHeader& header) {
  static const std::map<std::string, double> kUnits{{"mm", 1.0},  {"millimeter", 1.0}, {"millimeters", 1.0},
                                                    {"cm", 10.0}, {"m", 1000.0},       {"um", 0.001}};
  const std::string* units = header.find("space units");
  if (units == nullptr) return 1.0;
  std::optional<double> one;
  for (std::string word : words_of(*units)) {
    std::erase(word, '"');
    const auto unit = kUnits.find(lower_case(word));
    if (unit == kUnits.end() || (one && *one != unit->second)) {
      fail("expected NRRD space units of mm, found ", in_quotes(*units), " in ", header.file.string());
    }
    one = unit->second;
  }
  return one.value_or(1.0);
}

/// Sizes and directions: an axis without a direction counts values a voxel, layers or times, and may have one only.
void place(const NrrdHeader& header, VolumeFile& volume) {
  const std::vector<std::string> words = words_of(header.at("sizes"));
  if (const std::string* dimension = header.find("dimension");
      dimension != nullptr && *dimension != std::to_string(words.size())) {
    fail("expected as many NRRD sizes as the dimension, ", in_quotes(*dimension), ", says, found ",
         in_quotes(header.at("sizes")), " in ", header.file.string());
  }
  const Vec3 to_lps = space_to_lps(header);
  const std::vector<std::string> directions = vectors_of(header.at("space directions"));
  const double unit_mm = unit_in_mm(header);
  std::vector<long long> sizes;
  Eigen::Index axis = 0;
  for (std::size_t n = 0; n < directions.size() || n < words.size(); ++n) {
    const std::optional<long long> size = n < words.size() ? whole_number(words[n]) : std::nullopt;
    if (n < words.size() && !size) {
      fail("expected NRRD sizes, found ", in_quotes(header.at("sizes")), " in ", header.file.string());
    }
    const std::optional<Vec3> direction = n < directions.size() ? vector_of(directions[n], header.file) : std::nullopt;
    if (direction) {
      if (axis == 3) fail("expected three NRRD space directions, found more in ", header.file.string());
      volume.index_to_patient.col(axis++) = unit_mm * direction->cwiseProduct(to_lps);
      if (size) sizes.push_back(*size);
    } else if (n >= directions.size()) {
      sizes.push_back(*size);  // and too few directions are told below
    } else if (size && *size != 1) {
      fail("expected one layer of one number a voxel, found ", *size, " in ", header.file.string(),
           " (3D Slicer: Segmentations, Collapse labelmap layers)");
    }
  }
  volume.size = three_sizes(sizes, "NRRD axes", header.at("sizes"), header.file);
  if (axis != 3) fail("expected three NRRD space directions, found ", axis, " in ", header.file.string());
  const std::string& origin_text = header.at("space origin");
  const std::vector<std::string> origin = vectors_of(origin_text);
  const std::optional<Vec3> p_space = origin.size() == 1 ? vector_of(origin.front(), header.file) : std::nullopt;
  if (!p_space) fail("expected one NRRD space origin, found ", in_quotes(origin_text), " in ", header.file.string());
  volume.origin_mm = unit_mm * p_space->cwiseProduct(to_lps);
  check_placed(volume, header.file);
}

VoxelEncoding encoding_of(const NrrdHeader& header) {
  const std::string encoding = lower_case(header.at("encoding"));
  if (encoding == "raw") return VoxelEncoding::kRaw;
  if (encoding == "gzip" || encoding == "gz") return VoxelEncoding::kDeflated;
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") return VoxelEncoding::kText;
  fail("expected NRRD encoding raw or gzip or ascii, found ", in_quotes(encoding), " in ", header.file.string(),
       " (Teem: unu save -f nrrd -e gzip)");
}

long long number_field(const NrrdHeader& header, std::string_view name, long long min, long long if_missing) {
  constexpr long long kMax = std::numeric_limits<int>::max();
  const std::string* text = header.find(name);
  if (text == nullptr) return if_missing;
  const std::optional<long long> number = whole_number(*text);
  if (!number || *number < min || *number > kMax) {
    fail("expected an NRRD field \"", name, "\" of ", min, " or more, found ", in_quotes(*text), " in ",
         header.file.string());
  }
  return *number;
}

/// The files of the voxels: the header's own, the one it names, a numbered row, or a list.
std::vector<fs::path> data_files(const NrrdHeader& header) {
  const std::string* data = header.find("data file");
  if (data == nullptr) return {header.file};
  if (has_list(header)) {
    std::vector<fs::path> files;
    for (const std::string& name : header.listed) files.push_back(beside(header.file, name));
    return files;
  }
  const std::vector<std::string> words = words_of(*data);
  // "slice%03d.raw 1 60 1", and perhaps how many axes one file has.
  if (words.size() >= 4 && words.front().find('%') != std::string::npos) {
    const std::optional<long long> first = whole_number(words[1]);
    const std::optional<long long> last = whole_number(words[2]);
    const std::optional<long long> step = whole_number(words[3]);
    if (first && last && step) return numbered_files(header.file, words.front(), *first, *last, *step);
  }
  return {beside(header.file, *data)};
}

StoredVoxels stored_voxels(const NrrdHeader& header, std::size_t voxel_count) {
  StoredVoxels voxels;
  voxels.type = stored_type(header);
  voxels.encoding = encoding_of(header);
  voxels.count = voxel_count;
  const std::string* endian = header.find("endian");
  const bool needs_endian = bytes_of(voxels.type) > 1 && voxels.encoding != VoxelEncoding::kText;
  if (needs_endian && (endian == nullptr || (lower_case(*endian) != "little" && lower_case(*endian) != "big"))) {
    fail("expected an NRRD field \"endian\" of little or big, found ", endian == nullptr ? "none" : in_quotes(*endian),
         " in ", header.file.string(), " (nearly all are little: add the line \"endian: little\")");
  }
  voxels.is_big_endian = needs_endian && lower_case(*endian) == "big";
  const long long skip_lines = number_field(header, "line skip", 0, 0);
  const long long skip_bytes = number_field(header, "byte skip", VoxelPart::kFromEnd, 0);
  if (skip_bytes == VoxelPart::kFromEnd && voxels.encoding != VoxelEncoding::kRaw) {
    fail("expected an NRRD byte skip of -1 with encoding raw only, found ", in_quotes(header.at("encoding")), " in ",
         header.file.string());
  }
  for (const fs::path& file : data_files(header)) {
    voxels.parts.push_back(
        {file, file == header.file ? header.data_begins : 0, static_cast<int>(skip_lines), skip_bytes});
  }
  check_stored(voxels);
  return voxels;
}

/// 3D Slicer's segments: each has its number in a key of its own, "Segment3_LabelValue". In one layer no two segments
/// can have one value.
std::map<long long, std::string> segment_names(const NrrdHeader& header) {
  constexpr std::string_view kPrefix = "Segment";
  constexpr std::string_view kValue = "_LabelValue";
  std::map<long long, std::string> names;
  for (const auto& [key, text] : header.pairs) {
    if (!key.starts_with(kPrefix) || !key.ends_with(kValue)) continue;
    const std::optional<long long> value = whole_number(text);
    if (!value) fail("expected a number as ", key, ", found ", in_quotes(text), " in ", header.file.string());
    const auto name = header.pairs.find(key.substr(0, key.size() - kValue.size()) + "_Name");
    const auto [at, is_new] = names.emplace(*value, name == header.pairs.end() ? "" : name->second);
    if (!is_new) fail("expected one segment a label, found two of label ", *value, " in ", header.file.string());
  }
  return names;
}

}  // namespace

VolumeFile open_nrrd(const fs::path& file) {
  const NrrdHeader header = read_nrrd_header(file);
  VolumeFile volume;
  volume.format = "NRRD";
  place(header, volume);
  volume.read_values = [voxels = stored_voxels(header, volume.voxel_count())](const TakeValues& take) {
    read_stored(voxels, take);
  };
  volume.read_label_names = [header] { return segment_names(header); };
  return volume;
}

}  // namespace spinaltap::detail
