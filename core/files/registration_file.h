#pragma once

#include <filesystem>

#include "core/registration/calibrate_pivot.h"
#include "core/registration/registration.h"

namespace spinaltap {

/// Writes a registration as JSON, to a staged (temporary) name: pose, covariance, residuals and warnings, and nothing
/// of the patient. See docs/registration.md.
void write_registration(const Registration& registration, const std::filesystem::path& path);

/// Reads what write_registration wrote. Throws Error that names the file and the key at fault.
Registration read_registration(const std::filesystem::path& path);

/// Writes a pivot calibration as JSON, to a staged name.
void write_pivot(const PivotCalibration& pivot, const std::filesystem::path& path);

}  // namespace spinaltap
