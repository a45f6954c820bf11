#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "core/segment/segment_spine.h"
#include "tests/support/spine_scores.h"

namespace spinaltap::test {

/// How one level came out that lies whole in a CT.
struct WholeLevelScore {
  Level level = Level::kNone;
  std::optional<std::size_t> found;  ///< index of the level found at its place, within 7 mm
  double centre_mm = 0.0;            ///< of the bodies
  double dice = 0.0;
  bool is_told = false;  ///< it is suspect, or where it is missing there is a word of it
};

struct TrunkScore {
  std::vector<WholeLevelScore> levels;
  std::vector<std::size_t> extra;  ///< levels found where there is none, though not cut
};

/// Counts of voxels by true label and by found label, and of both together; which true labels reach the border.
struct LabelCounts {
  std::array<std::size_t, 256> is{}, found{};
  std::vector<std::array<std::size_t, 256>> both = std::vector<std::array<std::size_t, 256>>(256);
  std::array<bool, 256> at_border{};
};

inline LabelCounts count_labels(const LabelVolume& ground_truth, const LabelVolume& found) {
  LabelCounts counts;
  const auto& size = ground_truth.geometry.size;
  std::size_t voxel = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++voxel) {
        const std::uint8_t is = ground_truth.labels[voxel], as = found.labels[voxel];
        if (is == 0 && as == 0) continue;
        ++counts.is[is];
        ++counts.found[as];
        ++counts.both[is][as];
        const bool inner = i > 0 && j > 0 && k > 0 && i < size[0] - 1 && j < size[1] - 1 && k < size[2] - 1;
        if (!inner) counts.at_border[is] = true;
      }
    }
  }
  return counts;
}

/// Compares with the ground truth, by place and not by name: levels of C3 to the last lumbar one that do not reach the
/// CT's border.
inline TrunkScore score_trunk(const SpineSegmentation& found, const Spine& spine, const LabelVolume& ground_truth) {
  constexpr double kFoundMm = 7.0, kAnyMm = 14.0, kNextMm = 60.0;
  const LabelCounts counts = count_labels(ground_truth, found.labels);
  TrunkScore score;
  std::vector<bool> known(found.levels.size(), false);
  for (std::size_t n = 0; n < found.levels.size(); ++n) {
    // C1, C2, the sacrum and levels that are cut may be found or not.
    const auto near = [&](const PlacedLevel& one) {
      const double reach_mm =
          counts.at_border[static_cast<std::size_t>(one.level)] || one.level == Level::kSacrum ? 2.0 * kAnyMm : kAnyMm;
      return (one.position_mm - found.levels[n].body_centre_mm).norm() < reach_mm;
    };
    known[n] = std::any_of(spine.placed().begin(), spine.placed().end(), near);
    if (!known[n] && !found.levels[n].is_cut) score.extra.push_back(n);
  }
  std::vector<bool> used(found.levels.size(), false);
  for (const LevelGroundTruth& truth : spine_ground_truth(spine).levels) {
    const auto label = static_cast<std::size_t>(truth.level);
    if (counts.is[label] == 0 || counts.at_border[label]) continue;
    WholeLevelScore one;
    one.level = truth.level;
    one.centre_mm = kFoundMm;
    if (const auto nearest = nearest_level(found, used, truth.body_centre_mm, kFoundMm)) {
      one.found = nearest->index;
      one.centre_mm = nearest->away_mm;
    }
    if (one.found) {
      used[*one.found] = true;
      const auto as = static_cast<std::size_t>(found.levels[*one.found].label);
      one.dice = 2.0 * static_cast<double>(counts.both[label][as]) /
                 static_cast<double>(std::max<std::size_t>(1, counts.is[label] + counts.found[as]));
      one.is_told = found.levels[*one.found].is_suspect();
    } else {
      one.is_told =
          !found.gaps.empty() || std::any_of(found.levels.begin(), found.levels.end(), [&](const LevelReport& report) {
            return report.is_suspect() && (report.body_centre_mm - truth.body_centre_mm).norm() < kNextMm;
          });
    }
    score.levels.push_back(one);
  }
  return score;
}

}  // namespace spinaltap::test
