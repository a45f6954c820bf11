#pragma once

#include <span>
#include <vector>

#include "core/base/scalar_field.h"

namespace spinaltap::detail {

/// A field's zero set as a place to put vertices on. Evaluates in parallel; every result depends on its own point only.
class ZeroSet {
 public:
  explicit ZeroSet(const ScalarField& field) : field_(field) {}

  struct Place {
    Vec3 position_mm = Vec3::Zero();
    Vec3 normal = Vec3::Zero();  ///< unit, outward
    double distance_mm = 0.0;    ///< that is left, to first order, signed
    bool found = false;          ///< false where the field is flat, or the way would be longer than allowed
  };

  /// The points drawn onto the zero set along the gradient by Newton's method, each by at most `reach_mm`.
  void project(std::span<const Vec3> points_mm, std::span<const double> reach_mm, std::span<Place> places) const;

  /// Distance (mm, to first order, signed) of points from the zero set.
  std::vector<double> distances_mm(std::span<const Vec3> points_mm) const;

 private:
  const ScalarField& field_;
};

}  // namespace spinaltap::detail
