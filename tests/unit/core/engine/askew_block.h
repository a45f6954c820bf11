#pragma once

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/points/point_volume.h"

namespace spinaltap::test {

/// Volumes lie askew and away from the origin, so that no frame is the identity.
inline DrillPath askew_path(double length_mm) {
  const Vec3 entry_mm(81.0, -143.0, 412.0);
  return {"askew", entry_mm, entry_mm + length_mm * Vec3(0.48, -0.64, 0.6), {}};
}

inline void fill_hu(PointVolume& volume, double hu) {
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) volume.set_hu(disc, i, hu);
  }
}

inline PointVolume block(double length_mm, double radius_mm, double spacing_mm, double hu = 1000.0) {
  PointVolume volume(askew_path(length_mm), {.radius_mm = radius_mm, .spacing_mm = spacing_mm});
  fill_hu(volume, hu);
  return volume;
}

/// A pose from path-local numbers.
inline Pose pose_at(const PointVolume& volume, const Vec3& tip_path_mm, const Vec3& axis_path = Vec3::UnitZ()) {
  return volume.frame().to_patient(Pose{tip_path_mm, axis_path.normalized()});
}

/// Numbers in [low, high), one after the other.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * random_uniform(seed_, next_++); }
  std::uint64_t bits() { return mix_bits(mix_bits(seed_) ^ next_++); }
  /// In a box. Arguments of one call would be drawn in the compiler's order: the same seed, another test.
  Vec3 within(const Vec3& low, const Vec3& high) {
    Vec3 v;
    for (const int axis : {2, 1, 0}) v[axis] = (*this)(low[axis], high[axis]);
    return v;
  }
  Vec3 direction() {
    Vec3 v;
    do {
      v = within(Vec3::Constant(-1.0), Vec3::Constant(1.0));
    } while (v.norm() > 1.0 || v.norm() < 0.1);
    return v.normalized();
  }
  Pose pose() { return {within(Vec3::Constant(-20.0), Vec3::Constant(20.0)), direction()}; }

 private:
  std::uint64_t seed_;
  std::uint64_t next_ = 0;
};

/// An operator without purpose: the tip is drawn towards a place that jumps now and then, in, beside and outside the
/// volume; the axis leans up to 40 degrees.
class RandomOperator {
 public:
  RandomOperator(std::uint64_t seed, double length_mm, double reach_mm)
      : draw_(seed), length_mm_(length_mm), reach_mm_(reach_mm), tip_mm_(0.0, 0.0, -0.5) {}

  Pose next(const PointVolume& volume) {
    if (step_++ % 25 == 0) {
      const double angle = draw_(0.0, 2.0 * std::numbers::pi);
      const double off_mm = draw_(0.0, 1.5 * reach_mm_);
      goal_mm_ = Vec3(off_mm * std::cos(angle), off_mm * std::sin(angle), draw_(-0.5 * length_mm_, 1.3 * length_mm_));
      tilt_goal_ = draw_(0.0, 40.0) * std::numbers::pi / 180.0;
      lean_ = draw_(0.0, 2.0 * std::numbers::pi);
    }
    tip_mm_ += draw_(0.0, 0.2) * (goal_mm_ - tip_mm_);
    tilt_ += 0.1 * (tilt_goal_ - tilt_);
    return pose_at(volume, tip_mm_,
                   Vec3(std::sin(tilt_) * std::cos(lean_), std::sin(tilt_) * std::sin(lean_), std::cos(tilt_)));
  }

 private:
  Draw draw_;
  double length_mm_, reach_mm_;
  Vec3 tip_mm_;
  Vec3 goal_mm_ = Vec3::Zero();
  double tilt_ = 0.0, tilt_goal_ = 0.0, lean_ = 0.0;
  int step_ = 0;
};

}  // namespace spinaltap::test
