// MetaImage as described at itk.org/Wiki/MetaIO/Documentation, placed as ITK places it: TransformMatrix has the
// directions of the axes one after the other, and both it and Offset are patient LPS.

#include <algorithm>
#include <array>
#include <cmath>
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

struct MetaHeader {
  fs::path file;
  std::map<std::string, std::string, std::less<>> fields;  ///< "DimSize" to "3 2 2"
  std::vector<std::string> listed;                         ///< lines behind "ElementDataFile = LIST"
  std::size_t data_begins = 0;

  /// The first of the names that there is: some fields have several.
  const std::string* find(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      const auto found = fields.find(name);
      if (found != fields.end()) return &found->second;
    }
    return nullptr;
  }
  const std::string& at(std::initializer_list<std::string_view> names) const {
    const std::string* found = find(names);
    if (found == nullptr) fail("expected a MetaImage field ", *names.begin(), ", found none in ", file.string());
    return *found;
  }
};

/// One name a field: some have several. ElementSize is none of them: it may differ from the step.
std::string meta_field_name(std::string_view name) {
  static const std::map<std::string, std::string, std::less<>> kOtherNames{
      {"Position", "Offset"},
      {"Origin", "Offset"},
      {"Rotation", "TransformMatrix"},
      {"Orientation", "TransformMatrix"},
      {"ElementByteOrderMSB", "BinaryDataByteOrderMSB"}};
  const auto other = kOtherNames.find(name);
  return other == kOtherNames.end() ? std::string(name) : other->second;
}

MetaHeader read_meta_header(const fs::path& file) {
  const std::string content = read_header_bytes(file);
  MetaHeader header;
  header.file = file;
  std::size_t begin = 0;
  bool is_listing = false;
  while (begin < content.size()) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    std::string_view line = trimmed(std::string_view(content).substr(begin, end - begin));
    if (line.ends_with('\r')) line = trimmed(line.substr(0, line.size() - 1));
    begin = end + 1;
    const std::size_t equals = line.find_first_of("=:");
    if (is_listing) {
      if (!line.empty()) header.listed.emplace_back(line);
    } else if (equals != std::string_view::npos) {
      const std::string key = meta_field_name(trimmed(line.substr(0, equals)));
      put_field(header.fields, key, trimmed(line.substr(equals + 1)), "MetaImage", file);
      if (key != "ElementDataFile") continue;
      header.data_begins = begin;
      is_listing = header.fields[key].starts_with("LIST");
      if (!is_listing) return header;
    } else if (!line.empty()) {
      break;
    }
  }
  if (!is_listing) fail("expected a MetaImage header that ends with ElementDataFile, found none in ", file.string());
  return header;
}

StoredType stored_type(const MetaHeader& header) {
  using enum StoredType;
  static const std::map<std::string, StoredType, std::less<>> kTypes{
      {"MET_CHAR", kInt8},         {"MET_UCHAR", kUint8},   {"MET_ASCII_CHAR", kInt8}, {"MET_SHORT", kInt16},
      {"MET_USHORT", kUint16},     {"MET_INT", kInt32},     {"MET_UINT", kUint32},     {"MET_LONG_LONG", kInt64},
      {"MET_ULONG_LONG", kUint64}, {"MET_FLOAT", kFloat32}, {"MET_DOUBLE", kFloat64}};
  const std::string& type = header.at({"ElementType"});
  const auto found = kTypes.find(type);
  if (found != kTypes.end()) return found->second;
  fail("expected voxels stored as numbers, found MetaImage ElementType ", in_quotes(type), " in ", header.file.string(),
       type.find("LONG") != std::string::npos ? " (its size differs between machines)" : "");
}

std::vector<double> numbers(const MetaHeader& header, std::initializer_list<std::string_view> names,
                            std::size_t count) {
  const std::string& text = header.at(names);
  std::vector<double> found;
  for (const std::string& word : words_of(text)) {
    const std::optional<double> number = parse_number(word);
    if (!number) break;
    found.push_back(*number);
  }
  if (found.size() != count || words_of(text).size() != count) {
    fail("expected ", count, " numbers as MetaImage ", *names.begin(), ", found ", in_quotes(text), " in ",
         header.file.string());
  }
  return found;
}

bool is_true(const MetaHeader& header, std::initializer_list<std::string_view> names, bool if_missing) {
  const std::string* text = header.find(names);
  if (text == nullptr) return if_missing;
  const std::string lower = lower_case(*text);
  if (lower == "true" || lower == "t" || lower == "1") return true;
  if (lower == "false" || lower == "f" || lower == "0") return false;
  fail("expected True or False as MetaImage ", *names.begin(), ", found ", in_quotes(*text), " in ",
       header.file.string());
}

double unit_in_mm(const MetaHeader& header) {
  const std::string* unit = header.find({"DistanceUnits"});
  if (unit == nullptr || *unit == "?" || lower_case(*unit) == "mm") return 1.0;
  if (lower_case(*unit) == "cm") return 10.0;
  if (lower_case(*unit) == "um") return 0.001;
  fail("expected MetaImage DistanceUnits of mm, found ", in_quotes(*unit), " in ", header.file.string());
}

/// AnatomicalOrientation says the axes again, in letters: where they come from (ITK: RAI for axes to the left, to the
/// back and to the head) or where they lead (LPS). ITK does not look at it, other programs do; where it fits the matrix
/// in neither sense, one of them is wrong.
void check_letters(const MetaHeader& header, const Mat3& directions) {
  constexpr double kClear = 0.8;  // cosine; axes nearer to 45 degrees may be called either way
  const std::string* text = header.find({"AnatomicalOrientation"});
  if (text == nullptr || text->size() != 3 || text->find('?') != std::string::npos) return;
  constexpr std::array<std::string_view, 3> kTo{"RL", "AP", "IS"};  // towards -x and +x, -y and +y, -z and +z of LPS
  bool fits_to = true, fits_from = true;
  const std::string letters = upper_case(*text);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index row = 0;
    const double max = directions.col(axis).cwiseAbs().maxCoeff(&row);
    if (max < kClear) continue;
    const bool is_up = directions(row, axis) > 0.0;
    const std::string_view ends = kTo[static_cast<std::size_t>(row)];
    const char letter = letters[static_cast<std::size_t>(axis)];
    fits_to = fits_to && letter == ends[is_up ? 1 : 0];
    fits_from = fits_from && letter == ends[is_up ? 0 : 1];
  }
  if (fits_to || fits_from) return;
  fail("expected a MetaImage whose AnatomicalOrientation and TransformMatrix say the same, found ", in_quotes(*text),
       " and another orientation in the matrix of ", header.file.string(),
       " (one of them is wrong; ITK and 3D Slicer go by the matrix)");
}

void place(const MetaHeader& header, VolumeFile& volume) {
  std::vector<long long> sizes;
  for (const std::string& word : words_of(header.at({"DimSize"}))) {
    const std::optional<long long> size = whole_number(word);
    if (!size) {
      fail("expected sizes as MetaImage DimSize, found ", in_quotes(header.at({"DimSize"})), " in ",
           header.file.string());
    }
    sizes.push_back(*size);
  }
  const std::optional<long long> stated_axes = whole_number(header.at({"NDims"}));
  if (!stated_axes || *stated_axes != static_cast<long long>(sizes.size())) {
    fail("expected as many MetaImage DimSize as NDims, found ", sizes.size(), " and ", in_quotes(header.at({"NDims"})),
         " in ", header.file.string());
  }
  const std::size_t axes = sizes.size();
  if (axes == 4 && sizes.back() == 1) sizes.pop_back();  // one time
  volume.size = three_sizes(sizes, "MetaImage axes", header.at({"DimSize"}), header.file);
  const double unit_mm = unit_in_mm(header);
  const std::vector<double> spacing = numbers(header, {"ElementSpacing", "ElementSize"}, axes);
  const std::vector<double> offset = numbers(header, {"Offset"}, axes);
  Mat3 directions = Mat3::Identity();
  if (header.find({"TransformMatrix"}) != nullptr) {
    const std::vector<double> matrix = numbers(header, {"TransformMatrix"}, axes * axes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row) {
        directions(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(axis)) = matrix[axes * axis + row];
      }
    }
  }
  const Vec3 lengths = directions.colwise().norm();
  if (!((lengths - Vec3::Ones()).cwiseAbs().maxCoeff() < 1e-3)) {
    fail("expected unit vectors as MetaImage TransformMatrix (steps stand in ElementSpacing), found lengths of ",
         lengths[0], ", ", lengths[1], " and ", lengths[2], " in ", header.file.string());
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<Eigen::Index>(axis);
    if (!(spacing[axis] > 0.0)) {
      fail("expected a MetaImage ElementSpacing above 0, found ", spacing[axis], " in ", header.file.string());
    }
    volume.index_to_patient.col(n) = unit_mm * spacing[axis] * directions.col(n).normalized();
    volume.origin_mm[n] = unit_mm * offset[axis];
  }
  check_placed(volume, header.file);
  check_letters(header, directions);
}

/// The files of the voxels: the header's own, the one it names, a numbered row, or a list.
std::vector<fs::path> data_files(const MetaHeader& header) {
  const std::string& data = header.at({"ElementDataFile"});
  if (upper_case(data) == "LOCAL") return {header.file};
  std::vector<fs::path> files;
  if (data.starts_with("LIST")) {
    for (const std::string& name : header.listed) files.push_back(beside(header.file, name));
    return files;
  }
  const std::vector<std::string> words = words_of(data);
  // "slice%03d.raw 1 60 1"
  if (words.size() == 4 && words.front().find('%') != std::string::npos) {
    const std::optional<long long> first = whole_number(words[1]);
    const std::optional<long long> last = whole_number(words[2]);
    const std::optional<long long> step = whole_number(words[3]);
    if (first && last && step) return numbered_files(header.file, words.front(), *first, *last, *step);
  }
  return {beside(header.file, data)};
}

/// Values that a header would have changed after reading: programs differ in whether they do.
void check_values_as_they_are(const MetaHeader& header) {
  const std::string* channels = header.find({"ElementNumberOfChannels"});
  if (channels != nullptr && *channels != "1") {
    fail("expected one number a voxel, found MetaImage ElementNumberOfChannels ", in_quotes(*channels), " in ",
         header.file.string());
  }
  const auto is_other = [&](std::string_view name, double plain) {
    const std::string* text = header.find({name});
    return text != nullptr && parse_number(*text) != plain;
  };
  if (is_other("ElementToIntensityFunctionSlope", 1.0) || is_other("ElementToIntensityFunctionOffset", 0.0)) {
    fail(
        "expected a MetaImage whose values are HU as they stand, found an ElementToIntensityFunction, which programs "
        "read or leave, in ",
        header.file.string());
  }
}

StoredVoxels stored_voxels(const MetaHeader& header, std::size_t voxel_count) {
  StoredVoxels voxels;
  check_values_as_they_are(header);
  voxels.type = stored_type(header);
  voxels.count = voxel_count;
  const bool is_binary = is_true(header, {"BinaryData"}, true);
  const bool is_deflated = is_true(header, {"CompressedData"}, false);
  if (is_deflated) voxels.encoding = VoxelEncoding::kDeflated;
  if (!is_binary) voxels.encoding = VoxelEncoding::kText;
  if (!is_binary && is_deflated) {
    fail("expected MetaImage CompressedData of BinaryData only, found it of text in ", header.file.string());
  }
  voxels.is_big_endian = is_true(header, {"BinaryDataByteOrderMSB"}, false);
  const std::string* head = header.find({"HeaderSize"});
  const std::optional<long long> skip = head == nullptr ? 0 : whole_number(*head);
  const bool is_plain = is_binary && !is_deflated;
  if (!skip || *skip < VoxelPart::kFromEnd || *skip > (1LL << 31) || (*skip != 0 && !is_plain)) {
    fail("expected a MetaImage HeaderSize of raw data, -1 or more, found ", in_quotes(*head), " in ",
         header.file.string());
  }
  for (const fs::path& file : data_files(header)) {
    voxels.parts.push_back({file, file == header.file ? header.data_begins : 0, 0, *skip});
  }
  check_stored(voxels);
  return voxels;
}

}  // namespace

VolumeFile open_meta_image(const fs::path& file) {
  const MetaHeader header = read_meta_header(file);
  const std::string* type = header.find({"ObjectType"});
  if (type != nullptr && lower_case(*type) != "image") {
    fail("expected a MetaImage of ObjectType Image, found ", in_quotes(*type), " in ", file.string());
  }
  VolumeFile volume;
  volume.format = "MetaImage";
  place(header, volume);
  volume.read_values = [voxels = stored_voxels(header, volume.voxel_count())](const TakeValues& take) {
    read_stored(voxels, take);
  };
  volume.read_label_names = [] { return std::map<long long, std::string>(); };
  return volume;
}

}  // namespace spinaltap::detail
