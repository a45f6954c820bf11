#include "core/files/placement_errors_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <tuple>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/geometry.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"
#include "core/files/detail/placement_errors_json.h"

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

using FiveNumbers = std::array<double, 5>;

FiveNumbers five_numbers(const Json& json, const char* what, const std::filesystem::path& path) {
  FiveNumbers numbers{};
  bool is_sound = json.is_array() && json.size() == numbers.size();
  for (std::size_t n = 0; is_sound && n < numbers.size(); ++n) {
    is_sound = json[n].is_number();
    if (is_sound) numbers[n] = json[n].get<double>();
  }
  if (!is_sound) fail("expected five numbers for ", what, " in ", path.string(), ", found ", shown_value(json));
  return numbers;
}

/// Where the tip's error is told in place of the direction's: the turn that makes it, of a screw so long.
PlacementError by_tip(const PlacementError& entry, double tip_medial_mm, double tip_cranial_mm, double length_mm) {
  PlacementError error = entry;
  const double medial_mm = tip_medial_mm - entry.medial_mm, cranial_mm = tip_cranial_mm - entry.cranial_mm;
  const double across_mm = std::hypot(medial_mm, cranial_mm);
  const double turn_deg = across_mm > 0.0 ? std::asin(std::min(1.0, across_mm / length_mm)) / kDegree / across_mm : 0.0;
  error.medial_deg = turn_deg * medial_mm;
  error.cranial_deg = turn_deg * cranial_mm;
  return error;
}

/// {"of": ["entry_medial_mm", ...], "mean": 5, "covariance": 5 x 5, "most_deviations", "outliers"}
JointErrors joint_of(const Json& json, const JsonObject& model, const std::filesystem::path& path) {
  check_keys(json, {"mean", "covariance", "ends_at", "most_deviations", "outliers"}, path,
             "a figure of a joint law of errors");
  const JsonObject object(json, path);
  JointErrors joint;
  joint.mean = five_numbers(object.at("mean"), "\"mean\"", path);
  const Json& covariance = object.at("covariance");
  if (!covariance.is_array() || covariance.size() != joint.covariance.size()) {
    fail("expected five rows for \"covariance\" in ", path.string(), ", found ", shown_value(covariance));
  }
  for (std::size_t n = 0; n < joint.covariance.size(); ++n) {
    joint.covariance[n] = five_numbers(covariance[n], "a row of \"covariance\"", path);
  }
  const std::string end = object.has("ends_at") ? object.text("ends_at") : "direction_deg";
  if (end != "direction_deg" && end != "tip_mm") {
    fail("expected \"direction_deg\" or \"tip_mm\" for \"ends_at\" in ", path.string(), ", found ", in_quotes(end));
  }
  if (end == "tip_mm") {
    // The direction is what the tip errs by more than the entry, over the screw's length: a linear map of both.
    const double length_mm = model.number("screw_length_mm");
    if (!(length_mm > 0.0)) fail("expected a \"screw_length_mm\" above 0 in ", path.string(), ", found ", length_mm);
    std::array<FiveNumbers, 5> map{};
    for (std::size_t n = 0; n < 3; ++n) map[n][n] = 1.0;
    for (std::size_t n = 0; n < 2; ++n) {
      map[n + 3][n] = -1.0 / (length_mm * kDegree);
      map[n + 3][n + 3] = 1.0 / (length_mm * kDegree);
    }
    JointErrors mapped = joint;
    for (std::size_t i = 0; i < 5; ++i) {
      mapped.mean[i] = 0.0;
      for (std::size_t k = 0; k < 5; ++k) mapped.mean[i] += map[i][k] * joint.mean[k];
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 5; ++k) {
          for (std::size_t l = 0; l < 5; ++l) sum += map[i][k] * joint.covariance[k][l] * map[j][l];
        }
        mapped.covariance[i][j] = mapped.covariance[j][i] = sum;
      }
    }
    joint = mapped;
  }
  joint.most_deviations = object.number_or("most_deviations", joint.most_deviations);
  if (object.has("outliers")) {
    check_keys(object.at("outliers"), {"share", "times"}, path, "a share and how many times");
    const JsonObject outliers(object.at("outliers"), path);
    joint.outlier_share = outliers.number("share");
    joint.outlier_times = outliers.number("times");
  }
  return joint;
}

/// A list of five numbers each; or {"table": a CSV file beside this one}.
std::vector<PlacementError> measured_of(const Json& json, const std::filesystem::path& path) {
  if (json.is_object()) {
    check_keys(json, {"table"}, path, "\"table\"");
    return read_measured_errors(path.parent_path() / JsonObject(json, path).text("table"));
  }
  if (!json.is_array() || json.empty()) {
    fail("expected measured errors, or a \"table\" of them, for \"measured\" in ", path.string(), ", found ",
         shown_value(json));
  }
  std::vector<PlacementError> measured;
  for (const Json& row : json) {
    const FiveNumbers numbers = five_numbers(row, "a row of \"measured\"", path);
    measured.push_back({numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]});
  }
  return measured;
}

PlacementErrors errors_in(const Json& json, const std::filesystem::path& path) {
  check_keys(json,
             {"format", "version", "name", "title", "sources", "entry", "direction", "along_mm", "tip",
              "screw_length_mm", "correlation", "joint", "measured"},
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
  if (object.has("joint") || object.has("measured")) {
    for (const char* other : {"entry", "direction", "along_mm", "tip", "correlation"}) {
      if (object.has(other))
        fail("expected no ", in_quotes(other), " beside a joint law or a table in ", path.string());
    }
    if (object.has("joint") == object.has("measured")) {
      fail("expected either \"joint\" or \"measured\" in ", path.string(), ", found both");
    }
    if (object.has("joint")) errors.joint = joint_of(object.at("joint"), object, path);
    if (object.has("measured")) errors.measured = measured_of(object.at("measured"), path);
    check_errors(errors);
    return errors;
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
  return placement_errors_in(json, path);
}

PlacementErrors placement_errors_in(const Json& json, const std::filesystem::path& path) {
  try {
    return errors_in(json, path);
  } catch (const Error& error) {
    const std::string message = error.what();
    // Some complaints name the file already.
    if (message.find(path.string()) != std::string::npos) throw;
    fail(path.string(), ": ", message);
  }
}

Json to_json(const PlacementErrors& errors) {
  Json json{{"name", errors.name}, {"title", errors.title}, {"sources", errors.sources}};
  if (!errors.measured.empty()) {
    Json rows = Json::array();
    for (const PlacementError& one : errors.measured) {
      rows.push_back({one.medial_mm, one.cranial_mm, one.along_mm, one.medial_deg, one.cranial_deg});
    }
    json["measured"] = std::move(rows);
    return json;
  }
  if (errors.joint) {
    json["joint"] = {{"mean", errors.joint->mean}, {"covariance", errors.joint->covariance}};
    if (std::isfinite(errors.joint->most_deviations)) {
      json["joint"]["most_deviations"] = errors.joint->most_deviations;
    }
    if (errors.joint->outlier_share > 0.0) {
      json["joint"]["outliers"] = {{"share", errors.joint->outlier_share}, {"times", errors.joint->outlier_times}};
    }
    return json;
  }
  const auto cross = [](const CrossErrors& of, const CrossKeys& keys) {
    return Json{{keys.medial, {{"mean", of.medial_bias}, {"sd", of.medial}}},
                {keys.cranial, {{"mean", of.cranial_bias}, {"sd", of.cranial}}},
                {"shape", of.shape}};
  };
  json["entry"] = cross(errors.entry_mm, kEntryKeys);
  json["direction"] = cross(errors.direction_deg, kDirectionKeys);
  json["along_mm"] = {{"mean", errors.along_bias_mm}, {"sd", errors.along_mm}};
  json["correlation"] = errors.correlation;
  return json;
}

std::vector<PlacementError> read_measured_errors(const std::filesystem::path& path) {
  constexpr std::size_t kMostRows = 1'000'000;
  FileReader file(path);
  TextLines lines(file);
  std::string_view line;
  if (!lines.next_filled(line)) fail("expected a line of column names, found nothing in ", path.string());
  constexpr std::array<std::string_view, 8> kNames{"entry_medial_mm",      "entry_cranial_mm",      "along_mm",
                                                   "direction_medial_deg", "direction_cranial_deg", "tip_medial_mm",
                                                   "tip_cranial_mm",       "screw_length_mm"};
  constexpr std::size_t kNone = kNames.size();
  std::vector<std::size_t> columns;  // of each field: which of the names
  CsvFields header(without_byte_order_mark(line));
  for (std::string_view field; header.next(field);) {
    const std::string name = csv_column_name(field);
    columns.push_back(static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin()));
    if (columns.back() != kNone && std::count(columns.begin(), columns.end(), columns.back()) > 1) {
      fail("expected one column ", in_quotes(name), ", found two in ", lines.place());
    }
  }
  const auto has = [&columns](std::size_t name) {
    return std::find(columns.begin(), columns.end(), name) != columns.end();
  };
  const bool has_tip = has(5) && has(6) && has(7);
  if (!has(0) || !has(1) || has_tip == (has(3) && has(4))) {
    fail(
        "expected the columns entry_medial_mm, entry_cranial_mm, and direction_medial_deg and direction_cranial_deg or "
        "tip_medial_mm, tip_cranial_mm and screw_length_mm, in ",
        lines.place());
  }
  std::vector<PlacementError> measured;
  while (lines.next_filled(line)) {
    std::array<double, kNames.size() + 1> cells{};
    CsvFields fields(line);
    std::size_t n = 0;
    for (std::string_view field; n < columns.size() && fields.next(field); ++n) {
      if (columns[n] == kNone) continue;
      const std::optional<double> number = parse_number(field);
      if (!number || !std::isfinite(*number)) {
        fail("expected a number for ", kNames[columns[n]], " in ", lines.place(), ", found ", in_quotes(field));
      }
      cells[columns[n]] = *number;
    }
    if (n < columns.size()) fail("expected ", columns.size(), " fields in ", lines.place(), ", found ", n);
    if (measured.size() == kMostRows)
      fail("expected at most ", kMostRows, " errors in ", path.string(), ", found more");
    PlacementError error{cells[0], cells[1], cells[2], cells[3], cells[4]};
    if (has_tip) {
      if (!(cells[7] > 0.0)) fail("expected a screw_length_mm above 0 in ", lines.place(), ", found ", cells[7]);
      error = by_tip(error, cells[5], cells[6], cells[7]);
    }
    measured.push_back(error);
  }
  if (measured.empty()) fail("expected measured errors in ", path.string(), ", found none");
  return measured;
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
