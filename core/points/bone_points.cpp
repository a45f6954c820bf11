#include "core/points/bone_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {

std::ptrdiff_t nearest_point(const DiscPattern& pattern, double x_mm, double y_mm) noexcept {
  const double off_mm = std::sqrt(x_mm * x_mm + y_mm * y_mm);
  double turns = std::atan2(y_mm, x_mm) / (2.0 * std::numbers::pi);
  if (turns < 0.0) turns += 1.0;
  double ring_mm = off_mm;
  if (pattern.subdivision() == DiscSubdivision::hexagons) {
    // A hexagon's side is nearer than its corners, and its points are even along it, not around.
    const double corner = std::min(std::floor(6.0 * turns), 5.0);
    const double from_middle = (turns - (corner + 0.5) / 6.0) * 2.0 * std::numbers::pi;
    ring_mm *= std::cos(from_middle) / (0.5 * std::numbers::sqrt3);
    turns = (corner + 0.5 + 0.5 * std::numbers::sqrt3 * std::tan(from_middle)) / 6.0;
  }
  const double ring_number = std::floor(ring_mm / pattern.spacing_mm() + 0.5);
  if (!(ring_number < pattern.ring_count())) return -1;
  const int ring = static_cast<int>(ring_number);
  const auto size = static_cast<std::ptrdiff_t>(DiscPattern::ring_size(ring));
  const auto place = static_cast<std::ptrdiff_t>(std::lround(turns * static_cast<double>(size)));
  return static_cast<std::ptrdiff_t>(DiscPattern::ring_start(ring)) + (place < size ? place : 0);
}

BonePoints::BonePoints(std::span<const PointVolume> volumes, const Material& material) : volumes_(volumes) {
  check_material(material);
  if (volumes.empty()) fail("forces: expected one volume or more, found none");
  const PathFrame& frame = volumes.front().frame();
  std::pair<int, int> range{32767, -32768};
  for (const PointVolume& volume : volumes) {
    const Pose start = frame.to_path(volume.frame().to_patient(Pose{}));
    const Vec3 x_axis = frame.to_path(volume.frame().to_patient(Pose{Vec3::Zero(), Vec3::UnitX()})).axis;
    const bool is_along = std::hypot(start.tip_mm.x(), start.tip_mm.y()) < 1e-6 &&
                          (start.axis - Vec3::UnitZ()).norm() < 1e-9 && (x_axis - Vec3::UnitX()).norm() < 1e-9;
    if (!is_along || (!starts_mm_.empty() && !(start.tip_mm.z() > starts_mm_.back()))) {
      fail("forces: expected volumes end to end along one path, found number ", starts_mm_.size() + 1, " elsewhere");
    }
    starts_mm_.push_back(start.tip_mm.z());
    widest_spacing_mm_ = std::max(widest_spacing_mm_, volume.pattern().spacing_mm());
    const auto [lowest, highest] = volume.hu_range();
    range = {std::min<int>(range.first, lowest), std::max<int>(range.second, highest)};
  }
  lowest_hu_ = range.first;
  for (int hu = range.first; hu <= range.second; ++hu) {
    bones_.push_back(
        {material.density.density_g_cm3(hu), material.chisel_pressure_mpa(hu), material.contact_stiffness_n_mm(hu)});
  }
}

std::size_t BonePoints::volume_at(double z_mm) const noexcept {
  // Discs stand for the layer around them.
  std::size_t n = volumes_.size() - 1;
  while (n > 0 && z_mm < starts_mm_[n] - 0.5 * volumes_[n].pattern().spacing_mm()) --n;
  return n;
}

const BonePoints::Bone* BonePoints::living_at(const Vec3& p) const noexcept {
  const std::size_t n = volume_at(p.z());
  const PointVolume& volume = volumes_[n];
  const double disc = std::floor((p.z() - starts_mm_[n]) / volume.pattern().spacing_mm() + 0.5);
  if (!(disc >= 0.0 && disc < volume.disc_count())) return nullptr;
  const std::ptrdiff_t index = nearest_point(volume.pattern(), p.x(), p.y());
  const int number = static_cast<int>(disc);
  if (index < 0 || !volume.is_alive(number, static_cast<std::size_t>(index))) return nullptr;
  const int hu = volume.hu(number, static_cast<std::size_t>(index));
  return &bones_[static_cast<std::size_t>(hu - lowest_hu_)];
}

}  // namespace spinaltap
