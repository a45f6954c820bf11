#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/segment/bone_levels.h"

namespace spinaltap {

/// The spinal canal as a curve from below upward, patient LPS, mm.
struct SpinalCanal {
  std::vector<Vec3> points_mm;  ///< a point each kStepMm of height, the lowest first
  std::vector<double> support;  ///< of each point, 0 to 2: how much like a canal with a body in front its slice looks
  static constexpr double kStepMm = 2.5;
};

/// Which of the canals of a CT is looked for.
struct CanalSearch {
  std::optional<Vec3> near_mm = std::nullopt;  ///< behind this point in a vertebral body, patient LPS, mm
  std::vector<SpinalCanal> but_not = {};       ///< what looked like canals, and had no bodies
};

/// Finds the canals of a CT that lies in the patient's frame.
///
/// In steps of 2.5 mm, each soft voxel looks along 16 directions across the patient for bone (in the brightest voxel of
/// the block), and forward through it for a body's depth of bone. A canal is what sees bone on most sides, near, with a
/// body in front. The best chain of such places from slice to slice, which shifts by at most 45 degrees, is found by
/// dynamic programming, after Yao (2006, "Automated spinal column extraction and partitioning"); it begins and ends
/// where it is best to.
class CanalFinder {
 public:
  /// Looks at all of the CT, once for all canals.
  CanalFinder(const CtVolume& ct, const BoneLevels& levels, const Progress& progress = {});
  ~CanalFinder();

  /// Empty where no chain is longer than 10 mm.
  SpinalCanal find(const CanalSearch& search = {}, const Progress& progress = {}) const;

 private:
  struct Scores;
  std::unique_ptr<const Scores> scores_;
};

}  // namespace spinaltap
