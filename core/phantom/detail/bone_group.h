#pragma once

#include <vector>

#include "core/phantom/detail/shapes.h"

namespace spinaltap::shapes {

/// Bars of elliptic section and plates, joined by smooth minima: a bone that needs no more than to look like one.
class BoneGroup {
 public:
  /// `reach`: of the fillets, mm. `is_paired`: each piece stands for itself and its mirror image at x = 0.
  BoneGroup(const std::vector<FlatBar>& bars, const std::vector<RoundPlate>& plates, double reach, bool is_paired);

  template <class T>
  T operator()(const Point<T>& p_own) const {
    const Point<T> p = is_paired_ ? Point<T>{soft_magnitude(p_own.x, kCrease), p_own.y, p_own.z} : p_own;
    // A piece whose ball is far changes nothing: each counts as the larger one of its own value and its ball's.
    T f = bars_.empty() ? pruned(plates_.front(), p) : pruned(bars_.front(), p);
    for (std::size_t n = 1; n < bars_.size(); ++n) join(f, bars_[n], p);
    for (std::size_t n = bars_.empty() ? 1 : 0; n < plates_.size(); ++n) join(f, plates_[n], p);
    return f;
  }

  const Box3& bounds() const { return bounds_; }

 private:
  static constexpr double kCrease = 0.8;

  template <class Shape>
  struct Piece {
    Shape shape;
    Vec3 centre;
    double radius;
  };

  template <class Shape>
  Piece<Shape> make_piece(const Shape& shape);

  template <class Shape, class T>
  static T pruned(const Piece<Shape>& piece, const Point<T>& p) {
    const Point<T> q = minus(p, piece.centre);
    const T ball = root(q.x * q.x + q.y * q.y + q.z * q.z) - piece.radius;
    const T value = piece.shape(p);
    return value_of(value) > value_of(ball) ? value : ball;
  }

  template <class Shape, class T>
  void join(T& f, const Piece<Shape>& piece, const Point<T>& p) const {
    const double dx = value_of(p.x) - piece.centre.x(), dy = value_of(p.y) - piece.centre.y(),
                 dz = value_of(p.z) - piece.centre.z();
    const double far = value_of(f) + reach_ + piece.radius;
    if (far <= 0.0 || dx * dx + dy * dy + dz * dz >= far * far) return;
    f = smooth_min(f, pruned(piece, p), reach_);
  }

  std::vector<Piece<FlatBar>> bars_;
  std::vector<Piece<RoundPlate>> plates_;
  double reach_;
  bool is_paired_;
  Box3 bounds_;
};

/// A row of bars through points, as thick at each as given.
struct BarKnot {
  Vec3 place_mm;
  double thickness_mm;
};
void add_bars(std::vector<FlatBar>& bars, const std::vector<BarKnot>& knots, const Vec3& thin_direction,
              double width_over_thickness);

}  // namespace spinaltap::shapes
