#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/points/material.h"
#include "core/points/point_volume.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// The drilling engines. Those of points remove the same points of a cylinder along the path; `voxel` mills voxels of
/// the bone; `automatic` ("auto") is one of these, which a session takes by what it is to drill
/// (core/session/choose_engine.h). docs/drilling-engine.md says which is fast where.
enum class EngineKind { automatic, reference, arc, ring, leaf, voxel };

/// Engines by the names that they have in options and reports.
const std::map<std::string, EngineKind>& engine_kinds();
std::string name_of(EngineKind kind);

/// What one move of the bit did.
struct StepResult {
  std::size_t removed = 0;      ///< points that died
  std::size_t tested = 0;       ///< points put to a test of their position
  std::int64_t removed_hu = 0;  ///< sum of their CT numbers
  double removed_mm3 = 0.0;     ///< what they stood for
  double work_n_mm = 0.0;       ///< energy of cutting them at the material's reference feed
  /// Sum over them of that energy times the place, from the tip where the step ends to the point, N·mm²; along the axes
  /// of patient LPS. Its part across the bit's axis tells on which side the bit cut.
  Vec3 moment_n_mm2 = Vec3::Zero();
  /// Of a step that turned the bit: that energy by how far back from the tip along the axis the points lay where the
  /// step ended, in sixteenths of the bit's length; what is beyond counts in the first and the last. Else all 0: all of
  /// the bit moved alike.
  static constexpr std::size_t kBackParts = 16;
  std::array<double, kBackParts> work_back_n_mm{};
};

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

/// The fast one: keeps for every disc how far the bit may move before it can touch a living point there, and looks at
/// no disc before. See docs/drilling-engine.md.
std::unique_ptr<DrillEngine> make_ring_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

namespace detail {
struct DiscKernels;

/// The same with a set of instructions of one's own choice; the other takes the machine's fastest.
std::unique_ptr<DrillEngine> make_ring_engine(PointVolume& volume, const DrillBit& bit, const Material& material,
                                              const DiscKernels& kernels);
}  // namespace detail

}  // namespace spinaltap
