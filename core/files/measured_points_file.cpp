#include "core/files/measured_points_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/text_fields.h"
#include "core/files/detail/markups_file.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;
constexpr double kFurthestMm = 1e5;

std::vector<std::string> fields_of(std::string_view line) {
  constexpr std::size_t kMostFields = 100;
  std::vector<std::string> fields;
  CsvFields rest(line);
  for (std::string_view field; fields.size() < kMostFields && rest.next(field);) fields.emplace_back(trimmed(field));
  return fields;
}

std::string without_quotes(std::string text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

double number_in(const std::vector<std::string>& fields, std::size_t n, const FileReader& file, std::size_t line) {
  const std::optional<double> number = n < fields.size() ? parse_number(fields[n]) : std::nullopt;
  if (!number || !(std::abs(*number) <= kFurthestMm)) {
    fail("expected a number within ", kFurthestMm, " as field ", n + 1, " of line ", line, " of ", file.name(),
         ", found ", n < fields.size() ? in_quotes(fields[n]) : std::string("none"));
  }
  return *number;
}

Vec3 to_lps(const Vec3& p, MeasuredFrame frame) {
  return frame == MeasuredFrame::ras ? Vec3(-p.x(), -p.y(), p.z()) : p;
}

/// Where a point's parts stand on a line.
struct PointColumns {
  std::array<std::size_t, 3> xyz{0, 1, 2};
  std::optional<std::size_t> label;
};

PointColumns columns_of(const std::vector<std::string>& header, const FileReader& file) {
  PointColumns columns;
  columns.xyz.fill(header.size());
  for (std::size_t n = 0; n < header.size(); ++n) {
    const std::string name = csv_column_name(header[n]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string letter(1, "xyz"[axis]);
      if (name == letter || name == letter + "_mm") columns.xyz[axis] = n;
    }
    if (name == "label" || name == "name") columns.label = n;
  }
  for (const std::size_t column : columns.xyz) {
    if (column == header.size()) fail("expected columns x_mm, y_mm and z_mm in ", file.name());
  }
  return columns;
}

/// "# CoordinateSystem = LPS", or RAS, or the numbers 1 and 0 of older versions; "# columns = id,x,y,z,...".
void read_fcsv_comment(std::string_view line, const FileReader& file, MeasuredFrame& frame, PointColumns& columns) {
  const std::size_t at = line.find('=');
  if (at == std::string_view::npos) return;
  const std::string key = lower_case(trimmed(line.substr(1, at - 1)));
  const std::string value(trimmed(line.substr(at + 1)));
  if (key == "coordinatesystem") {
    if (value != "LPS" && value != "RAS" && value != "0" && value != "1") {
      fail("expected CoordinateSystem to be LPS or RAS in ", file.name(), ", found ", in_quotes(value));
    }
    frame = value == "LPS" || value == "1" ? MeasuredFrame::lps : MeasuredFrame::ras;
  } else if (key == "columns") {
    columns = columns_of(fields_of(value), file);
  }
}

std::vector<MeasuredPoint> read_lines(const std::filesystem::path& path, MeasuredFrame frame, bool is_fcsv) {
  FileReader file(path);
  PointColumns columns;
  if (is_fcsv) {
    frame = MeasuredFrame::ras;  // of files before Slicer 4.11 that do not say
    columns.xyz = {1, 2, 3};
    columns.label = 11;
  }
  std::vector<MeasuredPoint> points;
  std::size_t number = 0;
  for (std::string_view text; file.line(text);) {
    ++number;
    const std::string_view line = trimmed(number == 1 ? without_byte_order_mark(text) : text);
    if (line.empty()) continue;
    if (line.front() == '#') {
      if (is_fcsv) read_fcsv_comment(line, file, frame, columns);
      continue;
    }
    const std::vector<std::string> fields = fields_of(line);
    if (!is_fcsv && points.empty() && std::none_of(fields.begin(), fields.end(), [](const std::string& field) {
          return parse_number(field).has_value();
        })) {
      columns = columns_of(fields, file);
      continue;
    }
    MeasuredPoint point;
    Vec3 p = Vec3::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[static_cast<Eigen::Index>(axis)] = number_in(fields, columns.xyz[axis], file, number);
    }
    point.p_mm = to_lps(p, frame);
    if (columns.label && *columns.label < fields.size()) point.label = without_quotes(fields[*columns.label]);
    points.push_back(point);
    if (points.size() > kMostPoints) fail("expected up to ", kMostPoints, " points in ", file.name(), ", found more");
  }
  return points;
}

std::vector<MeasuredPoint> points_of_markups(const Json& json, const std::filesystem::path& file) {
  if (!is_markups(json)) fail("expected 3D Slicer's markups in ", file.string());
  const Json& markups = json.at("markups");
  if (!markups.is_array()) fail("expected \"markups\" to be a list in ", file.string());
  std::vector<MeasuredPoint> points;
  for (const Json& item : markups) {
    const JsonObject markup(item, file);
    const Vec3 scale = detail::scale_to_lps_mm(markup, file);
    const Json& controls = markup.at("controlPoints");
    if (!controls.is_array()) fail("expected \"controlPoints\" to be a list in ", file.string());
    for (const Json& control : controls) {
      const JsonObject object(control, file);
      if (object.has("positionStatus") && object.text("positionStatus") != "defined") continue;
      MeasuredPoint point;
      point.p_mm = object.vector("position").cwiseProduct(scale);
      if (!(point.p_mm.cwiseAbs().maxCoeff() <= kFurthestMm)) {
        fail("expected positions within ", kFurthestMm, " mm in ", file.string());
      }
      if (object.has("label") && object.at("label").is_string()) point.label = object.text("label");
      points.push_back(point);
      if (points.size() > kMostPoints) fail("expected up to ", kMostPoints, " points in ", file.string());
    }
  }
  return points;
}

/// Whether each has a label that no other has.
bool are_labelled(const std::vector<MeasuredPoint>& points) {
  std::map<std::string, int> met;
  return std::all_of(points.begin(), points.end(),
                     [&](const MeasuredPoint& point) { return !point.label.empty() && ++met[point.label] == 1; });
}

}  // namespace

std::vector<MeasuredPoint> read_measured_points(const std::filesystem::path& file, MeasuredFrame frame) {
  const std::string extension = lower_case(file.extension().string());
  std::vector<MeasuredPoint> points =
      extension == ".json" ? points_of_markups(read_json(file), file) : read_lines(file, frame, extension == ".fcsv");
  if (points.empty()) fail("expected one point or more in ", file.string(), ", found none");
  return points;
}

std::vector<RigidPose> read_tool_poses(const std::filesystem::path& path) {
  FileReader file(path);
  std::vector<RigidPose> poses;
  std::size_t number = 0;
  for (std::string_view text; file.line(text);) {
    ++number;
    const std::string_view line = trimmed(number == 1 ? without_byte_order_mark(text) : text);
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string> fields = fields_of(line);
    if (poses.empty() && std::none_of(fields.begin(), fields.end(),
                                      [](const std::string& field) { return parse_number(field).has_value(); })) {
      continue;
    }
    std::vector<double> values;
    for (std::size_t n = 0; n < fields.size(); ++n) values.push_back(number_in(fields, n, file, number));
    const std::string what = "line " + std::to_string(number) + " of " + file.name();
    constexpr std::size_t kQuaternion = 7, kThreeRows = 12, kFourRows = 16;
    if (values.size() == kQuaternion) {
      const double length =
          std::sqrt(values[3] * values[3] + values[4] * values[4] + values[5] * values[5] + values[6] * values[6]);
      if (!(std::abs(length - 1.0) < 0.01)) fail(what, ": expected a quaternion of length 1, found ", length);
      poses.push_back(
          pose_of_quaternion({values[3], values[4], values[5], values[6]}, Vec3(values[0], values[1], values[2])));
    } else if (values.size() == kThreeRows || values.size() == kFourRows) {
      RigidPose pose;
      for (std::size_t row = 0; row < 3; ++row) {
        const auto at = static_cast<Eigen::Index>(row);
        pose.rotation.row(at) << values[4 * row], values[4 * row + 1], values[4 * row + 2];
        pose.translation_mm[at] = values[4 * row + 3];
      }
      poses.push_back(checked_pose(pose, what));
    } else {
      fail(what, ": expected 7 numbers (x, y, z, qw, qx, qy, qz), or 12 or 16 of a matrix, found ", values.size());
    }
    if (poses.size() > kMostPoints) fail("expected up to ", kMostPoints, " poses in ", file.name(), ", found more");
  }
  if (poses.empty()) fail("expected one pose or more in ", path.string(), ", found none");
  return poses;
}

PairedPoints pair_points(const std::vector<MeasuredPoint>& first, const std::vector<MeasuredPoint>& second) {
  if (first.size() != second.size()) {
    fail("pairs of points: expected as many in both lists, found ", first.size(), " and ", second.size());
  }
  PairedPoints pairs;
  const bool by_label = are_labelled(first) && are_labelled(second);
  for (std::size_t n = 0; n < first.size(); ++n) {
    std::size_t partner = n;
    if (by_label) {
      const auto found = std::find_if(second.begin(), second.end(),
                                      [&](const MeasuredPoint& point) { return point.label == first[n].label; });
      if (found == second.end()) fail("pairs of points: ", in_quotes(first[n].label), " is in one list only");
      partner = static_cast<std::size_t>(found - second.begin());
    }
    pairs.first_mm.push_back(first[n].p_mm);
    pairs.second_mm.push_back(second[partner].p_mm);
  }
  return pairs;
}

}  // namespace spinaltap
