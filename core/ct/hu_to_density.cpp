#include "core/ct/hu_to_density.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

double HuToDensity::density_g_cm3(double hu) const { return std::max(0.0, at_0_hu + per_hu * hu); }

void check_hu_to_density(const HuToDensity& line) {
  const auto expect = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("density calibration: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  expect(line.at_0_hu, -1.0, 2.0, "density_at_0_hu (g/cm3)");
  expect(line.per_hu, 1e-6, 0.1, "density_per_hu (g/cm3)");
}

DensityCalibration calibrate_density(std::span<const CalibrationPair> pairs) {
  double mean_hu = 0.0;
  double mean_density = 0.0;
  for (const CalibrationPair& pair : pairs) {
    if (!std::isfinite(pair.hu) || !(pair.density_g_cm3 >= 0.0 && std::isfinite(pair.density_g_cm3))) {
      fail("density calibration: expected HU and densities from 0 g/cm3 on, found ", pair.hu, " HU, ",
           pair.density_g_cm3, " g/cm3");
    }
    mean_hu += pair.hu / static_cast<double>(pairs.size());
    mean_density += pair.density_g_cm3 / static_cast<double>(pairs.size());
  }
  double spread = 0.0;
  double product = 0.0;
  double furthest_hu = 0.0;
  for (const CalibrationPair& pair : pairs) {
    spread += (pair.hu - mean_hu) * (pair.hu - mean_hu);
    product += (pair.hu - mean_hu) * (pair.density_g_cm3 - mean_density);
    furthest_hu = std::max(furthest_hu, std::abs(pair.hu - pairs[0].hu));
  }
  if (!(furthest_hu > 0.0)) {
    fail("density calibration: expected at least two pairs of different CT numbers, found ", pairs.size(),
         pairs.size() < 2 ? " pairs" : " pairs of one");
  }
  DensityCalibration calibration;
  calibration.line.per_hu = product / spread;
  calibration.line.at_0_hu = mean_density - calibration.line.per_hu * mean_hu;
  if (!(calibration.line.per_hu > 0.0)) {
    fail("density calibration: expected density to rise with the CT number, found ", calibration.line.per_hu,
         " g/cm3 per HU");
  }
  check_hu_to_density(calibration.line);
  double squares = 0.0;
  for (const CalibrationPair& pair : pairs) {
    const double residual = pair.density_g_cm3 - (calibration.line.at_0_hu + calibration.line.per_hu * pair.hu);
    squares += residual * residual;
    calibration.max_residual_g_cm3 = std::max(calibration.max_residual_g_cm3, std::abs(residual));
  }
  calibration.rms_residual_g_cm3 = std::sqrt(squares / static_cast<double>(pairs.size()));
  return calibration;
}

}  // namespace spinaltap
