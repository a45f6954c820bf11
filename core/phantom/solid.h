#pragma once

#include "core/base/scalar_field.h"

namespace spinaltap {

/// A closed body whose surface and CT numbers are known: the ground truth that a virtual scanner images.
///
/// evaluate() gives a signed distance (mm): its zero set is the surface; near it (2 mm) it is the distance to first
/// order, and everywhere it changes by at most 1 mm per mm, so that |value| bounds the way to the surface from below.
class Solid : public ScalarField {
 public:
  /// Holds the whole surface, patient LPS, mm.
  virtual Box3 bounds_mm() const = 0;

  /// CT number (HU) of the body's own material at p, where `distance_mm` is evaluate()'s value there. Edges between the
  /// body's own layers are averaged over `aperture_mm`. Outside the body: the outermost layer's number.
  virtual double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const = 0;
};

}  // namespace spinaltap
