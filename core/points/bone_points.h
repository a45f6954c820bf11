#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/points/occupied_bone.h"
#include "core/points/point_volume.h"

namespace spinaltap {

/// The occupied points of volumes that lie end to end along one path, found by place. Coordinates are the first
/// volume's.
class BonePoints final : public OccupiedBone {
 public:
  /// The volumes must be filled and outlive this. Throws Error without any, where one does not lie along the first's
  /// path, and on a bad material.
  BonePoints(std::span<const PointVolume> volumes, const Material& material);

  const PathFrame& frame() const override { return volumes_.front().frame(); }
  bool has_occupied() const override;
  double widest_spacing_mm() const override { return widest_spacing_mm_; }
  double spacing_mm(const Vec3& p) const noexcept override { return discs_at(p.z())->pattern().spacing_mm(); }
  /// Of jittered points, the place before that counts.
  const Bone* occupied_at(const Vec3& p) const noexcept override;
  /// By a line between the next two discs, one spacing ahead.
  void add_ahead_of(const Vec3& p, const Vec3& axis, double share, Mean& mean) const noexcept override;
  /// The volume nearest along the path.
  const PointVolume* discs_at(double z_mm) const noexcept override { return &volumes_[volume_at(z_mm)]; }

  void check_within(const DrillPath& path) const override;
  double past_end_mm(const Vec3& tip_mm) const noexcept override;
  double beyond_side_mm(const BitProfile& bit, const Pose& pose, const Vec3& contact_mm) const noexcept override;

 private:
  std::size_t volume_at(double z_mm) const noexcept;

  std::span<const PointVolume> volumes_;
  std::vector<double> starts_mm_;  ///< of the volumes' first discs, along the path
  double widest_spacing_mm_ = 0.0;
  double radius_mm_;  ///< of the cylinder that the volumes stand for
  double length_mm_ = 0.0;
  Table bones_;
};

/// Index of a disc's point next to (x, y); -1 beyond the outermost ring.
std::ptrdiff_t nearest_point(const DiscPattern& pattern, double x_mm, double y_mm) noexcept;

}  // namespace spinaltap
