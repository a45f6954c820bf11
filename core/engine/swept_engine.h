#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/engine/drill_engine.h"
#include "core/tool/drill_path.h"
#include "core/tool/swept_bit.h"

namespace spinaltap {

/// Tells in which part of a bit's length a place lies: by whole numbers, so that all engines say the same.
struct BackParts {
  std::array<std::int64_t, 3> back{};  ///< the direction back along the axis, in 1 / 1024; all 0: nobody asks
  std::int64_t begin = 0;              ///< of the tip along it, in 1 / 1024 of a place
  std::int64_t parts = 0;              ///< to a 1 / 1024 of a place, in 1 / 2^32

  BackParts() = default;
  /// Of a bit of `length_mm` at `pose`, in the frame and the places of an engine.
  BackParts(const Pose& pose, double length_mm, double places_per_mm) noexcept;

  bool is_asked() const { return parts != 0; }
  std::int64_t along(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    return back[0] * x + back[1] * y + back[2] * z - begin;
  }
  std::size_t part(std::int64_t along) const noexcept {
    constexpr std::int64_t kLast = StepResult::kBackParts - 1;
    const std::int64_t part = (along * parts) >> 32;
    return static_cast<std::size_t>(part < 0 ? 0 : part > kLast ? kLast : part);
  }
};

/// Sums over what was removed. Whole numbers: neither order nor threads change them.
struct Removal {
  std::size_t removed = 0;
  std::size_t tested = 0;
  std::int64_t hu = 0;
  std::int64_t parts = 0;                ///< of volume, see RemovalUnits
  std::int64_t pressure = 0;             ///< parts times units of PressureTable
  std::array<std::int64_t, 3> moment{};  ///< those times whole places, in the engine's frame
  BackParts back;
  std::array<std::int64_t, StepResult::kBackParts> pressure_back{};  ///< `pressure` by part, where it is asked

  /// With no sums, but what is asked for.
  Removal empty() const noexcept {
    Removal other;
    other.back = back;
    return other;
  }

  void add(const Removal& other) {
    removed += other.removed;
    tested += other.tested;
    hu += other.hu;
    parts += other.parts;
    pressure += other.pressure;
    for (std::size_t n = 0; n < 3; ++n) moment[n] += other.moment[n];
    for (std::size_t n = 0; n < pressure_back.size(); ++n) pressure_back[n] += other.pressure_back[n];
  }
};

/// What the whole numbers of a Removal stand for.
struct RemovalUnits {
  double part_mm3 = 0.0;
  double places_per_mm = 1.0;
};

/// What it comes to where a step ends at `tip_mm`; that and the places of the removal are of `frame`.
StepResult result_of(const Removal& removal, const RemovalUnits& units, const PathFrame& frame,
                     const Vec3& tip_mm) noexcept;

/// Engines take no pose further than this from where their frame begins, along any coordinate.
inline constexpr double kEngineReachMm = 1e4;

/// What the engines of bodies of revolution share, whatever they keep bone in: poses, pieces of the way, and what
/// removing comes to.
class SweptEngine : public DrillEngine {
 public:
  StepResult step(const Pose& pose) noexcept final;
  void reset_motion() noexcept final { is_placed_ = false; }

 protected:
  /// Bits are taken into `frame`, where numbers are small. Throws Error on a bad bit.
  SweptEngine(const DrillBit& bit, const PathFrame& frame);

  /// Removes all occupied bone that the bit passes; coordinates of the frame.
  virtual void remove(const SweptBit& bit, Removal& removal) noexcept = 0;
  /// The same of pieces of a way that follow one another, at most kTogether: an engine's own where that is quicker.
  static constexpr std::size_t kTogether = 4;
  virtual void remove_together(std::span<const SweptBit> pieces, Removal& removal) noexcept {
    for (const SweptBit& bit : pieces) remove(bit, removal);
  }

  void set_units(const RemovalUnits& units) { units_ = units; }
  const BitProfile& profile() const { return profile_.bit; }
  const PathFrame& frame() const { return frame_; }

 private:
  SweepProfile profile_;
  PathFrame frame_;
  RemovalUnits units_;
  Pose pose_;  ///< in the frame
  bool is_placed_ = false;
};

}  // namespace spinaltap
