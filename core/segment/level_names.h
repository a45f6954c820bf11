#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/ct/level.h"

namespace spinaltap {

struct SpineBodies;

/// Where ribs were found at a level. Beside a scoliotic body one of a pair may not be found, and a broken transverse
/// process may look like one.
enum class Ribs { unknown, none, one_side, both };

/// What a row's bodies are called, from below.
struct LevelNames {
  std::vector<Level> levels;  ///< kNone where nothing names it well enough
  std::vector<std::vector<LevelProbability>>
      probabilities;  ///< of each body, from 0.01 on, the likeliest first; none where unknown
  /// What speaks against five lumbar and twelve thoracic vertebrae; empty where nothing does.
  std::string transitional;
};

/// The levels of a row of which one is known, counted up and down from it over what the row lacks; no further than
/// where it is not clear how many bodies that are (bodies_missing_above()): kNone there.
std::vector<Level> levels_counted_from(const SpineBodies& spine, std::size_t index, Level level);

/// Names by votes: the sacrum below the row, ribs at each of its bodies, and how widths and heights of bodies grow
/// along a spine (Panjabi 1991, 1992). For each place of the row in each of six kinds of people, with 4 to 6 lumbar
/// vertebrae and the last ribs at T11 to L1, as often as in 802 CTs (CTSpinoPelvic1K), the votes'
/// likelihoods give a probability. A body is named from 0.9 on. Stretches that an unclear gap parts vote alone.
/// `ribs`: of each body.
LevelNames voted_names(const SpineBodies& spine, const std::vector<Ribs>& ribs);

/// "L1 0.83, T12 0.15".
std::string in_words(const std::vector<LevelProbability>& probabilities);

}  // namespace spinaltap
