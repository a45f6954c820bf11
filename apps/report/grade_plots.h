#pragma once

#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/report/svg_plot.h"

namespace spinaltap {

/// "B: breach below 2 mm".
std::string meaning_of(Grade grade);

/// Along the depth of a graded path: clearances to both walls, the mean CT number, the shares of bone in bands of CT
/// numbers, and the predicted thrust.
Plot clearance_plot(const GradedPath& graded);
Plot hu_plot(const GradedPath& graded);
Plot bands_plot(const GradedPath& graded, const std::vector<double>& hu_bands);
Plot predicted_thrust_plot(const GradedPath& graded);

}  // namespace spinaltap
