#include "core/files/material_file.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/material_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kDensityFormat{"spinaltap-density-calibration", "density calibration", "see docs/data-files.md"};
constexpr FileFormat kCuttingModelFormat{"spinaltap-cutting-model", "cutting model", "see docs/data-files.md"};

constexpr const char* kCalibration = "calibration";

std::vector<CalibrationPair> pairs_of(const Json& list, const std::filesystem::path& path) {
  const auto finite = [](const Json& item) { return item.is_number() && std::isfinite(item.get<double>()); };
  std::vector<CalibrationPair> pairs;
  if (!list.is_array()) fail("expected a list for \"", kCalibration, "\" in ", path.string());
  for (const Json& pair : list) {
    if (!pair.is_array() || pair.size() != 2 || !finite(pair[0]) || !finite(pair[1])) {
      fail("expected pairs [HU, g/cm3] for \"", kCalibration, "\" in ", path.string(), ", found ", shown_value(pair));
    }
    pairs.push_back({pair[0].get<double>(), pair[1].get<double>()});
  }
  return pairs;
}

constexpr std::array kNumbers{std::pair{"specific_cutting_energy_mpa", &Material::specific_cutting_energy_mpa},
                              std::pair{"cutting_exponent", &Material::cutting_exponent},
                              std::pair{"reference_feed_mm", &Material::reference_feed_mm},
                              std::pair{"feed_exponent", &Material::feed_exponent},
                              std::pair{"lip_thrust_share", &Material::lip_thrust_share},
                              std::pair{"chisel_mpa", &Material::chisel_mpa},
                              std::pair{"chisel_exponent", &Material::chisel_exponent},
                              std::pair{"chisel_share", &Material::chisel_share},
                              std::pair{"contact_n_mm", &Material::contact_n_mm},
                              std::pair{"contact_exponent", &Material::contact_exponent}};
constexpr std::array kLipNumbers{std::pair{"friction_deg", &LipMechanics::friction_deg},
                                 std::pair{"speed_exponent", &LipMechanics::speed_exponent},
                                 std::pair{"reference_rpm", &LipMechanics::reference_rpm},
                                 std::pair{"margin_pressure_share", &LipMechanics::margin_pressure_share},
                                 std::pair{"chip_torque_per_diameter", &LipMechanics::chip_torque_per_diameter}};
static_assert(sizeof(LipMechanics) == kLipNumbers.size() * sizeof(double), "a number of the lips has no key");
constexpr std::array kSpreadNumbers{std::pair{"median", &ForceSpread::median},
                                    std::pair{"log_scale", &ForceSpread::log_scale},
                                    std::pair{"degrees_of_freedom", &ForceSpread::degrees}};
static_assert(sizeof(ForceSpread) == kSpreadNumbers.size() * sizeof(double), "a number of a spread has no key");
constexpr std::array kSpreads{std::pair{"thrust_spread", &Material::thrust_spread},
                              std::pair{"torque_spread", &Material::torque_spread}};
static_assert(sizeof(Material) == sizeof(HuToDensity) + kNumbers.size() * sizeof(double) + sizeof(double) +
                                      sizeof(LipMechanics) + kSpreads.size() * sizeof(ForceSpread),
              "a number has no key");

constexpr const char* kLaw = "law";
constexpr const char* kLips = "lips";

const std::map<std::string, CuttingLaw>& cutting_laws() {
  static const std::map<std::string, CuttingLaw> laws{{"power", CuttingLaw::power},
                                                      {"mechanistic", CuttingLaw::mechanistic}};
  return laws;
}

template <class Part, class Numbers>
Part numbers_of(const Json& json, const Numbers& numbers, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  Part part;
  for (const auto& [key, member] : numbers) part.*member = object.number(key);
  return part;
}

/// What files of before did not have: then it is the power law, without a band.
void read_law(const JsonObject& object, const std::filesystem::path& file, Material& material) {
  if (object.has(kLaw)) {
    const std::string name = object.text(kLaw);
    const auto law = cutting_laws().find(name);
    if (law == cutting_laws().end()) {
      fail("expected power or mechanistic for \"", kLaw, "\" in ", file.string(), ", found ", in_quotes(name));
    }
    material.law = law->second;
  }
  if (object.has(kLips)) {
    material.lips = numbers_of<LipMechanics>(object.at(kLips), kLipNumbers, file);
  } else if (material.law == CuttingLaw::mechanistic) {
    fail("expected \"", kLips, "\" of a mechanistic law in ", file.string(), ", found none");
  }
  for (const auto& [key, member] : kSpreads) {
    material.*member = object.has(key) ? read_force_spread(object.at(key), file) : ForceSpread{};
  }
}

}  // namespace

DensityCalibration read_density_calibration(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kDensityFormat, path);
  const JsonObject object(json, path);
  const bool calibrated = object.has(kCalibration);
  if (calibrated && (object.has(kAtZero) || object.has(kPerHu))) {
    fail("expected either a line or \"", kCalibration, "\" in ", path.string(), ", found both");
  }
  try {
    if (calibrated) return calibrate_density(pairs_of(object.at(kCalibration), path));
    const HuToDensity line{object.number(kAtZero), object.number(kPerHu)};
    check_hu_to_density(line);
    return {line, 0.0, 0.0};
  } catch (const Error& error) {
    const std::string message = error.what();
    // Some complaints name the file already.
    if (message.find(path.string()) != std::string::npos) throw;
    fail(path.string(), ": ", message);
  }
}

Json to_json(const ForceSpread& spread) {
  Json json;
  for (const auto& [key, member] : kSpreadNumbers) json[key] = spread.*member;
  return json;
}

ForceSpread read_force_spread(const Json& json, const std::filesystem::path& file) {
  return numbers_of<ForceSpread>(json, kSpreadNumbers, file);
}

Json to_json(const Material& material) {
  Json json{{kAtZero, material.density.at_0_hu}, {kPerHu, material.density.per_hu}};
  for (const auto& [key, member] : kNumbers) json[key] = material.*member;
  for (const auto& [name, law] : cutting_laws()) {
    if (law == material.law) json[kLaw] = name;
  }
  for (const auto& [key, member] : kLipNumbers) json[kLips][key] = material.lips.*member;
  for (const auto& [key, member] : kSpreads) json[key] = to_json(material.*member);
  return json;
}

Material material_of(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  Material material;
  material.density = {object.number(kAtZero), object.number(kPerHu)};
  for (const auto& [key, member] : kNumbers) material.*member = object.number(key);
  read_law(object, file, material);
  return material;
}

Material read_material(const std::filesystem::path& path, const HuToDensity& density) {
  const Json json = read_json(path);
  check_format(json, kCuttingModelFormat, path);
  const JsonObject object(json, path);
  const auto reject = [&](const char* key, const char* why) {
    // Left unread, it would change nothing without a word.
    if (object.has(key)) fail("expected no \"", key, "\" in ", path.string(), ": ", why);
  };
  reject(kAtZero, "the density calibration has its own file");
  reject(kPerHu, "the density calibration has its own file");

  Material material;
  material.density = density;
  for (const auto& [key, member] : kNumbers) material.*member = object.number(key);
  read_law(object, path, material);
  try {
    check_material(material);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  return material;
}

}  // namespace spinaltap
