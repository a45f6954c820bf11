#include "core/files/placement_errors_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <tuple>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kErrorsFormat{"spinaltap-placement-errors", "file of placement errors", "see docs/data-files.md"};

MeanAndDeviation length_of(const Json& json, const std::filesystem::path& path) {
  check_keys(json, {"mean", "sd"}, path, "a mean and a deviation");
  const JsonObject object(json, path);
  return {object.number("mean"), object.number("sd")};
}

MedianAndP95 sizes_of(const Json& json, const std::filesystem::path& path) {
  check_keys(json, {"median", "p95"}, path, "a median and a 95th percentile");
  const JsonObject object(json, path);
  return {object.number("median"), object.number("p95")};
}

/// The names of a kind of error's members.
struct CrossKeys {
  const char *what, *length, *medial, *cranial;
};
constexpr CrossKeys kEntryKeys{"a figure of the entry's error", "distance_mm", "medial_mm", "cranial_mm"};
constexpr CrossKeys kDirectionKeys{"a figure of the direction's error", "angle_deg", "medial_deg", "cranial_deg"};

/// A length's mean and deviation; sizes to the sides; or bias and deviation to each side, with a shape.
CrossErrors cross_errors_of(const Json& json, const CrossKeys& keys, const std::filesystem::path& path) {
  const JsonObject object(json, path);
  if (object.has(keys.length)) {
    check_keys(json, {keys.length}, path, keys.what);
    return errors_of_length(length_of(object.at(keys.length), path));
  }
  check_keys(json, {keys.medial, keys.cranial, "shape"}, path, keys.what);
  const Json& medial = object.at(keys.medial);
  const Json& cranial = object.at(keys.cranial);
  if (JsonObject(medial, path).has("median")) {
    check_keys(json, {keys.medial, keys.cranial}, path, keys.what);
    return errors_of_sides(sizes_of(medial, path), sizes_of(cranial, path));
  }
  CrossErrors errors;
  for (const auto& [side, bias, spread] : {std::tuple{&medial, &errors.medial_bias, &errors.medial},
                                           std::tuple{&cranial, &errors.cranial_bias, &errors.cranial}}) {
    check_keys(*side, {"mean", "sd"}, path, "a mean and a deviation");
    *bias = JsonObject(*side, path).number("mean");
    *spread = JsonObject(*side, path).number("sd");
  }
  errors.shape = object.number_or("shape", errors.shape);
  return errors;
}

PlacementErrors errors_in(const Json& json, const std::filesystem::path& path) {
  check_keys(json,
             {"format", "version", "name", "title", "sources", "entry", "direction", "along_mm", "tip",
              "screw_length_mm", "correlation"},
             path, "a part of a model of placement errors");
  const JsonObject object(json, path);
  PlacementErrors errors;
  errors.name = object.text("name");
  errors.title = object.has("title") ? object.text("title") : errors.name;
  const Json& sources = object.at("sources");
  if (!sources.is_array() || sources.empty()) fail("expected a list of texts for \"sources\" in ", path.string());
  for (const Json& source : sources) {
    if (!source.is_string()) fail("expected a text in \"sources\" of ", path.string(), ", found ", shown_value(source));
    errors.sources.push_back(source.get<std::string>());
  }
  errors.entry_mm = cross_errors_of(object.at("entry"), kEntryKeys, path);
  errors.direction_deg = cross_errors_of(object.at("direction"), kDirectionKeys, path);
  if (object.has("along_mm")) {
    const Json& along = object.at("along_mm");
    check_keys(along, {"mean", "sd"}, path, "a mean and a deviation");
    errors.along_bias_mm = JsonObject(along, path).number("mean");
    errors.along_mm = JsonObject(along, path).number("sd");
  }
  if (object.has("tip") == object.has("correlation") || object.has("tip") != object.has("screw_length_mm")) {
    fail("expected either \"correlation\" or \"tip\" with \"screw_length_mm\" in ", path.string());
  }
  if (object.has("tip")) {
    const JsonObject tip(object.at("tip"), path);
    check_keys(object.at("tip"), {"distance_mm"}, path, "a figure of the tip's error");
    errors.correlation = correlation_by_tip(errors.entry_mm, errors.direction_deg,
                                            length_of(tip.at("distance_mm"), path), object.number("screw_length_mm"));
  } else {
    errors.correlation = object.number("correlation");
  }
  check_errors(errors);
  return errors;
}

}  // namespace

PlacementErrors read_placement_errors(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kErrorsFormat, path);
  try {
    return errors_in(json, path);
  } catch (const Error& error) {
    const std::string message = error.what();
    // Some complaints name the file already.
    if (message.find(path.string()) != std::string::npos) throw;
    fail(path.string(), ": ", message);
  }
}

std::vector<std::string> placement_error_models() { return data_names("errors"); }

PlacementErrors placement_errors_of(const std::string& text) {
  const std::vector<std::string> models = placement_error_models();
  if (std::find(models.begin(), models.end(), text) != models.end()) {
    return read_placement_errors(data_file("errors/" + text + ".json"));
  }
  std::vector<double> numbers;
  std::istringstream fields(text);
  for (std::string field; std::getline(fields, field, ',');) {
    const std::optional<double> number = parse_number(field);
    if (!number) break;
    numbers.push_back(*number);
  }
  constexpr std::size_t kNumbers = 2;
  if (numbers.size() == kNumbers && text.back() != ',') return plain_errors(numbers[0], numbers[1]);
  std::string known;
  for (const std::string& model : models) known += (known.empty() ? "" : ", ") + model;
  fail("placement errors: expected MM,DEG or one of ", known, ", found ", in_quotes(text));
}

}  // namespace spinaltap
