#pragma once

#include <string>

#include "apps/report/svg_plot.h"
#include "core/files/json_file.h"
#include "core/files/measurements_file.h"
#include "core/validation/force_validation.h"

namespace spinaltap {

/// Every law against every figure: a table each, then what is left out and why, and how well they do. For a terminal.
std::string validation_text(const Measurements& measurements, const ForceValidation& validation);
/// The same as a table for programs, a line a law and figure.
std::string validation_csv(const Measurements& measurements, const ForceValidation& validation);
Json validation_json(const Measurements& measurements, const ForceValidation& validation);

/// Measured against predicted with its band, a figure beside the other in the order of the table: a law's thrust and
/// torque, N and N·mm, on a log axis.
Plot validation_plot(const LawValidation& law);

}  // namespace spinaltap
