#pragma once

#include "core/phantom/detail/shapes.h"
#include "core/phantom/level_measures.h"

namespace spinaltap::shapes {

/// A simple sacrum in the frame of its first segment's body: a wedge that bends backward, wings to both sides, two
/// superior articular processes, a back wall with a crest behind the canal.
class SacrumShape {
 public:
  /// `measures`: of the first segment, for its endplate, canal and facets.
  explicit SacrumShape(const LevelMeasures& measures);

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> side{soft_magnitude(p.x, 1.0), p.y, p.z};
    T f = smooth_min(body_(p), wing_(side), 6.0);
    f = smooth_min(f, lower_(p), 8.0);
    f = smooth_min(f, back_(side), 4.0);
    f = smooth_min(f, strut_(side), 3.0);
    f = smooth_min(f, process_(side), 3.0);
    return smooth_min(f, crest_(p), 3.0);
  }

  const Box3& bounds() const { return bounds_; }

 private:
  RoundPlate body_;
  FlatBar wing_, lower_, back_, strut_, process_, crest_;
  Box3 bounds_;
};

}  // namespace spinaltap::shapes
