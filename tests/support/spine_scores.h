#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/crop.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "core/segment/segment_spine.h"
#include "tests/support/mask_overlap.h"

namespace spinaltap::test {

/// How one true level of a phantom came out.
struct LevelScore {
  Level level = Level::kNone;
  std::optional<std::size_t> found;  ///< index of the level found at its place; nothing: it is missing
  double dice = 0.0;
  double surface_mm = 0.0;       ///< mean distance of the surfaces
  double centre_mm = 0.0;        ///< of the bodies
  double tip_mm = 0.0;           ///< the worst of the spinous and transverse processes
  double neighbour_share = 0.0;  ///< the most that it took of another vertebra

  bool is_wrong() const { return !found || !(dice >= 0.9) || !(centre_mm <= 4.0); }
};

struct SpineScore {
  std::vector<LevelScore> levels;  ///< from above
  std::size_t extra = 0;           ///< levels found where there is none
};

/// Distance from a point to the nearest voxel of a mask, taken as a box, mm; 20 where none is nearer.
inline double distance_to_mask_mm(const BoneMask& mask, const Vec3& p_mm) {
  constexpr double kReachMm = 20.0;
  const GridGeometry& geometry = mask.geometry;
  const Vec3 p = geometry.to_index(p_mm);
  const Vec3 reach = Vec3::Constant(kReachMm).cwiseQuotient(geometry.spacing_mm);
  double min_mm = kReachMm;
  const Eigen::Vector3i low = (p - reach).array().floor().cast<int>();
  const Eigen::Vector3i high = (p + reach).array().ceil().cast<int>();
  for (int k = std::max(0, low.z()); k <= std::min(high.z(), geometry.size[2] - 1); ++k) {
    for (int j = std::max(0, low.y()); j <= std::min(high.y(), geometry.size[1] - 1); ++j) {
      for (int i = std::max(0, low.x()); i <= std::min(high.x(), geometry.size[0] - 1); ++i) {
        if (!mask.at(i, j, k)) continue;
        const Vec3 away = ((p - Vec3(i, j, k)).cwiseAbs() - Vec3::Constant(0.5)).cwiseMax(0.0);
        min_mm = std::min(min_mm, away.cwiseProduct(geometry.spacing_mm).norm());
      }
    }
  }
  return min_mm;
}

/// The level found nearest to a body's middle, nearer than `within_mm`, of those that are not `used`; its distance.
struct NearestLevel {
  std::size_t index;
  double away_mm;
};
inline std::optional<NearestLevel> nearest_level(const SpineSegmentation& found, const std::vector<bool>& used,
                                                 const Vec3& centre_mm, double within_mm) {
  std::optional<NearestLevel> nearest;
  for (std::size_t n = 0; n < found.levels.size(); ++n) {
    const double away_mm = (found.levels[n].body_centre_mm - centre_mm).norm();
    if (used[n] || away_mm >= (nearest ? nearest->away_mm : within_mm)) continue;
    nearest = {n, away_mm};
  }
  return nearest;
}

/// Compares with the ground truth, by place and not by name. The spine is made from SpineOptions.
inline SpineScore score_of(const SpineSegmentation& found, const Spine& spine) {
  const LabelVolume ground_truth = true_labels(spine, found.labels.geometry);
  SpineScore score;
  std::vector<bool> used(found.levels.size(), false);
  for (const LevelGroundTruth& level : spine_ground_truth(spine).levels) {
    LevelScore one;
    one.level = level.level;
    one.centre_mm = 10.0;  // half of a level's height: further away is another one
    if (const auto nearest = nearest_level(found, used, level.body_centre_mm, one.centre_mm)) {
      one.found = nearest->index;
      one.centre_mm = nearest->away_mm;
    }
    if (one.found) {
      used[*one.found] = true;
      const int found_label = found.levels[*one.found].label;
      const auto true_label = static_cast<std::uint8_t>(level.level);
      BoneMask mask = mask_of(found.labels, found_label);
      BoneMask is = mask_of(ground_truth, level.level);
      BoneMask either = is;
      std::array<std::size_t, 256> taken{};
      std::array<std::size_t, 256> all{};
      for (std::size_t v = 0; v < mask.inside.size(); ++v) {
        either.inside[v] = mask.inside[v] | is.inside[v];
        const std::uint8_t label = ground_truth.labels[v];
        ++all[label];
        taken[label] += mask.inside[v];
      }
      for (std::size_t label = 1; label < all.size(); ++label) {
        if (all[label] == 0 || label == true_label || label == kRibLabel) continue;
        one.neighbour_share =
            std::max(one.neighbour_share, static_cast<double>(taken[label]) / static_cast<double>(all[label]));
      }
      one.dice = dice(mask, is);
      const VoxelBlock block = block_around(either, 3.0);
      one.surface_mm = mean_surface_distance_mm(crop(mask, block), crop(is, block));
      for (const Vec3& tip_mm : {level.spinous_tip_mm, level.left_transverse_tip_mm, level.right_transverse_tip_mm}) {
        one.tip_mm = std::max(one.tip_mm, distance_to_mask_mm(mask, tip_mm));
      }
    }
    score.levels.push_back(one);
  }
  score.extra = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  return score;
}

inline std::string texts_of(const LevelReport& level) {
  std::string texts;
  for (const LevelWarning& warning : level.warnings) texts += (texts.empty() ? "" : "; ") + warning.text;
  return texts;
}

/// A line a level, with its severity and what is said of it where that is much.
inline void print(const SpineScore& score, const SpineSegmentation& found, const std::string& what) {
  for (const LevelScore& level : score.levels) {
    if (!level.found) {
      std::printf("%s %s: missing\n", what.c_str(), level_name(level.level).c_str());
      continue;
    }
    const LevelReport& report = found.levels[*level.found];
    std::printf(
        "%s %-3s as %-3s Dice %.3f, surface %.2f mm, centre %.1f mm, tips %.2f mm, of neighbours %.2f %%, severity "
        "%.2f%s%s\n",
        what.c_str(), level_name(level.level).c_str(), report.name.c_str(), level.dice, level.surface_mm,
        level.centre_mm, level.tip_mm, 100.0 * level.neighbour_share, report.severity, level.is_wrong() ? " WRONG" : "",
        report.warnings.empty() ? "" : (" " + texts_of(report)).c_str());
  }
  if (score.extra > 0) std::printf("%s: %zu levels too many\n", what.c_str(), score.extra);
}

/// Whether a level that came out wrong is told: it is suspect itself or, where it is missing, what was found next to
/// its place.
inline bool is_told(const LevelScore& level, const Vec3& body_centre_mm, const SpineSegmentation& found) {
  if (level.found) return found.levels[*level.found].is_suspect();
  constexpr double kNextMm = 60.0;
  return std::any_of(found.levels.begin(), found.levels.end(), [&](const LevelReport& report) {
    return report.is_suspect() && (report.body_centre_mm - body_centre_mm).norm() < kNextMm;
  });
}

}  // namespace spinaltap::test
