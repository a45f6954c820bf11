#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/engine/step_result.h"
#include "core/points/material.h"
#include "core/points/point_volume.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Removes the points that a moving bit reaches. `step` allocates, locks and logs nothing, except that steps with work
/// worth sharing go to TBB's threads.
///
/// All engines remove the same points: those that SweptBit holds for the pieces of BitMotion from the last pose to this
/// one; the first step has no way, only its pose.
class DrillEngine {
 public:
  DrillEngine() = default;
  DrillEngine(const DrillEngine&) = delete;
  DrillEngine& operator=(const DrillEngine&) = delete;
  virtual ~DrillEngine() = default;

  /// Moves the bit to `pose` (patient LPS, mm). Poses that are not finite, whose axis is not unit, or that are more
  /// than 10 m from the volume's start change nothing.
  virtual StepResult step(const Pose& pose) noexcept = 0;

  /// Forgets where the bit is: the next step has no way, only its pose. For a bit that was moved without turning.
  virtual void reset_motion() noexcept = 0;

  /// What the engine keeps beside the volume.
  virtual std::size_t memory_bytes() const = 0;
};

/// The paper's algorithm (section 7.1), written to be read: every disc up to the bit's foremost point, from the
/// outermost wholly destroyed ring out to the ring that the bit's section can reach, each point by algorithm 1.
/// The volume's points die in place; it must outlive the engine.
std::unique_ptr<DrillEngine> make_reference_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

/// The paper's algorithm with the walk of its section 7.2: on each ring from the point nearest the bit's axis, both
/// ways, for as long as the bit can reach. Loses nothing where a tilted bit's section meets a ring four times.
std::unique_ptr<DrillEngine> make_arc_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

/// The fast one: keeps for every disc how far the bit may move before it can touch an occupied point there, and looks
/// at no disc before. See docs/drilling-engine.md.
std::unique_ptr<DrillEngine> make_ring_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

namespace detail {
struct DiscKernels;

/// The same with a set of instructions of one's own choice; the other takes the machine's fastest.
std::unique_ptr<DrillEngine> make_ring_engine(PointVolume& volume, const DrillBit& bit, const Material& material,
                                              const DiscKernels& kernels);
}  // namespace detail

}  // namespace spinaltap
