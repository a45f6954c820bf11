#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "core/phantom/vertebra.h"

namespace spinaltap::test {

/// The phantom's true surface around a line.
struct TruePlaces {
  std::vector<Vec3> places_mm, normals;
};

/// The places of `seeds_mm` (surface_seeds()) within `within_mm` of a line, brought onto the surface.
inline TruePlaces true_places(const Vertebra& vertebra, const std::vector<Vec3>& seeds_mm, const Vec3& from_mm,
                              const Vec3& to_mm, double within_mm) {
  std::vector<Vec3> places_mm;
  const Vec3 way_mm = to_mm - from_mm;
  for (const Vec3& seed_mm : seeds_mm) {
    const double share = std::clamp((seed_mm - from_mm).dot(way_mm) / way_mm.squaredNorm(), 0.0, 1.0);
    if ((from_mm + share * way_mm - seed_mm).norm() < within_mm) places_mm.push_back(seed_mm);
  }
  std::vector<Vec3> normals(places_mm.size());
  tbb::parallel_for(std::size_t{0}, places_mm.size(), [&](std::size_t n) {
    double value_mm = 0.0;
    vertebra.evaluate({&places_mm[n], 1}, {&value_mm, 1}, {&normals[n], 1});
    places_mm[n] -= value_mm / normals[n].squaredNorm() * normals[n];
    for (int round = 0; round < 2; ++round) {  // the slope hardly changes in 0.15 mm
      vertebra.evaluate({&places_mm[n], 1}, {&value_mm, 1}, {});
      places_mm[n] -= value_mm / normals[n].squaredNorm() * normals[n];
    }
    normals[n].normalize();
  });
  return {places_mm, normals};
}

}  // namespace spinaltap::test
