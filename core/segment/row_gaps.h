#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/segment/spine_bodies.h"

namespace spinaltap {

/// Where a row of bodies may lack some, in words, with places in patient LPS: where two neighbours lie so far apart
/// that a body has room between them, or a crushed one among thin discs, or much further than others do, where a body
/// is so high that it may be two, and where the canal goes on beyond the row by more than a vertebra. Nothing below a
/// sacrum, whose canal ends in it, and nothing of fewer than two bodies.
std::vector<std::string> gaps_in_row(const SpineBodies& spine);

/// How many bodies the row lacks between one and the next above: 0 where it names no gap there, nothing where the room
/// fits no number of them well, as beside a crushed one, or one of both may be two.
std::optional<int> bodies_missing_above(const SpineBodies& spine, std::size_t lower);

}  // namespace spinaltap
