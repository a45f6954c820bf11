#include "core/files/screw_file.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/files/detail/tool_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kScrewsFormat{"spinaltap-screws", "table of screws", "see docs/data-files.md"};

std::vector<double> numbers_of(const JsonObject& object, const char* key, const std::filesystem::path& path) {
  const Json& list = object.at(key);
  std::vector<double> numbers;
  for (const Json& item : list.is_array() ? list : Json::array()) {
    if (item.is_number()) numbers.push_back(item.get<double>());
  }
  if (numbers.empty() || numbers.size() != list.size()) {
    fail("expected one number or more for \"", key, "\" in ", path.string(), ", found ", shown_value(list));
  }
  return numbers;
}

/// The cores and pitches of a table, one of each diameter; tables without them leave the screws the usual thread.
std::map<double, ScrewThread> threads_of(const JsonObject& object, const std::vector<double>& diameters_mm,
                                         const std::filesystem::path& path) {
  std::map<double, ScrewThread> threads;
  if (!object.has("core_diameters_mm") && !object.has("pitches_mm")) return threads;
  const std::vector<double> cores_mm = numbers_of(object, "core_diameters_mm", path);
  const std::vector<double> pitches_mm = numbers_of(object, "pitches_mm", path);
  for (const auto& [key, found] : {std::pair{"core_diameters_mm", &cores_mm}, std::pair{"pitches_mm", &pitches_mm}}) {
    if (found->size() == diameters_mm.size()) continue;
    fail("expected one number for each of the ", diameters_mm.size(), " diameters as \"", key, "\" in ", path.string(),
         ", found ", found->size());
  }
  for (std::size_t n = 0; n < diameters_mm.size(); ++n) {
    ScrewThread& thread = threads[diameters_mm[n]];
    thread.core_diameter_mm = cores_mm[n];
    thread.pitch_mm = pitches_mm[n];
  }
  return threads;
}

}  // namespace

std::vector<PedicleScrew> read_screws(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kScrewsFormat, path);
  const JsonObject object(json, path);
  const ScrewHead head = object.has("head") ? read_screw_head(object.at("head"), path) : ScrewHead();
  std::vector<double> diameters_mm = numbers_of(object, "diameters_mm", path);
  const std::map<double, ScrewThread> threads = threads_of(object, diameters_mm, path);
  std::vector<double> lengths_mm = numbers_of(object, "lengths_mm", path);
  std::sort(diameters_mm.begin(), diameters_mm.end());
  std::sort(lengths_mm.begin(), lengths_mm.end());
  std::vector<PedicleScrew> screws;
  for (const double diameter_mm : diameters_mm) {
    for (const double length_mm : lengths_mm) {
      screws.push_back(
          {joined(diameter_mm, " x ", length_mm, " mm"), diameter_mm, length_mm, object.number("tip_length_mm"), head});
      if (const auto thread = threads.find(diameter_mm); thread != threads.end()) screws.back().thread = thread->second;
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
