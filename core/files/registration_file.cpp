#include "core/files/registration_file.h"

#include <array>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/registration_json.h"
#include "core/files/detail/tool_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kRegistrationFormat{"spinaltap-registration", "registration", "register again"};
/// One that names its bone: a program that does not compare it would guide any other by it.
constexpr int kRegistrationVersion = 3;
constexpr FileFormat kPivotFormat{"spinaltap-pivot", "pivot calibration", "calibrate again"};

Json rows_of(const Mat3& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < 3; ++row) rows.push_back(to_json(Vec3(matrix.row(row))));
  return rows;
}

Mat3 matrix_in(const JsonObject& object, const char* key, const std::filesystem::path& file) {
  const Json& rows = object.at(key);
  const auto reject = [&] { fail("expected 3 rows of 3 numbers for \"", key, "\" in ", file.string()); };
  if (!rows.is_array() || rows.size() != 3) reject();
  Mat3 matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    if (!rows[row].is_array() || rows[row].size() != 3) reject();
    for (std::size_t column = 0; column < 3; ++column) {
      if (!rows[row][column].is_number()) reject();
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = rows[row][column].get<double>();
    }
  }
  return matrix;
}

}  // namespace

Json to_json(const PoseCovariance& covariance) {
  return {{"centre_mm", to_json(covariance.centre_mm)},
          {"turn_rad2", rows_of(covariance.turn_rad2)},
          {"turn_shift_rad_mm", rows_of(covariance.turn_shift)},
          {"shift_mm2", rows_of(covariance.shift_mm2)}};
}

void write_registration(const Registration& registration, const std::filesystem::path& path) {
  Json json = format_head(kRegistrationFormat);
  json["kind"] = name_of(registration.kind);
  json["frame"] = "LPS";
  json["unit"] = "mm";
  json["ct_from_patient"] = {{"rotation", rows_of(registration.ct_from_patient.rotation)},
                             {"translation_mm", to_json(registration.ct_from_patient.translation_mm)}};
  json["covariance"] = to_json(registration.covariance);
  json["noise_mm"] = registration.noise_mm;
  json["noise_was_told"] = registration.noise_was_told;
  json["residual_rms_mm"] = registration.residual_rms_mm;
  json["residuals_mm"] = registration.residuals_mm;
  json["rejected"] = registration.rejected;
  json["warnings"] = registration.warnings;
  if (!registration.bone.is_empty()) {
    json["version"] = kRegistrationVersion;
    json["bone"] = to_json(registration.bone);
  }
  write_json(json, path);
}

Registration read_registration(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kRegistrationFormat, path, {kFormatVersion, kRegistrationVersion});
  check_keys(json,
             {"format", "version", "kind", "frame", "unit", "ct_from_patient", "covariance", "noise_mm",
              "noise_was_told", "residual_rms_mm", "residuals_mm", "rejected", "warnings", "bone"},
             path, "a key of a registration");
  const JsonObject object(json, path);
  if (object.text("frame") != "LPS" || object.text("unit") != "mm") {
    fail("expected a registration in the frame LPS and the unit mm in ", path.string());
  }
  Registration found;
  const std::string kind = object.text("kind");
  if (kind != "fiducials" && kind != "surface") {
    fail("expected \"fiducials\" or \"surface\" for \"kind\" in ", path.string(), ", found ", in_quotes(kind));
  }
  found.kind = kind == "surface" ? Registration::Kind::surface : Registration::Kind::fiducials;
  const JsonObject pose(object.at("ct_from_patient"), path);
  found.ct_from_patient = checked_pose({matrix_in(pose, "rotation", path), pose.vector("translation_mm")},
                                       path.string() + ": \"ct_from_patient\"");
  const JsonObject covariance(object.at("covariance"), path);
  found.covariance = {covariance.vector("centre_mm"), matrix_in(covariance, "turn_rad2", path),
                      matrix_in(covariance, "turn_shift_rad_mm", path), matrix_in(covariance, "shift_mm2", path)};
  try {
    check_covariance(found.covariance);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  found.noise_mm = object.number("noise_mm");
  found.residual_rms_mm = object.number("residual_rms_mm");
  if (!(found.noise_mm >= 0.0) || !(found.residual_rms_mm >= 0.0)) {
    fail("expected numbers of 0 or more for \"noise_mm\" and \"residual_rms_mm\" in ", path.string());
  }
  found.noise_was_told = object.flag("noise_was_told");
  try {
    found.residuals_mm = object.at("residuals_mm").get<std::vector<double>>();
    found.rejected = object.at("rejected").get<std::vector<std::size_t>>();
    found.warnings = object.at("warnings").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    fail(
        "expected lists of numbers for \"residuals_mm\" and \"rejected\" and "
        "one of texts for \"warnings\" in ",
        path.string());
  }
  if (object.has("bone")) found.bone = read_bone_identity(object.at("bone"), path);
  return found;
}

void write_pivot(const PivotCalibration& pivot, const std::filesystem::path& path) {
  Json json = format_head(kPivotFormat);
  json["tip_mm"] = to_json(pivot.tip_mm);
  json["pivot_mm"] = to_json(pivot.pivot_mm);
  json["tip_covariance_mm2"] = rows_of(pivot.tip_covariance_mm2);
  json["residual_rms_mm"] = pivot.residual_rms_mm;
  json["residuals_mm"] = pivot.residuals_mm;
  json["cone_deg"] = pivot.cone_deg;
  json["condition"] = pivot.condition;
  json["warnings"] = pivot.warnings;
  write_json(json, path);
}

}  // namespace spinaltap
