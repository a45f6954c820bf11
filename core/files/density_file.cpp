#include "core/files/density_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/error.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr const char* kCalibration = "calibration";

std::vector<CalibrationPair> pairs_of(const Json& list, const std::filesystem::path& path) {
  const auto finite = [](const Json& item) { return item.is_number() && std::isfinite(item.get<double>()); };
  std::vector<CalibrationPair> pairs;
  if (!list.is_array()) fail("expected a list for \"", kCalibration, "\" in ", path.string());
  for (const Json& pair : list) {
    if (!pair.is_array() || pair.size() != 2 || !finite(pair[0]) || !finite(pair[1])) {
      fail("expected pairs [HU, g/cm3] for \"", kCalibration, "\" in ", path.string(), ", found ",
           pair.dump().substr(0, 60));
    }
    pairs.push_back({pair[0].get<double>(), pair[1].get<double>()});
  }
  return pairs;
}

}  // namespace

DensityCalibration read_density_law(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonObject object(json, path);
  const bool calibrated = object.has(kCalibration);
  if (calibrated && (object.has(kAtZero) || object.has(kPerHu))) {
    fail("expected either a line or \"", kCalibration, "\" in ", path.string(), ", found both");
  }
  try {
    if (calibrated) return calibrate_density(pairs_of(object.at(kCalibration), path));
    const DensityLaw law{object.number(kAtZero), object.number(kPerHu)};
    check_density_law(law);
    return {law, 0.0, 0.0};
  } catch (const Error& error) {
    const std::string message = error.what();
    // Some complaints name the file already.
    if (message.find(path.string()) != std::string::npos) throw;
    fail(path.string(), ": ", message);
  }
}

}  // namespace spinaltap
