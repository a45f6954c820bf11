#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/drill/drill_bit.h"
#include "core/drill/material.h"
#include "core/drill/point_volume.h"

namespace spinaltap {

/// What one move of the bit did.
struct StepResult {
  std::size_t removed = 0;      ///< points that died
  std::size_t tested = 0;       ///< points put to the inside test
  std::int64_t removed_hu = 0;  ///< sum of their CT numbers
  double work_n_mm = 0.0;       ///< of cutting them
  double thrust_n = 0.0;        ///< work over the way the tip went along its axis; 0 when it did not advance
};

/// Removes the points that a moving bit reaches. `step` allocates, locks and logs nothing.
class DrillEngine {
 public:
  DrillEngine() = default;
  DrillEngine(const DrillEngine&) = delete;
  DrillEngine& operator=(const DrillEngine&) = delete;
  virtual ~DrillEngine() = default;

  /// Moves the bit to `pose` (patient LPS, mm). Poses that are not finite change nothing.
  virtual StepResult step(const Pose& pose) noexcept = 0;
};

/// The paper's algorithm (section 7.1), written to be read: every disc up to the bit's foremost point, from the
/// outermost wholly destroyed ring out to the ring that the bit's section can reach, each point by algorithm 1.
/// The volume's points die in place; it must outlive the engine.
std::unique_ptr<DrillEngine> make_reference_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

}  // namespace spinaltap
