#include "core/segment/spine_column.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/base/lerp.h"
#include "core/segment/detail/binned_ct.h"

namespace spinaltap {
namespace {

/// A point on the canal's curve with the directions there.
struct CanalPoint {
  Vec3 p_mm;
  Mat3 axes;  ///< left, back, up
};

Vec3 point_along(const std::vector<Vec3>& points, double at) {
  const double clamped = std::clamp(at, 0.0, static_cast<double>(points.size() - 1));
  const auto low = std::min(static_cast<std::size_t>(clamped), points.size() - 2);
  return points[low] + (clamped - static_cast<double>(low)) * (points[low + 1] - points[low]);
}

/// Adds points beyond the end of a curve that bend on as its last part does: bodies reach further than their part of
/// the canal.
void prolong(std::vector<Vec3>& points) {
  constexpr double kMoreMm = 26.0;
  constexpr int kPieces = 6;
  constexpr double kMaxBend = 25.0 * kDegree;  // over kMoreMm
  constexpr std::size_t kReach = 5;            // points that give a direction
  const std::size_t last = points.size() - 1;
  const std::size_t reach = std::min(kReach, last);
  Vec3 along = (points[last] - points[last - reach]).normalized();
  Eigen::AngleAxisd bend(0.0, Vec3::UnitX());
  if (last >= 4 * kReach) {
    // The bend over 25 mm, between pieces whose middles lie that far apart.
    const Vec3 before = (points[last - 2 * kReach] - points[last - 3 * kReach]).normalized();
    const double turn = std::min(angle_between_rad(before, along), kMaxBend);
    if (turn > 1e-6) bend = Eigen::AngleAxisd(turn / kPieces, before.cross(along).normalized());
  }
  for (int n = 0; n < kPieces; ++n) {
    along = bend * along;
    points.push_back(points.back() + kMoreMm / kPieces * along);
  }
}

std::vector<Vec3> prolonged(std::vector<Vec3> points) {
  prolong(points);
  std::reverse(points.begin(), points.end());
  prolong(points);
  std::reverse(points.begin(), points.end());
  return points;
}

/// The canal each SpineColumn::kStepMm of its length, with its direction over the length of a body.
std::vector<CanalPoint> even_points(const SpinalCanal& canal) {
  const std::vector<Vec3> points = prolonged(canal.points_mm);
  std::vector<double> length{0.0};
  for (std::size_t n = 1; n < points.size(); ++n) length.push_back(length.back() + (points[n] - points[n - 1]).norm());
  const auto place = [&](double s_mm) {
    const auto above = std::upper_bound(length.begin() + 1, length.end() - 1, s_mm);
    const auto n = static_cast<std::size_t>(above - length.begin()) - 1;
    const double t = (s_mm - length[n]) / (length[n + 1] - length[n]);
    return point_along(points, static_cast<double>(n) + std::clamp(t, 0.0, 1.0));
  };
  constexpr double kReachMm = 14.0;
  std::vector<CanalPoint> even;
  for (double s = 0.0; s <= length.back(); s += SpineColumn::kStepMm) {
    CanalPoint point;
    point.p_mm = place(s);
    const Vec3 up = (place(std::min(s + kReachMm, length.back())) - place(std::max(s - kReachMm, 0.0))).normalized();
    const Vec3 left = (Vec3::UnitX() - Vec3::UnitX().dot(up) * up).normalized();
    point.axes.col(0) = left;
    point.axes.col(1) = up.cross(left);
    point.axes.col(2) = up;
    even.push_back(point);
  }
  return even;
}

/// An ellipse as the search tries it, in the canal's frame.
struct Candidate {
  double turn_rad;  ///< of the body about the canal's axis
  double wall_mm;   ///< from the canal's centre to the body's back
  double half_width_mm, half_depth_mm;
};

std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  for (const double turn_deg : {-24.0, -12.0, 0.0, 12.0, 24.0}) {
    for (const double wall_mm : {5.0, 8.0, 11.0, 14.0}) {
      for (const double half_width_mm : {7.5, 9.0, 11.0, 13.0, 15.5, 18.5, 22.0, 26.0}) {
        for (const double proportion : {1.0, 1.2, 1.4, 1.65}) {
          all.push_back({turn_deg * kDegree, wall_mm, half_width_mm, half_width_mm / proportion});
        }
      }
    }
  }
  return all;
}

ColumnSection section_of(const CanalPoint& canal, const Candidate& candidate) {
  ColumnSection section;
  section.axes = canal.axes * Eigen::AngleAxisd(candidate.turn_rad, Vec3::UnitZ()).toRotationMatrix();
  section.half_width_mm = candidate.half_width_mm;
  section.half_depth_mm = candidate.half_depth_mm;
  section.centre_mm = canal.p_mm - (candidate.wall_mm + candidate.half_depth_mm) * section.axes.col(1);
  return section;
}

/// Directions around an ellipse in which a body has a wall, as (left, back): the front and the sides, and straight
/// back, towards the canal. Between them lie pedicles and the heads of ribs.
std::vector<Eigen::Vector2d> walled_directions() {
  std::vector<Eigen::Vector2d> directions;
  const auto add = [&](double from_front_deg) {
    directions.emplace_back(std::sin(from_front_deg * kDegree), -std::cos(from_front_deg * kDegree));
  };
  for (double turn = -90.0; turn <= 90.0; turn += 9.0) add(turn);
  for (double turn = 158.0; turn <= 202.1; turn += 5.5) add(turn);
  return directions;
}

/// Mean wall on an ellipse where a body has one.
double wall_of(const WallProbe& probe, const ColumnSection& section) {
  static const std::vector<Eigen::Vector2d> directions = walled_directions();
  double sum = 0.0;
  for (const Eigen::Vector2d& unit : directions) {
    const Vec3 p = section.centre_mm +
                   section.axes * Vec3(unit.x() * section.half_width_mm, unit.y() * section.half_depth_mm, 0.0);
    const Vec3 outward =
        (section.axes * Vec3(unit.x() / section.half_width_mm, unit.y() / section.half_depth_mm, 0.0)).normalized();
    sum += probe.edge(p, outward);
  }
  return sum / static_cast<double>(directions.size());
}

/// What it costs to go from one ellipse to another a step further along.
double change_cost(const Candidate& a, const Candidate& b) {
  const double width = std::log(a.half_width_mm / b.half_width_mm);
  const double depth = std::log(a.half_depth_mm / b.half_depth_mm);
  const double turn = (a.turn_rad - b.turn_rad) / (12.0 * kDegree);
  const double wall = (a.wall_mm - b.wall_mm) / 3.0;
  return 8.0 * width * width + 4.0 * depth * depth + 0.06 * turn * turn + 0.06 * wall * wall;
}

/// The mean of each value and its neighbours within `reach` along the column, for every candidate.
std::vector<float> averaged_along(const std::vector<float>& values, std::size_t kinds, int reach) {
  const auto nodes = static_cast<int>(values.size() / kinds);
  std::vector<float> result(values.size());
  tbb::parallel_for(0, nodes, [&](int n) {
    const int low = std::max(0, n - reach);
    const int high = std::min(nodes - 1, n + reach);
    for (std::size_t c = 0; c < kinds; ++c) {
      float sum = 0.0F;
      for (int m = low; m <= high; ++m) sum += values[static_cast<std::size_t>(m) * kinds + c];
      result[static_cast<std::size_t>(n) * kinds + c] = sum / static_cast<float>(high - low + 1);
    }
  });
  return result;
}

}  // namespace

ColumnSection SpineColumn::at(double s_mm) const {
  if (sections.empty()) fail("column of bodies: expected sections, found none");
  const double at = std::clamp(s_mm / kStepMm, 0.0, static_cast<double>(sections.size() - 1));
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, sections.size() - 1);
  const double t = at - static_cast<double>(low);
  const ColumnSection& a = sections[low];
  const ColumnSection& b = sections[high];
  ColumnSection mixed;
  mixed.centre_mm = (1.0 - t) * a.centre_mm + t * b.centre_mm;
  mixed.axes = Eigen::Quaterniond(a.axes).slerp(t, Eigen::Quaterniond(b.axes)).toRotationMatrix();
  mixed.half_width_mm = lerp(a.half_width_mm, b.half_width_mm, t);
  mixed.half_depth_mm = lerp(a.half_depth_mm, b.half_depth_mm, t);
  mixed.wall = lerp(a.wall, b.wall, t);
  return mixed;
}

FloatGrid hu_around_canal(const CtVolume& ct, const SpinalCanal& canal) {
  constexpr double kStepMm = 0.8;
  Box3 box;
  for (const Vec3& p : canal.points_mm) box.extend(p);
  // Bodies of any size, turned and tilted, and what lies around them.
  const Box3 reach(box.min() - Vec3(50.0, 75.0, 25.0), box.max() + Vec3(50.0, 15.0, 25.0));
  return bin_hu(ct, voxels_of(reach, ct.geometry), bins_for(ct.geometry, kStepMm));
}

SpineColumn fit_spine_column(const FloatGrid& smooth, const SpinalCanal& canal, const WallLevels& levels) {
  if (canal.points_mm.size() < 2) fail("column of bodies: expected a canal of at least two points");
  const std::vector<CanalPoint> along = even_points(canal);
  const std::vector<Candidate> kinds = candidates();
  const WallProbe probe(smooth, levels);
  std::vector<float> walls(along.size() * kinds.size());
  tbb::parallel_for(std::size_t{0}, along.size(), [&](std::size_t n) {
    for (std::size_t c = 0; c < kinds.size(); ++c) {
      walls[n * kinds.size() + c] = static_cast<float>(wall_of(probe, section_of(along[n], kinds[c])));
    }
  });
  constexpr int kReach = 4;  // 8 mm to each side: never a disc alone
  walls = averaged_along(walls, kinds.size(), kReach);

  // Of two ellipses with as much wall the wider is the whole body.
  constexpr double kSizePower = 0.2;
  const auto worth = [&](std::size_t n, std::size_t c) {
    const Candidate& kind = kinds[c];
    return static_cast<double>(walls[n * kinds.size() + c]) * std::pow(kind.half_width_mm / 16.0, kSizePower);
  };
  std::vector<double> change(kinds.size() * kinds.size());
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    for (std::size_t b = 0; b < kinds.size(); ++b) change[a * kinds.size() + b] = change_cost(kinds[a], kinds[b]);
  }
  std::vector<double> gain(kinds.size());
  std::vector<double> next(kinds.size());
  std::vector<std::uint16_t> from(along.size() * kinds.size(), 0);
  for (std::size_t c = 0; c < kinds.size(); ++c) gain[c] = worth(0, c);
  for (std::size_t n = 1; n < along.size(); ++n) {
    tbb::parallel_for(std::size_t{0}, kinds.size(), [&](std::size_t c) {
      double best = -std::numeric_limits<double>::infinity();
      for (std::size_t before = 0; before < kinds.size(); ++before) {
        const double total = gain[before] - change[c * kinds.size() + before];
        if (total <= best) continue;
        best = total;
        from[n * kinds.size() + c] = static_cast<std::uint16_t>(before);
      }
      next[c] = best + worth(n, c);
    });
    gain.swap(next);
  }
  auto chosen = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
  SpineColumn column;
  column.sections.resize(along.size());
  for (std::size_t n = along.size(); n-- > 0;) {
    column.sections[n] = section_of(along[n], kinds[chosen]);
    column.sections[n].wall = wall_of(probe, column.sections[n]);
    chosen = from[n * kinds.size() + chosen];
  }
  // The kinds are few: means over a body's height make the row smooth.
  constexpr int kEven = 5;
  const std::vector<ColumnSection> rough = column.sections;
  const int last = static_cast<int>(rough.size()) - 1;
  for (int n = 0; n <= last; ++n) {
    const int reach = std::min({kEven, n, last - n});
    ColumnSection& section = column.sections[static_cast<std::size_t>(n)];
    section.centre_mm.setZero();
    section.half_width_mm = section.half_depth_mm = 0.0;
    for (int m = n - reach; m <= n + reach; ++m) {
      const ColumnSection& other = rough[static_cast<std::size_t>(m)];
      section.centre_mm += other.centre_mm / (2.0 * reach + 1.0);
      section.half_width_mm += other.half_width_mm / (2.0 * reach + 1.0);
      section.half_depth_mm += other.half_depth_mm / (2.0 * reach + 1.0);
    }
    // The canal lies behind the body's middle, in a scoliotic spine too.
    const Vec3 up = section.axes.col(2);
    const Vec3 back = along[static_cast<std::size_t>(n)].p_mm - section.centre_mm;
    section.axes.col(1) = (back - back.dot(up) * up).normalized();
    section.axes.col(0) = section.axes.col(1).cross(up);
  }
  return column;
}

SpineColumn column_through(const std::vector<BodyCylinder>& bodies, double beyond_mm, const WallProbe& probe) {
  if (bodies.size() < 2) fail("column of bodies: expected two bodies and more, found ", bodies.size());
  std::vector<ColumnSection> dense;
  const auto add = [&](const Vec3& p_mm, const Mat3& axes, const Vec3& half_mm) {
    dense.push_back({.centre_mm = p_mm, .axes = axes, .half_width_mm = half_mm.x(), .half_depth_mm = half_mm.y()});
  };
  constexpr double kStepMm = 0.5;
  // Beyond the ends the column goes on along an arc.
  const auto prolong_from = [&](const BodyCylinder& last, const BodyCylinder& before, double sign) {
    constexpr double kMaxBendPerMm = kDegree;
    const Vec3 along = sign * last.axes().col(2);
    const Vec3 from = sign * before.axes().col(2);
    const double turn_per_mm = std::min(
        angle_between_rad(from, along) / std::max(1.0, (last.centre_mm - before.centre_mm).norm()), kMaxBendPerMm);
    const Vec3 about = turn_per_mm > 1e-6 ? Vec3(from.cross(along).normalized()) : Vec3::UnitX();
    const Eigen::AngleAxisd bend(kStepMm * turn_per_mm, about);
    Vec3 p_mm = last.centre_mm;
    Mat3 axes = last.axes();
    for (double s_mm = kStepMm; s_mm <= beyond_mm; s_mm += kStepMm) {
      axes = bend * axes;
      p_mm += kStepMm * sign * axes.col(2);
      add(p_mm, axes, last.half_mm);
    }
  };
  prolong_from(bodies[0], bodies[1], -1.0);
  std::reverse(dense.begin(), dense.end());
  for (std::size_t n = 0; n + 1 < bodies.size(); ++n) {
    // Cubic Hermite curve from middle to middle.
    const BodyCylinder& a = bodies[n];
    const BodyCylinder& b = bodies[n + 1];
    const double length_mm = (b.centre_mm - a.centre_mm).norm();
    const auto steps = std::max(1, static_cast<int>(std::ceil(length_mm / kStepMm)));
    const Eigen::Quaterniond from(a.axes());
    for (int i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double u = 1.0 - t;
      const Vec3 p_mm = u * u * (1.0 + 2.0 * t) * a.centre_mm + t * t * (3.0 - 2.0 * t) * b.centre_mm +
                        length_mm * (t * u * u * a.axes().col(2) - t * t * u * b.axes().col(2));
      add(p_mm, from.slerp(t, Eigen::Quaterniond(b.axes())).toRotationMatrix(), u * a.half_mm + t * b.half_mm);
    }
  }
  add(bodies.back().centre_mm, bodies.back().axes(), bodies.back().half_mm);
  prolong_from(bodies.back(), bodies[bodies.size() - 2], 1.0);
  // Even steps of the curve's own length.
  SpineColumn column;
  double passed_mm = SpineColumn::kStepMm;
  for (std::size_t n = 0; n < dense.size(); ++n) {
    if (n > 0) passed_mm += (dense[n].centre_mm - dense[n - 1].centre_mm).norm();
    if (passed_mm < SpineColumn::kStepMm - 0.5 * kStepMm) continue;
    passed_mm = 0.0;
    column.sections.push_back(dense[n]);
    column.sections.back().wall = wall_of(probe, dense[n]);
  }
  return column;
}

}  // namespace spinaltap
