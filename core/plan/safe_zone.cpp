#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/plan/suggest.h"

namespace spinaltap {
namespace {

/// How large an error may be: the last that does no harm before the first that does, to within `most` / 1000.
template <class Harms>
double most_harmless(double most, const Harms& harms) {
  constexpr int kSteps = 12;
  double harmless = 0.0;
  double harmful = most;
  for (int step = 1; step <= kSteps; ++step) {
    const double error = most * step / kSteps;
    if (harms(error)) {
      harmful = error;
      break;
    }
    harmless = error;
  }
  while (harmful - harmless > 1e-3 * most) {
    const double middle = 0.5 * (harmless + harmful);
    (harms(middle) ? harmful : harmless) = middle;
  }
  return harmless;
}

}  // namespace

SafeZone safe_zone(const WallDistance& walls, const DrillPath& path) {
  constexpr double kMostMm = 8.0;
  constexpr double kMostDeg = 24.0;
  // Rings of the screw half a millimetre apart: a wall is met at most that late.
  const GradeOptions coarse{.step_mm = 0.5};
  const auto breaches = [&](const DrillPath& other) { return breach_mm(walls, other, coarse) > 0.0; };
  if (breaches(path)) return {};
  const Landmarks& marks = walls.landmarks();
  const Vec3 direction = path.direction();
  const double side = marks.to_own(path.entry_mm).x() > 0.0 ? 1.0 : -1.0;
  const Vec3 medial = (Mat3::Identity() - direction * direction.transpose()) * (-side * marks.left());
  const Vec3 medial_unit = medial.normalized();
  Vec3 cranial = direction.cross(medial_unit);
  if (cranial.dot(marks.superior()) < 0.0) cranial = -cranial;
  const auto shift_mm = [&](const Vec3& to) {
    return most_harmless(kMostMm, [&](double mm) {
      DrillPath other = path;
      other.entry_mm += mm * to;
      other.target_mm += mm * to;
      return breaches(other);
    });
  };
  const auto turn_deg = [&](const Vec3& to) {
    return most_harmless(kMostDeg, [&](double degrees) {
      DrillPath other = path;
      const double angle = degrees * kDegree;
      other.target_mm = path.entry_mm + path.length_mm() * (std::cos(angle) * direction + std::sin(angle) * to);
      return breaches(other);
    });
  };
  SafeZone zone;
  const std::array<std::pair<double*, Vec3>, 4> shifts{{{&zone.medial_mm, medial_unit},
                                                        {&zone.lateral_mm, -medial_unit},
                                                        {&zone.cranial_mm, cranial},
                                                        {&zone.caudal_mm, -cranial}}};
  const std::array<double*, 4> turns{&zone.medial_deg, &zone.lateral_deg, &zone.cranial_deg, &zone.caudal_deg};
  tbb::parallel_for(std::size_t{0}, 2 * shifts.size(), [&](std::size_t n) {
    const auto& [shift, to] = shifts[n / 2];
    (n % 2 == 0 ? *shift : *turns[n / 2]) = n % 2 == 0 ? shift_mm(to) : turn_deg(to);
  });
  return zone;
}

}  // namespace spinaltap
