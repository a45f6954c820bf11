#pragma once

#include <optional>

#include "core/phantom/detail/vertebra_parts.h"

namespace spinaltap::shapes {

/// The whole vertebra in its own frame: parts joined by smooth minima, less the canal.
class VertebraShape {
 public:
  VertebraShape() = default;
  explicit VertebraShape(const VertebraAnatomy& anatomy);

  /// Negative inside, at most 1 mm per mm, zero on the surface.
  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> side{magnitude(p.x), p.y, p.z};
    T f = pruned(body_, p);
    if (right_pedicle_) {
      join(f, pedicle_, p);
      join(f, *right_pedicle_, Point<T>{p.x * -1.0, p.y, p.z});
    } else {
      join(f, pedicle_, side);
    }
    join(f, lamina_, Point<T>{soft_magnitude(p.x, kLaminaRidge), p.y, p.z});
    join(f, pars_, side);
    join(f, inferior_, side);
    join(f, superior_, side);
    join(f, mammillary_, side);
    join(f, transverse_, side);
    join(f, spinous_, p);
    if (value_of(p.y) > canal_start_) f = smooth_max(f, -canal_(p), canal_blend_);
    return f;
  }

  const PedicleShape& left_pedicle() const { return pedicle_.shape; }
  /// Mirrored to the left, as all that is given for the right side.
  const PedicleShape& right_pedicle() const { return right_pedicle_ ? right_pedicle_->shape : pedicle_.shape; }
  /// Holds the surface, fillets included.
  const Box3& bounds() const { return bounds_; }

 private:
  static constexpr double kLaminaRidge = 1.5;

  /// A shape, the ball that holds it with room to spare, and the reach of its fillet. The part's value is the larger
  /// one of the shape's and the ball's, so that leaving the shape out where its ball is far changes nothing.
  template <class Shape>
  struct Part {
    Shape shape;
    Vec3 centre = Vec3::Zero();
    double radius = 0.0;
    double reach = 0.0;
  };

  template <class Shape>
  Part<Shape> make_part(const Shape& shape, double reach, bool mirrored);

  template <class Shape, class T>
  static T ball(const Part<Shape>& part, const Point<T>& p) {
    const Point<T> q = minus(p, part.centre);
    return root(q.x * q.x + q.y * q.y + q.z * q.z) - part.radius;
  }

  template <class Shape, class T>
  static T pruned(const Part<Shape>& part, const Point<T>& p) {
    const T bound = ball(part, p);
    const T value = part.shape(p);
    return value_of(value) > value_of(bound) ? value : bound;
  }

  template <class Shape, class T>
  static void join(T& f, const Part<Shape>& part, const Point<T>& p) {
    const double dx = value_of(p.x) - part.centre.x(), dy = value_of(p.y) - part.centre.y(),
                 dz = value_of(p.z) - part.centre.z();
    const double far = value_of(f) + part.reach + part.radius;
    if (far <= 0.0 || dx * dx + dy * dy + dz * dz >= far * far) return;
    f = smooth_min(f, pruned(part, p), part.reach);
  }

  Part<BodyShape> body_;
  Part<PedicleShape> pedicle_;                       ///< both, or the left one
  std::optional<Part<PedicleShape>> right_pedicle_;  ///< where it differs; mirrored to the left
  Part<RoundPlate> lamina_;
  Part<FlatBar> pars_, inferior_, transverse_;
  Part<SuperiorArticularShape> superior_;
  Part<BallShape> mammillary_;
  Part<SpinousShape> spinous_;
  CanalShape canal_;
  double canal_start_ = 0.0, canal_blend_ = 1.0;
  Box3 bounds_;
};

}  // namespace spinaltap::shapes
