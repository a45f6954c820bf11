#include "core/engine/volume_engine.h"

#include <algorithm>
#include <cmath>

#include "core/tool/plate.h"

namespace spinaltap {
namespace {

/// Places to a millimetre: sixteen to a spacing, or as many as keep the moment of all points at once below 2^62.
double places_per_mm(const PointVolume& volume, const PressureTable& pressure) {
  const double spacing_mm = volume.pattern().spacing_mm();
  const double farthest = std::max(volume.disc_count(), volume.pattern().ring_count()) + 1.0;
  const auto hardest = static_cast<double>(pressure.highest_units());
  double places = 16.0;
  while (4.0 * hardest * static_cast<double>(volume.point_count()) * (farthest * places + 1.0) > 0x1.0p62) {
    places *= 0.5;
  }
  return places / spacing_mm;
}

PressureTable pressures_in(const PointVolume& volume, const Material& material) {
  const auto [lowest, highest] = volume.hu_range();
  return PressureTable(material, lowest, highest);
}

/// What engines of points know how to sweep.
const DrillBit& turning(const DrillBit& bit) {
  check_turns(bit, "an engine of points");
  return bit;
}

}  // namespace

PointParts::PointParts(const DiscPattern& pattern)
    : parts{pattern.subdivision() == DiscSubdivision::rings ? 3 : 4, 4}, part_mm3(0.25 * pattern.point_volume_mm3(1)) {}

PointPlaces::PointPlaces(const PointVolume& volume, const PressureTable& pressure)
    : per_mm(places_per_mm(volume, pressure)) {
  for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
    const Eigen::Vector2d& p = volume.pattern().point_mm(i);
    of_points.push_back({static_cast<std::int32_t>(nearest(p.x())), static_cast<std::int32_t>(nearest(p.y()))});
  }
  of_points.shrink_to_fit();
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    of_discs.push_back(static_cast<std::int32_t>(nearest(volume.disc_depth_mm(disc))));
  }
  of_discs.shrink_to_fit();
}

std::int64_t PointPlaces::nearest(double mm) const noexcept { return std::llround(mm * per_mm); }

void VolumeEngine::account_moved(int disc, std::size_t index, std::int64_t pressure, Removal& removal) const noexcept {
  const Vec3 p = volume_.point_in_path_mm(disc, index);
  const std::array<std::int64_t, 3> at{places_.nearest(p[0]), places_.nearest(p[1]), places_.nearest(p[2])};
  for (std::size_t n = 0; n < 3; ++n) removal.moment[n] += pressure * at[n];
  if (removal.back.is_asked()) {
    removal.pressure_back[removal.back.part(removal.back.along(at[0], at[1], at[2]))] += pressure;
  }
}

VolumeEngine::VolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material)
    : SweptEngine(turning(bit), volume.frame()),
      volume_(volume),
      pressure_(pressures_in(volume, material)),
      parts_(volume.pattern()),
      places_(volume, pressure_) {
  set_units({parts_.part_mm3, places_.per_mm});
}

std::size_t VolumeEngine::memory_bytes() const {
  return sizeof(*this) + pressure_.memory_bytes() + places_.of_points.size() * sizeof(places_.of_points[0]) +
         places_.of_discs.size() * sizeof(places_.of_discs[0]);
}

std::pair<int, int> VolumeEngine::discs_within(const SweptBit& bit) const noexcept {
  // One disc more on each side than the division says: rounding may not cost a disc.
  const double spacing_mm = volume_.pattern().spacing_mm();
  const double discs = volume_.disc_count();
  const double spare_mm = volume_.out_of_plane_mm();
  const double first = std::clamp(std::floor((bit.lowest_z_mm() - spare_mm) / spacing_mm) - 1.0, 0.0, discs);
  const double last = std::clamp(std::ceil((bit.highest_z_mm() + spare_mm) / spacing_mm) + 1.0, -1.0, discs - 1.0);
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace spinaltap
