#include "core/grading/path_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/grading/detail/other_readings.h"
#include "core/tool/bit_shape.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kAxisStepMm = 0.1;
constexpr std::size_t kMostNamed = 2;  // readings that fit and are as common: more say nothing

/// What a path is to the bone.
struct Lie {
  bool meets = false;         ///< some place of its axis is in the bone
  double entry_off_mm = 0.0;  ///< from the surface, without sign; infinite: further than was looked
  bool entry_is_inside = false;
  bool target_is_inside = false;
  bool is_from_front = false;
};

double sampled_mm(const PathCheckBone& bone, const Vec3& p_mm) {
  float distance_mm = 0.0F;
  bone.distance({&p_mm, 1}, {&distance_mm, 1});
  return distance_mm;
}

/// From a place to the nearest place on the other side of the surface: within the band the sampler knows it; beyond,
/// balls of twice the radius each are looked through on a lattice, and the way to the nearest find is halved. Right to
/// some 3 % and the lattice's step of a sixteenth of the ball's width. Infinite where there is none within `reach_mm`.
double off_surface_mm(const PathCheckBone& bone, const Vec3& p_mm, double value_mm, double reach_mm) {
  constexpr double kWithinBand = 0.8;  // of it the clamped grid still interpolates distances
  if (std::abs(value_mm) < kWithinBand * bone.band_mm) return std::abs(value_mm);
  const bool is_inside = value_mm < 0.0;
  constexpr int kSteps = 8;
  std::vector<Vec3> offsets;
  for (int k = -kSteps; k <= kSteps; ++k) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      for (int i = -kSteps; i <= kSteps; ++i) {
        if (i * i + j * j + k * k <= kSteps * kSteps) offsets.emplace_back(i, j, k);
      }
    }
  }
  std::ranges::stable_sort(offsets, {}, [](const Vec3& offset) { return offset.squaredNorm(); });
  std::vector<Vec3> places(offsets.size());
  std::vector<float> values(offsets.size());
  for (double radius_mm = 1.0; radius_mm <= reach_mm; radius_mm *= 2.0) {
    for (std::size_t n = 0; n < places.size(); ++n) places[n] = p_mm + radius_mm / kSteps * offsets[n];
    bone.distance(places, values);
    const auto other = std::ranges::find_if(values, [&](float value) { return (value < 0.0F) != is_inside; });
    if (other == values.end()) continue;
    double near = 0.0, far = 1.0;
    const Vec3 way_mm = places[static_cast<std::size_t>(other - values.begin())] - p_mm;
    for (int n = 0; n < 20; ++n) {
      const double middle = 0.5 * (near + far);
      ((sampled_mm(bone, p_mm + middle * way_mm) < 0.0) == is_inside ? near : far) = middle;
    }
    return far * way_mm.norm();
  }
  return std::numeric_limits<double>::infinity();
}

bool meets(const DrillPath& path, const PathCheckBone& bone) {
  std::vector<Vec3> places_mm;
  if (path.is_curved()) {
    places_mm = PathCurve(path).places_mm(kAxisStepMm);
  } else {
    const int steps = static_cast<int>(std::ceil(path.chord_mm() / kAxisStepMm));
    for (int n = 0; n <= steps; ++n) places_mm.push_back(path.entry_mm + (path.target_mm - path.entry_mm) * n / steps);
  }
  std::vector<float> values(places_mm.size());
  bone.distance(places_mm, values);
  return std::ranges::any_of(values, [](float value) { return value < 0.0F; });
}

/// Whether the path enters the vertebra from its front and goes backward. The landmarks take seconds to find: paths
/// that go forward in the patient do not ask for them.
bool is_from_front(const DrillPath& path, const PathCheckBone& bone) {
  constexpr double kTiltedMost = 0.2, kBackward = 0.5;  // sines: of a vertebra's tilt, and of 30 degrees
  if (!bone.landmarks || path.bit.is_plate() || !(path.direction().y() > kTiltedMost)) return false;
  const Landmarks* marks = bone.landmarks();
  return marks != nullptr && path.direction().dot(marks->posterior()) > kBackward &&
         (path.entry_mm - marks->origin_mm).dot(marks->posterior()) < 0.0;
}

double tolerance_mm(const DrillPath& path, const PathCheckOptions& options) {
  return options.tolerance_mm + (traits_of(path.bit.shape).cuts_beside_path ? path.bit.radius_mm() : 0.0);
}

Lie lie_of(const DrillPath& path, const PathCheckBone& bone, const PathCheckOptions& options, double reach_mm) {
  Lie lie;
  const double entry_mm = sampled_mm(bone, path.entry_mm);
  lie.entry_is_inside = entry_mm < 0.0;
  lie.target_is_inside = sampled_mm(bone, path.target_mm) < 0.0;
  lie.meets = meets(path, bone);
  lie.entry_off_mm = off_surface_mm(bone, path.entry_mm, entry_mm, reach_mm);
  lie.is_from_front = !options.from_the_front && is_from_front(path, bone);
  return lie;
}

bool fits(const Lie& lie, double within_mm) { return lie.meets && lie.entry_off_mm <= within_mm && !lie.is_from_front; }

/// Whether another reading makes a path of the library's lengths that fits, and ends in the bone as plans do.
bool fits_well(const DrillPath& path, const PathCheckBone& bone, const PathCheckOptions& options) {
  constexpr double kShortestMm = 5.0, kLongestMm = 200.0;
  if (!(path.chord_mm() >= kShortestMm && path.chord_mm() <= kLongestMm)) return false;
  const double within_mm = tolerance_mm(path, options);
  const Box3 near_mm(bone.bounds_mm.min() - Vec3::Constant(within_mm),
                     bone.bounds_mm.max() + Vec3::Constant(within_mm));
  if (!near_mm.contains(path.entry_mm)) return false;  // most readings end here
  const Lie lie = lie_of(path, bone, options, 2.0 * within_mm);
  return fits(lie, within_mm) && lie.target_is_inside;
}

std::string likely_cause(const DrillPath& path, const PathCheckBone& bone, const PathCheckOptions& options) {
  const std::vector<PathReading> readings = other_readings(path);
  for (auto from = readings.begin(); from != readings.end();) {
    const auto to = std::find_if(from, readings.end(), [&](const PathReading& r) { return r.rank != from->rank; });
    std::vector<const PathReading*> fitting;
    for (auto reading = from; reading != to; ++reading) {
      if (fits_well(reading->path, bone, options)) fitting.push_back(&*reading);
    }
    std::string words;
    for (const PathReading* reading : fitting) words += (words.empty() ? "" : ", or if ") + reading->words;
    if (fitting.size() <= kMostNamed && !words.empty()) return words;
    if (!fitting.empty()) return {};
    from = to;
  }
  return {};
}

std::string number(double value) {
  TextWriter text(value < 10.0 ? 2 : 3);
  text << value;
  return text.str();
}

std::string place(const Vec3& p_mm) {
  TextWriter text(4);
  text << '(' << p_mm.x() << ", " << p_mm.y() << ", " << p_mm.z() << ')';
  return text.str();
}

}  // namespace

std::string PathCheck::words(const DrillPath& path) const {
  std::string text = "path " + in_quotes(path.name) + ": ";
  for (std::size_t n = 0; n < faults.size(); ++n) text += (n == 0 ? "" : "; ") + faults[n];
  if (!likely_cause.empty()) text += "; it fits if " + likely_cause;
  return text;
}

PathCheck check_path_on_bone(const DrillPath& path, const PathCheckBone& bone, const PathCheckOptions& options) {
  constexpr double kReachMm = 32.0;
  const double within_mm = tolerance_mm(path, options);
  const Lie lie = lie_of(path, bone, options, kReachMm);
  PathCheck check;
  if (fits(lie, within_mm)) return check;
  const double to_box_mm = bone.bounds_mm.exteriorDistance(path.entry_mm);
  if (!lie.meets) {
    check.faults.push_back("it misses the bone: it runs from " + place(path.entry_mm) + " to " + place(path.target_mm) +
                           ", the bone lies within " + place(bone.bounds_mm.min()) + " and " +
                           place(bone.bounds_mm.max()) + " mm");
  }
  if (lie.entry_off_mm > within_mm && lie.entry_is_inside) {
    check.faults.push_back("its entry lies inside the bone, " + number(lie.entry_off_mm) + " mm deep" +
                           (lie.target_is_inside ? "" : ", and its target outside: it leads out of the bone"));
  } else if (lie.entry_off_mm > within_mm) {
    const bool is_known = std::isfinite(lie.entry_off_mm);
    check.faults.push_back("its entry lies " + number(is_known ? lie.entry_off_mm : to_box_mm) +
                           (is_known ? " mm off the bone's surface" : " mm off the box around the bone"));
  }
  if (lie.is_from_front) check.faults.push_back("it enters the vertebra from its front and leads backward");
  check.likely_cause = likely_cause(path, bone, options);
  if (check.likely_cause.empty() && !lie.meets && to_box_mm > within_mm) {
    check.faults.push_back("it is of another level, another frame or another patient");
  }
  return check;
}

}  // namespace spinaltap
