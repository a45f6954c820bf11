#pragma once

#include <vector>

#include "core/phantom/detail/shapes.h"
#include "core/phantom/spine_curve.h"
#include "core/phantom/vertebra_anatomy.h"

namespace spinaltap {

/// Axis of the left rib of a thoracic level, from its head to where it is cut off, in the frame of its vertebra: the
/// head beside the disc above (T1, T11, T12: beside the body), the tubercle in front of the tip of the transverse
/// process (T11, T12: none), then round the side. `length_mm` bounds it, measured along the axis; `disc_above_mm` is
/// the height of the disc above. `number`: 1 to 12.
std::vector<Vec3> rib_axis(int number, const LevelMeasures& measures, const VertebraAnatomy& anatomy,
                           double disc_above_mm, double length_mm);

namespace shapes {

/// A rib around its axis: bars of elliptic section, one after the other, flat along the chest's wall.
class RibShape {
 public:
  RibShape(const std::vector<Vec3>& axis_mm, int number, double scale);

  template <class T>
  T operator()(const Point<T>& p) const {
    // A bar whose ball is far changes nothing: each counts as the larger one of its own value and its ball's.
    T f = pruned(bars_.front(), p);
    for (std::size_t n = 1; n < bars_.size(); ++n) {
      const Bar& bar = bars_[n];
      const Point<T> q = minus(p, bar.centre);
      const double far = value_of(f) + kReach + bar.radius;
      const double distance2 =
          value_of(q.x) * value_of(q.x) + value_of(q.y) * value_of(q.y) + value_of(q.z) * value_of(q.z);
      if (far <= 0.0 || distance2 >= far * far) continue;
      f = smooth_min(f, pruned(bar, p), kReach);
    }
    return f;
  }

  const Box3& bounds() const { return bounds_; }

 private:
  static constexpr double kReach = 1.0;

  struct Bar {
    FlatBar shape;
    Vec3 centre;
    double radius;
  };

  template <class T>
  static T pruned(const Bar& bar, const Point<T>& p) {
    const Point<T> q = minus(p, bar.centre);
    const T ball = root(q.x * q.x + q.y * q.y + q.z * q.z) - bar.radius;
    const T value = bar.shape(p);
    return value_of(value) > value_of(ball) ? value : ball;
  }

  std::vector<Bar> bars_;
  Box3 bounds_;
};

}  // namespace shapes
}  // namespace spinaltap
