#include "core/files/json_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

/// The library's words without its own name for the mistake, and without the text at fault, which may be long:
/// "[json.exception.parse_error.101] parse error at line 1, column 3: syntax error while parsing value - invalid
/// literal; last read: '{n'".
std::string json_mistake(const nlohmann::json::exception& error) {
  std::string words = error.what();
  if (const std::size_t end = words.find("] "); words.starts_with('[') && end != std::string::npos) {
    words.erase(0, end + 2);
  }
  for (const std::string_view head : {"parse error at ", "parse error: "}) {
    if (words.starts_with(head)) words.erase(0, head.size());
  }
  if (const std::size_t syntax = words.find("syntax error "); syntax != std::string::npos) {
    words.erase(syntax, std::string_view("syntax error ").size());
  }
  if (const std::size_t token = words.find("; last read: "); token != std::string::npos) {
    const std::size_t expected = words.rfind("; expected ");
    words.erase(token, expected != std::string::npos && expected > token ? expected - token : std::string::npos);
  }
  return words;
}

/// Of brackets in one another, those within texts aside.
std::size_t depth_of(std::string_view text) {
  std::size_t depth = 0, max_depth = 0;
  bool is_text = false;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char c = text[n];
    if (c == '"') is_text = !is_text;
    if (is_text && c == '\\') ++n;  // a quote may follow
    if (is_text) continue;
    if (c == '[' || c == '{') max_depth = std::max(max_depth, ++depth);
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return max_depth;
}

}  // namespace

Json read_json(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  const std::string text = read_whole_file(path, kMaxBytes);
  return parse_json(text, path.string());
}

Json parse_json(const std::string& text, const std::string& what) {
  constexpr std::size_t kMaxDepth = 64;
  if (const std::size_t depth = depth_of(text); depth > kMaxDepth) {
    fail("cannot read ", what, " as JSON: expected arrays and objects at most ", kMaxDepth,
         " deep in one another, found ", depth);
  }
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    fail("cannot read ", what, " as JSON: ", json_mistake(error));
  }
}

std::string shown_value(const Json& value) { return shown(std::string_view(value.dump())); }

void write_json(const Json& json, const std::filesystem::path& path) {
  StagedOutput output;
  output.write(path, json.dump(2) + "\n");
  output.commit();
}

JsonObject::JsonObject(const Json& json, std::filesystem::path file) : json_(json), file_(std::move(file)) {
  if (!json.is_object()) fail("expected a JSON object in ", file_.string(), ", found ", json.type_name());
}

bool JsonObject::has(const char* key) const { return json_.contains(key); }

const Json& JsonObject::at(const char* key) const {
  if (!json_.contains(key)) fail("expected \"", key, "\" in ", file_.string(), ", found none");
  return json_.at(key);
}

double JsonObject::number(const char* key) const {
  const Json& value = at(key);
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    fail("expected a number for \"", key, "\" in ", file_.string(), ", found ", shown_value(value));
  }
  return value.get<double>();
}

double JsonObject::number_or(const char* key, double fallback) const { return has(key) ? number(key) : fallback; }

std::uint64_t JsonObject::whole_number(const char* key) const {
  constexpr double kExact = 0x1.0p53;
  const Json& value = at(key);
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  const double number = value.is_number_float() ? value.get<double>() : -1.0;
  if (!(number >= 0.0 && number <= kExact && number == std::floor(number))) {
    fail("expected a whole number of 0 or more for \"", key, "\" in ", file_.string(), ", found ", shown_value(value));
  }
  return static_cast<std::uint64_t>(number);
}

std::string JsonObject::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) fail("expected text for \"", key, "\" in ", file_.string(), ", found ", shown_value(value));
  return value.get<std::string>();
}

bool JsonObject::flag(const char* key) const {
  const Json& value = at(key);
  if (!value.is_boolean()) {
    fail("expected true or false for \"", key, "\" in ", file_.string(), ", found ", shown_value(value));
  }
  return value.get<bool>();
}

Vec3 JsonObject::vector(const char* key) const {
  const Json& value = at(key);
  const auto finite = [](const Json& item) { return item.is_number() && std::isfinite(item.get<double>()); };
  if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), finite)) {
    fail("expected three numbers for \"", key, "\" in ", file_.string(), ", found ", shown_value(value));
  }
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

void check_keys(const Json& json, std::initializer_list<std::string_view> known, const std::filesystem::path& file,
                std::string_view what) {
  const JsonObject object(json, file);  // rejects what has no keys
  for (const auto& item : json.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      fail("expected ", what, " in ", file.string(), ", found ", in_quotes(item.key()), ", which is none");
    }
  }
}

void check_format(const Json& json, const FileFormat& format, const std::filesystem::path& file,
                  std::initializer_list<int> versions) {
  const JsonObject object(json, file);
  const bool has_format = object.has("format");
  if (has_format && object.text("format") != format.name) {
    fail("expected a ", format.name, " in ", file.string(), ", found a ", shown(object.text("format")));
  }
  if (!has_format || !object.has("version")) {
    fail(file.string(), ": this is a version 1 ", format.what, ", or none: it has no \"",
         has_format ? "version" : "format", "\"; version ", kFormatVersion, " (\"format\": \"", format.name,
         "\", \"version\": ", kFormatVersion, ") is expected: ", format.remedy);
  }
  const double version = object.number("version");
  if (std::ranges::find(versions, version) == versions.end()) {
    fail(file.string(), ": this is a version ", version, " ", format.what, "; version ", kFormatVersion,
         " is expected: ", format.remedy);
  }
}

Json format_head(const FileFormat& format) { return {{"format", format.name}, {"version", kFormatVersion}}; }

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace spinaltap
