#include "core/base/ply_head.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
/// The first name of each type is the one written.
constexpr std::array<TypeName, 16> kTypes{{{"char", PlyType::int8},
                                           {"int8", PlyType::int8},
                                           {"uchar", PlyType::uint8},
                                           {"uint8", PlyType::uint8},
                                           {"short", PlyType::int16},
                                           {"int16", PlyType::int16},
                                           {"ushort", PlyType::uint16},
                                           {"uint16", PlyType::uint16},
                                           {"int", PlyType::int32},
                                           {"int32", PlyType::int32},
                                           {"uint", PlyType::uint32},
                                           {"uint32", PlyType::uint32},
                                           {"float", PlyType::float32},
                                           {"float32", PlyType::float32},
                                           {"double", PlyType::float64},
                                           {"float64", PlyType::float64}}};
constexpr std::array<std::pair<std::string_view, PlyFormat>, 3> kFormats{
    {{"ascii", PlyFormat::ascii},
     {"binary_little_endian", PlyFormat::little_endian},
     {"binary_big_endian", PlyFormat::big_endian}}};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; (begin = line.find_first_not_of(" \t", begin)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

/// A head's line that is not as it should be.
[[noreturn]] void reject(std::string_view expected, std::string_view found, const FileReader& file) {
  fail("expected ", expected, ", found ", in_quotes(found), " in the head of ", file.name());
}

PlyType type_of(std::string_view word, std::string_view line, const FileReader& file) {
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeName& t) { return t.name == word; });
  if (found == kTypes.end()) reject("a PLY type such as float", line, file);
  return found->type;
}

PlyFormat format_of(const std::vector<std::string_view>& words, std::string_view line, const FileReader& file) {
  for (const auto& [name, format] : kFormats) {
    if (words.size() == 3 && words[1] == name && words[2] == "1.0") return format;
  }
  reject("PLY format ascii, binary_little_endian or binary_big_endian 1.0", line, file);
}

PlyElement element_of(const std::vector<std::string_view>& words, std::string_view line, const FileReader& file) {
  std::uint64_t count = 0;
  const auto is_count = [&](std::string_view word) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    return error == std::errc{} && end == word.data() + word.size();
  };
  if (words.size() != 3 || !is_count(words[2])) reject("a PLY element with its name and count", line, file);
  return {std::string(words[1]), count};
}

PlyProperty property_of(const std::vector<std::string_view>& words, std::string_view line, const FileReader& file) {
  if (words.size() == 5 && words[1] == "list") {
    const PlyType count_type = type_of(words[2], line, file);
    if (count_type == PlyType::float32 || count_type == PlyType::float64) reject("a whole list count", line, file);
    return {std::string(words[4]), type_of(words[3], line, file), count_type};
  }
  if (words.size() != 3) reject("a PLY property with its type and name", line, file);
  return {std::string(words[2]), type_of(words[1], line, file)};
}

std::string_view name_of(PlyType type) {
  return std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeName& t) { return t.type == type; })->name;
}

}  // namespace

PlyHead read_ply_head(FileReader& file) {
  std::string_view line;
  if (!file.line(line) || trimmed(line) != "ply") fail("expected a PLY file, found one that is not: ", file.name());
  PlyHead head;
  bool has_format = false;
  while (file.line(line)) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty() || words[0] == "obj_info") continue;
    if (words[0] == "comment") {
      head.comments.emplace_back(trimmed(line.substr(line.find("comment") + 7)));
    } else if (words[0] == "format") {
      head.format = format_of(words, line, file);
      has_format = true;
    } else if (words[0] == "element") {
      head.elements.push_back(element_of(words, line, file));
    } else if (words[0] == "property") {
      if (head.elements.empty()) reject("a PLY element before its properties", line, file);
      head.elements.back().properties.push_back(property_of(words, line, file));
    } else if (words[0] == "end_header") {
      if (!has_format) reject("a PLY format", line, file);
      return head;
    } else {
      reject("a line of a PLY head", line, file);
    }
  }
  fail("expected a PLY head that ends in end_header, found none (cut short?) in ", file.name());
}

std::string encode(const PlyHead& head) {
  std::string text = "ply\nformat ";
  text += kFormats[static_cast<std::size_t>(head.format)].first;
  text += " 1.0\n";
  for (const std::string& comment : head.comments) text += "comment " + comment + "\n";
  for (const PlyElement& element : head.elements) {
    text += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const PlyProperty& property : element.properties) {
      text += "property ";
      if (property.count_type) text.append("list ").append(name_of(*property.count_type)).append(" ");
      text.append(name_of(property.type)).append(" ").append(property.name).append("\n");
    }
  }
  return text + "end_header\n";
}

}  // namespace spinaltap
