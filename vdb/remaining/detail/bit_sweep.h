#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/tool/drill_bit.h"
#include "vdb/remaining/detail/meridian_outline.h"

namespace spinaltap::detail {

/// Distance to what a bit swept (mm, negative inside) and its gradient, unit, away from the bit.
struct SweepSample {
  double distance_mm = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// A short way of a bit: through some poses, straight from each to the next as seen from the bit (see SweptBit). The
/// distance is the least over the way: outside it is exact, inside it is exact near the surface.
class BitSweep {
 public:
  /// Where `outline` is of a bit that was lengthened backwards by the way along its axis, `lengthened_mm` is that way.
  BitSweep(std::shared_ptr<const BitOutline> outline, std::span<const Pose> poses, double lengthened_mm = 0.0);

  const BitOutline& outline() const { return *outline_; }
  std::size_t moment_count() const { return moments_.size(); }
  const Pose& pose(std::size_t moment) const { return poses_[moment]; }
  /// The pose that bounds are taken from.
  const Pose& middle() const { return poses_[middle_]; }

  /// Distance to the bit at middle(), exact.
  double middle_distance_mm(const Vec3& p) const;
  /// By how much, at most, the distance of points within `around_mm` of p changes between the bit at `from` and at any
  /// pose of this way. Along a cylinder's wall the bit may slide: `wall_mm` is how near to the bit those points are
  /// that matter.
  double change_mm(const Pose& from, const Vec3& p, double around_mm, double wall_mm) const;
  double change_from_middle_mm(const Vec3& p, double around_mm, double wall_mm) const;
  /// The same from middle() to each pose alone, into `changes_mm`, one a moment; returns the largest.
  double changes_from_middle_mm(const Vec3& p, double around_mm, double wall_mm, std::vector<double>& changes_mm) const;

  /// The least distance over the way.
  SweepSample nearest(const Vec3& p) const;
  /// The same where it is below `limit_mm`; elsewhere any distance not below it. `at_middle_mm` and `changes_mm` are of
  /// p: they tell which parts of the way need no look.
  SweepSample nearest_below(const Vec3& p, double limit_mm, double at_middle_mm,
                            std::span<const double> changes_mm) const;

  // Along a cylinder's wall all is simpler, where distances that are clamped to a band are asked for.
  static constexpr int kWallCubeSide = 4;
  /// Of 4 x 4 x 4 places, z running fastest.
  using WallCube = std::array<double, kWallCubeSide * kWallCubeSide * kWallCubeSide>;
  /// Whether, all the way, points within `around_mm` of p lie beside the cylinder and no nearer to its ends.
  bool is_at_wall_throughout(const Vec3& p, double around_mm) const;
  /// middle_distance_mm() of places from `first` on, `step_mm` apart.
  void middle_distances_at_wall(const Vec3& first, double step_mm, WallCube& distances_mm) const;
  /// nearest_below() there.
  SweepSample nearest_below_at_wall(const Vec3& p, double limit_mm, double at_middle_mm,
                                    std::span<const double> changes_mm) const;

  /// Box around all that lies within `margin_mm` of the bit on its way.
  Box3 bounds_mm(double margin_mm) const;

 private:
  struct Moment {
    Vec3 tip_mm;
    Mat3 rows;  ///< two directions across the axis, of a plate along its width and its thickness, and back along it
  };
  /// How far all points around p move, at most, seen from the bit: in any way, and where they are at a cylinder's wall.
  struct Change {
    double all_mm = 0.0;
    double across_mm = 0.0;
    double along_mm = 0.0;
  };
  /// A moment of the way: t from a pose to the next.
  struct Place {
    std::size_t moment = 0;
    double t = 0.0;
    bool is_found = false;
  };
  Change change(const Pose& from, const Pose& to, double reach_mm) const;
  double max_change_mm(const Pose& from, const Vec3& p, double around_mm, double wall_mm, double more_mm) const;
  bool is_at_wall(const Pose& from, const Vec3& p, double spare_mm) const;
  Vec3 seen_at(const Vec3& p, const Place& place) const;
  template <class Body>
  Place nearest_place(const Body& body, const Vec3& p, double limit_mm, double at_middle_mm,
                      std::span<const double> changes_mm) const;
  SweepSample sample_at(const Vec3& p, const Place& place) const;

  std::shared_ptr<const BitOutline> outline_;
  std::vector<Pose> poses_;
  std::vector<Moment> moments_;
  std::size_t middle_ = 0;
  double lengthened_mm_ = 0.0;
};

/// Cuts a way through `poses` into short ones. Poses are left out where the bit passes them within `tolerance_mm`,
/// turns are cut until chord and arc differ by less; a straight way along the axis is one pose of a lengthened bit,
/// where the bit widens to one place. Other ways are no longer than `longest_mm`. One pose is a bit that stands. Poses
/// are sound (see valid_pose), `bit` passes check_bit.
std::vector<BitSweep> cut_into_sweeps(const DrillBit& bit, std::span<const Pose> poses, double tolerance_mm,
                                      double longest_mm);

}  // namespace spinaltap::detail
