#include "core/plan/suggest.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "core/plan/detail/trajectory_search.h"

namespace spinaltap {
namespace {

void check_options(std::span<const PedicleScrew> screws, const SuggestOptions& options) {
  if (screws.empty()) fail("suggesting paths: expected one screw or more");
  for (const PedicleScrew& screw : screws) check_screw(screw);
  check_bit(options.bit);
  const auto within = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("suggesting paths: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  within(options.margin_mm, 0.0, 5.0, "a margin around the screw (mm)");
  within(options.front_margin_mm, 0.0, 30.0, "a margin ahead of the tip (mm)");
  within(options.widest_share, 0.1, 1.0, "a share of the pedicle's width");
  within(options.furthest_share, 0.2, 1.0, "a share of the body's depth");
  within(options.max_turn_deg, 0.0, 45.0, "a turn from the pedicle's axis (degrees)");
  const SuggestWeights& weights = options.weights;
  for (const double weight : {weights.length, weights.diameter, weights.clearance, weights.canal, weights.endplates,
                              weights.density, weights.along_axis}) {
    within(weight, 0.0, 100.0, "weights");
  }
}

Suggestion suggest_side(const WallDistance& walls, const HuSampler& hu, const Material& material,
                        std::span<const PedicleScrew> screws, const SuggestOptions& options, double side,
                        const Progress& progress) {
  constexpr std::size_t kMaxRefined = 6;
  Suggestion suggestion;
  suggestion.side = side > 0.0 ? "left" : "right";
  detail::TrajectorySearch search(walls, hu, screws, options, side);
  const std::vector<detail::ScrewCandidate> ways = search.find(kMaxRefined, progress);
  for (const detail::ScrewCandidate& way : ways) {
    SuggestedPath best;
    best.path = way.path;
    best.grade = grade_path(walls, hu, material, way.path, options.grade);
    if (best.grade.grade != Grade::A) continue;
    best.safe = safe_zone(walls, way.path);
    best.score = way.score;
    best.angles = path_angles(way.path.direction(), walls.landmarks().axes, side > 0.0);
    best.trajectories_tried = search.trajectories_tried();
    suggestion.best = best;
    return suggestion;
  }
  std::ostringstream why;
  why.precision(3);
  why << "no screw of the table keeps " << options.margin_mm << " mm of bone around it on any straight trajectory of "
      << search.trajectories_tried() << " through the " << suggestion.side << " pedicle, which is "
      << search.pedicle().width_mm << " mm wide";
  suggestion.rejection = why.str();
  return suggestion;
}

/// How large an error may be: the last that does no harm before the first that does, to within `max` / 1000.
template <class Harms>
double max_harmless(double max, const Harms& harms) {
  constexpr int kSteps = 12;
  double harmless = 0.0;
  double harmful = max;
  for (int step = 1; step <= kSteps; ++step) {
    const double error = max * step / kSteps;
    if (harms(error)) {
      harmful = error;
      break;
    }
    harmless = error;
  }
  while (harmful - harmless > 1e-3 * max) {
    const double middle = 0.5 * (harmless + harmful);
    (harms(middle) ? harmful : harmless) = middle;
  }
  return harmless;
}

}  // namespace

std::vector<Suggestion> suggest_paths(const WallDistance& walls, const HuSampler& hu, const Material& material,
                                      std::span<const PedicleScrew> screws, const SuggestOptions& options,
                                      const Progress& progress) {
  check_options(screws, options);
  std::vector<Suggestion> sides(2);
  tbb::parallel_for(0, 2, [&](int n) {
    sides[static_cast<std::size_t>(n)] =
        suggest_side(walls, hu, material, screws, options, n == 0 ? 1.0 : -1.0, progress);
  });
  return sides;
}

SafeZone safe_zone(const WallDistance& walls, const DrillPath& path) {
  constexpr double kMaxMm = 8.0;
  constexpr double kMaxDeg = 24.0;
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
    return max_harmless(kMaxMm, [&](double mm) {
      DrillPath other = path;
      other.entry_mm += mm * to;
      other.target_mm += mm * to;
      return breaches(other);
    });
  };
  const auto turn_deg = [&](const Vec3& to) {
    return max_harmless(kMaxDeg, [&](double degrees) {
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
