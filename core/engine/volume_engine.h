#pragma once

#include <array>
#include <vector>

#include "core/engine/swept_engine.h"

namespace spinaltap {

/// What points stand for, in whole parts: the volumes of a disc's centre and of any other point are as 3 to 4 on rings
/// (see DiscPattern), and the same on hexagons.
struct PointParts {
  explicit PointParts(const DiscPattern& pattern);
  std::array<std::int64_t, 2> parts;  ///< of a centre, of another point
  double part_mm3;
};

/// Where points are, path-local, in whole places: so fine, and so coarse that no step's moment overflows.
struct PointPlaces {
  PointPlaces(const PointVolume& volume, const PressureTable& pressure);
  std::int64_t nearest(double mm) const noexcept;

  double per_mm;
  std::vector<std::array<std::int32_t, 2>> of_points;  ///< of a disc, x and y
  std::vector<std::int32_t> of_discs;                  ///< z
};

/// What all engines on one PointVolume share.
class VolumeEngine : public SweptEngine {
 public:
  /// Throws Error on a bad bit or material.
  VolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material);

  std::size_t memory_bytes() const override;

 protected:
  void kill(int disc, std::size_t index, Removal& removal) noexcept {
    volume_.set_occupied(disc, index, false);
    account(disc, index, removal);
  }
  /// Counts a point that has been marked dead already.
  void account(int disc, std::size_t index, Removal& removal) const noexcept {
    const std::int16_t hu = volume_.hu(disc, index);
    const std::int64_t parts = parts_.parts[index == 0 ? 0 : 1];
    const std::int64_t pressure = parts * pressure_.units(hu);
    ++removal.removed;
    removal.hu += hu;
    removal.parts += parts;
    removal.pressure += pressure;
    if (volume_.out_of_plane_mm() > 0.0) return account_moved(disc, index, pressure, removal);
    const std::array<std::int32_t, 2>& across = places_.of_points[index];
    removal.moment[0] += pressure * across[0];
    removal.moment[1] += pressure * across[1];
    const std::int32_t along = places_.of_discs[static_cast<std::size_t>(disc)];
    removal.moment[2] += pressure * along;
    if (removal.back.is_asked()) {
      removal.pressure_back[removal.back.part(removal.back.along(across[0], across[1], along))] += pressure;
    }
  }
  /// First and last disc that the bit may reach; the last before the first where there is none.
  std::pair<int, int> discs_within(const SweptBit& bit) const noexcept;

  PointVolume& volume_;

 private:
  /// The moment of a point that is not where its indices say: a jittered one.
  void account_moved(int disc, std::size_t index, std::int64_t pressure, Removal& removal) const noexcept;

  PressureTable pressure_;
  PointParts parts_;
  PointPlaces places_;
};

}  // namespace spinaltap
