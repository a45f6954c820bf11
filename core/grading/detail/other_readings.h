#pragma once

#include <string>
#include <vector>

#include "core/tool/drill_path.h"

namespace spinaltap {

/// How else the points of a path may have been meant.
struct PathReading {
  DrillPath path;
  std::string words;  ///< "the points are RAS: x and y negated"
  int rank = 0;       ///< 0: the commonest mistakes; higher: rarer
};

/// Ends that are swapped, RAS for LPS, both; cm and m; axes in another order, single axes negated. By rank.
std::vector<PathReading> other_readings(const DrillPath& path);

}  // namespace spinaltap
