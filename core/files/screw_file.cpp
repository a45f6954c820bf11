#include "core/files/screw_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/files/detail/tool_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kScrewsFormat{"spinaltap-screws", "table of screws", "see docs/data-files.md"};

std::vector<double> rising_numbers(const JsonObject& object, const char* key, const std::filesystem::path& path) {
  const Json& list = object.at(key);
  std::vector<double> numbers;
  for (const Json& item : list.is_array() ? list : Json::array()) {
    if (item.is_number()) numbers.push_back(item.get<double>());
  }
  if (numbers.empty() || numbers.size() != list.size()) {
    fail("expected one number or more for \"", key, "\" in ", path.string(), ", found ", shown_value(list));
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace

std::vector<PedicleScrew> read_screws(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kScrewsFormat, path);
  const JsonObject object(json, path);
  const ScrewHead head = object.has("head") ? read_screw_head(object.at("head"), path) : ScrewHead();
  std::vector<PedicleScrew> screws;
  for (const double diameter_mm : rising_numbers(object, "diameters_mm", path)) {
    for (const double length_mm : rising_numbers(object, "lengths_mm", path)) {
      screws.push_back(
          {joined(diameter_mm, " x ", length_mm, " mm"), diameter_mm, length_mm, object.number("tip_length_mm"), head});
      try {
        check_screw(screws.back());
      } catch (const Error& error) {
        fail(path.string(), ": ", error.what());
      }
    }
  }
  return screws;
}

}  // namespace spinaltap
