#pragma once

#include <cstdint>
#include <string>

#include "core/phantom/random_trunk.h"
#include "tests/support/trunk_scores.h"
#include "tests/trunks/level_table.h"

namespace spinaltap::test {

/// A random patient in a random scanner, what was found in that CT, and how it compares with the ground truth.
struct TrunkExam {
  std::uint64_t seed = 0;
  TrunkOptions options;
  CtVolume ct;
  LabelVolume ground_truth;
  SpineSegmentation found;  ///< empty where segment_spine() says that there is no spine; its words are a gap then
  TrunkScore score;

  /// "seed 4 (0.7 x 1.2 mm, noise 40 HU, ...)".
  std::string what() const;
  bool is_wrong(const WholeLevelScore& level) const {
    return !(level.dice >= right_dice_at(options.scan.slice_step_mm));
  }
  /// What was found of a level, which is there.
  const LevelReport& report_of(const WholeLevelScore& level) const { return found.levels[*level.found]; }
};

/// Scans a spine made from `options.spine` as the options say.
CtVolume scan_trunk(const Spine& spine, const TrunkOptions& options);

TrunkExam examine_trunk(std::uint64_t seed);

/// A level's warnings, in one line.
std::string warnings_in_line(const LevelReport& report);

}  // namespace spinaltap::test
