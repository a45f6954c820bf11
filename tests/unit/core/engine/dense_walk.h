#pragma once

#include <algorithm>
#include <cmath>

#include "core/tool/bit_profile.h"

namespace spinaltap::test {

/// Where a bit is at share t of its way: the tip goes straight, the axis turns evenly.
inline Pose pose_on_way(const Pose& from, const Pose& to, double t) {
  const Vec3 tip_mm = from.tip_mm + t * (to.tip_mm - from.tip_mm);
  const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * (to.axis - from.axis).norm()));
  // Even and straight turning differ by an eighth of the angle's cube: nothing below 1e-6.
  const Vec3 axis = angle < 1e-6 ? Vec3((1.0 - t) * from.axis + t * to.axis)
                                 : Vec3(std::sin((1.0 - t) * angle) * from.axis + std::sin(t * angle) * to.axis);
  return {tip_mm, axis.normalized()};
}

/// The least signed distance (mm) of p from the bit on its way, or the first below 0. Poses are so dense that the bit's
/// surface moves by no more than `finest_mm` near p between two of them: nowhere on the way is p nearer by more than
/// half of that. Steps are as long as the distance allows, which changes no faster than p moves as seen from the bit;
/// else 1 um steps over whole volumes would take hours. Around the nearest pose the least is then sought by thirds.
inline double min_distance_mm(const BitProfile& bit, const Pose& from, const Pose& to, const Vec3& p,
                              double finest_mm) {
  const double way_mm = (to.tip_mm - from.tip_mm).norm();
  const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * (to.axis - from.axis).norm()));
  const double speed_mm = way_mm + angle * ((p - from.tip_mm).norm() + way_mm);
  const auto distance_mm = [&](double t) { return bit_distance_mm(bit, pose_on_way(from, to, t), p); };
  double min_mm = bit_distance_mm(bit, to, p);
  if (!(speed_mm > 0.0)) return min_mm;
  double nearest = 1.0;
  for (double t = 0.0; t < 1.0 && min_mm >= 0.0;) {
    const double here_mm = distance_mm(t);
    if (here_mm < min_mm) {
      min_mm = here_mm;
      nearest = t;
    }
    t += std::max(here_mm, finest_mm) / speed_mm;
  }
  if (min_mm < 0.0 || min_mm > 10.0 * finest_mm) return min_mm;
  const double window = std::max(min_mm, finest_mm) / speed_mm;
  double low = std::max(0.0, nearest - window);
  double high = std::min(1.0, nearest + window);
  for (int n = 0; n < 50; ++n) {
    const double a = low + (high - low) / 3.0;
    const double b = high - (high - low) / 3.0;
    (distance_mm(a) < distance_mm(b) ? high : low) = distance_mm(a) < distance_mm(b) ? b : a;
  }
  return std::min(min_mm, distance_mm(0.5 * (low + high)));
}

}  // namespace spinaltap::test
