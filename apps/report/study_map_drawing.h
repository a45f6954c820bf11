#pragma once

#include <string>

#include "core/study/study_map.h"

namespace spinaltap {

/// An <svg> element, half as wide as a page: how likely a breach is where a screw lies so far off its plan, % in each
/// square; squares of few runs are pale.
std::string study_map_svg(const StudyMap& map);

}  // namespace spinaltap
