#pragma once

#include <string>

#include "apps/report/grade_output.h"

namespace spinaltap {

/// An <svg> element, as wide as half a page of paper: what a screw breaches by where its entry errs, as a map with a
/// square for each error, coloured by grade; beside it how likely each grade is, with its interval.
std::string breach_map_svg(const PlacedGrade& placed);

}  // namespace spinaltap
