#pragma once

#include <map>
#include <string>

#include "core/surface/surface_samples.h"

namespace spinaltap {

/// Ways to surface points by the names that they have in options and reports.
const std::map<std::string, PointMethod>& point_methods();

/// "pixels", "normals" or "contours".
const std::string& name_of(PointMethod method);

}  // namespace spinaltap
