#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/base/geometry.h"

namespace spinaltap {

/// Keys keep the order in which they were written. Only its name is known here: who looks into one includes nlohmann's
/// json.hpp. Headers that name it are for files of this room and for programs, and are not installed.
using Json = nlohmann::ordered_json;

/// Parses a JSON file. Throws Error with the file and the place of the mistake, and where arrays and objects lie more
/// than 64 deep in one another: what walks through them calls itself.
Json read_json(const std::filesystem::path& path);
/// The same of a text; `what` it is, for the complaint.
Json parse_json(const std::string& text, const std::string& what);

/// The start of a value, for a message.
std::string shown_value(const Json& value);

/// Writes a staged JSON file and gives it its name.
void write_json(const Json& json, const std::filesystem::path& path);

/// Reads members of one JSON object and names the file and the key in every complaint.
class JsonObject {
 public:
  JsonObject(const Json& json, std::filesystem::path file);

  /// Throws Error when the key is missing or not a finite number.
  double number(const char* key) const;
  double number_or(const char* key, double fallback) const;
  /// Of 0 or more: any that fits 64 bits, or one written as 1e6 as far as doubles are exact (2^53).
  std::uint64_t whole_number(const char* key) const;
  std::string text(const char* key) const;
  /// True or false.
  bool flag(const char* key) const;
  /// An array of three numbers.
  Vec3 vector(const char* key) const;
  bool has(const char* key) const;
  const Json& at(const char* key) const;

 private:
  const Json& json_;
  std::filesystem::path file_;
};

/// The version of all JSON formats of the library, which their files name beside "format"; docs/file-formats.md lists
/// what each version changed.
inline constexpr int kFormatVersion = 2;

/// One of these formats.
struct FileFormat {
  const char* name = "";    ///< as "format" has it
  const char* what = "";    ///< as people call it: "plan"
  const char* remedy = "";  ///< for a file of an older version: "plan again"
};
/// Throws Error that names the file, its version and the remedy, where it is not of this format in one of `versions`,
/// of which there may be more than kFormatVersion. Version 1 of some formats had neither key.
void check_format(const Json& json, const FileFormat& format, const std::filesystem::path& file,
                  std::initializer_list<int> versions = {kFormatVersion});
/// What begins a file of it: "format" and "version".
Json format_head(const FileFormat& format);

/// Rejects a key that is not among `known`: nobody would read it, and it is likely a slip of the pen. `what`: what the
/// key ought to be, as in "a rule of planning".
void check_keys(const Json& json, std::initializer_list<std::string_view> known, const std::filesystem::path& file,
                std::string_view what);

/// [x, y, z]
Json to_json(const Vec3& v);

/// JSON has no infinity and no "not a number": null.
Json number_or_null(double value);

}  // namespace spinaltap
