#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/points/material.h"
#include "core/points/point_volume.h"

namespace spinaltap {

/// The living points of volumes that lie end to end along one path, found by place. Coordinates are the first volume's.
class BonePoints {
 public:
  /// What a material makes of a point.
  struct Bone {
    double density_g_cm3 = 0.0;
    double chisel_mpa = 0.0;
    double contact_n_mm = 0.0;  ///< of a surface as large as the bit's section
  };

  /// The volumes must be filled and outlive this. Throws Error without any, where one does not lie along the first's
  /// path, and on a bad material.
  BonePoints(std::span<const PointVolume> volumes, const Material& material);

  const PathFrame& frame() const { return volumes_.front().frame(); }
  /// The volume nearest along the path.
  std::size_t volume_at(double z_mm) const noexcept;
  const PointVolume& volume(std::size_t n) const { return volumes_[n]; }
  /// Where a volume's first disc lies along the path.
  double start_mm(std::size_t volume) const { return starts_mm_[volume]; }
  double widest_spacing_mm() const { return widest_spacing_mm_; }

  /// What the point nearest to `p` is made of; null where it is dead or no volume reaches there. Of jittered points,
  /// the place before that counts.
  const Bone* living_at(const Vec3& p) const noexcept;

 private:
  std::span<const PointVolume> volumes_;
  std::vector<double> starts_mm_;
  double widest_spacing_mm_ = 0.0;
  int lowest_hu_ = 0;
  std::vector<Bone> bones_;  ///< of each CT number
};

/// Index of a disc's point next to (x, y); -1 beyond the outermost ring.
std::ptrdiff_t nearest_point(const DiscPattern& pattern, double x_mm, double y_mm) noexcept;

}  // namespace spinaltap
