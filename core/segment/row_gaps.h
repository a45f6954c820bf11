#pragma once

#include <string>
#include <vector>

#include "core/segment/spine_bodies.h"

namespace spinaltap {

/// Where a row of bodies may lack some, in words, with places in patient LPS: where two neighbours lie so far apart
/// that a body has room between them, and where the canal goes on beyond the row by more than a vertebra. Nothing below
/// a sacrum, whose canal ends in it, and nothing of fewer than two bodies.
std::vector<std::string> gaps_in_row(const SpineBodies& spine);

}  // namespace spinaltap
