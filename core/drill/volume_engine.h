#pragma once

#include <array>

#include "core/drill/drill_engine.h"
#include "core/drill/swept_bit.h"

namespace spinaltap {

/// Sums over removed points. Whole numbers: neither order nor threads change them.
struct Removal {
  std::size_t removed = 0;
  std::size_t tested = 0;
  std::int64_t hu = 0;
  std::array<std::int64_t, 2> pressure{};  ///< units of PressureTable: of centres, of points of rings

  void add(const Removal& other) {
    removed += other.removed;
    tested += other.tested;
    hu += other.hu;
    pressure[0] += other.pressure[0];
    pressure[1] += other.pressure[1];
  }
};

/// What all engines on one PointVolume share: poses, pieces of the way, and what removing comes to.
class VolumeEngine : public DrillEngine {
 public:
  /// Throws Error on a bad bit or material.
  VolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material);

  StepResult step(const Pose& pose) noexcept final;
  std::size_t memory_bytes() const override;

 protected:
  /// Removes every living point that the bit passes (path-local coordinates).
  virtual void remove(const SweptBit& bit, Removal& removal) noexcept = 0;

  void kill(int disc, std::size_t index, Removal& removal) noexcept {
    volume_.set_alive(disc, index, false);
    account(disc, index, removal);
  }
  /// Counts a point that has been marked dead already.
  void account(int disc, std::size_t index, Removal& removal) const noexcept {
    const std::int16_t hu = volume_.hu(disc, index);
    ++removal.removed;
    removal.hu += hu;
    removal.pressure[index == 0 ? 0 : 1] += pressure_.units(hu);
  }
  /// First and last disc that the bit may reach; the last before the first where there is none.
  std::pair<int, int> discs_within(const SweptBit& bit) const noexcept;

  PointVolume& volume_;

 private:
  BitProfile profile_;
  BitProfile grown_;
  PressureTable pressure_;
  Pose pose_;  ///< path-local
  bool is_placed_ = false;
};

}  // namespace spinaltap
