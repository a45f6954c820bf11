#include "core/segment/body_cylinder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace spinaltap {
namespace {

/// Points and outward normals of the unit cylinder, about as dense everywhere on a typical body.
struct UnitSurface {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;

  UnitSurface() {
    constexpr int kOnEachEnd = 70;
    for (const double end : {-1.0, 1.0}) {
      for (int i = 0; i < kOnEachEnd; ++i) {
        // The rim is left out: it is round, and osteophytes grow there.
        const double r = 0.88 * std::sqrt((i + 0.5) / kOnEachEnd);
        const double turn = 2.0 * std::numbers::pi * i / std::numbers::phi;
        points.emplace_back(r * std::cos(turn), r * std::sin(turn), end);
        normals.emplace_back(0.0, 0.0, end);
      }
    }
    constexpr int kAround = 36;
    constexpr int kUp = 6;
    for (int level = 0; level < kUp; ++level) {
      for (int i = 0; i < kAround; ++i) {
        const double turn = 2.0 * std::numbers::pi * (i + 0.5 * (level % 2)) / kAround;
        // Beside the canal there are pedicles and the heads of ribs.
        const double from_back = std::abs(std::remainder(turn - 0.5 * std::numbers::pi, 2.0 * std::numbers::pi));
        if (from_back > 25.0 * kDegree && from_back < 90.0 * kDegree) continue;
        points.emplace_back(std::cos(turn), std::sin(turn), 0.8 * (2.0 * (level + 0.5) / kUp - 1.0));
        normals.emplace_back(std::cos(turn), std::sin(turn), 0.0);
      }
    }
  }
};

/// The mean wall edge on the surface.
double fit_of(const WallProbe& probe, const BodyCylinder& cylinder) {
  static const UnitSurface unit;
  const Mat3 axes = cylinder.axes();
  double sum = 0.0;
  for (std::size_t i = 0; i < unit.points.size(); ++i) {
    const Vec3 p_mm = cylinder.centre_mm + axes * unit.points[i].cwiseProduct(cylinder.half_mm);
    const Vec3 outward = (axes * unit.normals[i].cwiseQuotient(cylinder.half_mm)).normalized();
    sum += probe.edge(p_mm, outward);
  }
  return sum / static_cast<double>(unit.points.size());
}

/// The ways in which the search changes a cylinder: it moves one of the six faces, moves or widens the whole, or turns.
constexpr int kMoves = 15;

BodyCylinder moved(const BodyCylinder& cylinder, int move, double step_mm) {
  constexpr double kRadPerMm = 1.0 / 20.0;
  BodyCylinder other = cylinder;
  const int axis = move % 3;
  const Vec3 along = cylinder.axes().col(axis);
  switch (move / 3) {
    case 0:
      other.centre_mm += step_mm * along;
      break;
    case 1:
      other.half_mm[axis] += step_mm;
      break;
    case 2:
    case 3:
      other.half_mm[axis] += 0.5 * step_mm;
      other.centre_mm += (move / 3 == 2 ? 0.5 : -0.5) * step_mm * along;
      break;
    default:
      other.turn_rad[axis] += step_mm * kRadPerMm;
  }
  return other;
}

bool allowed(const BodyCylinder& cylinder, const BodyCylinder& start, const RefineLimits& limits) {
  const Vec3 shift = start.axes().transpose() * (cylinder.centre_mm - start.centre_mm);
  const double taller = cylinder.half_mm.z() - start.half_mm.z();
  const Eigen::Array2d share = cylinder.half_mm.head<2>().array() / start.half_mm.head<2>().array() - 1.0;
  return std::hypot(shift.x(), shift.y()) <= limits.shift_mm &&
         std::abs(shift.z()) + std::abs(taller) <= limits.end_shift_mm + 1e-9 &&
         (share.abs() <= limits.size_share).all() &&
         ((cylinder.turn_rad - start.turn_rad).array().abs() <= limits.turn_rad.array()).all();
}

}  // namespace

Mat3 BodyCylinder::axes() const {
  return (Eigen::AngleAxisd(turn_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(turn_rad.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(turn_rad.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

void BodyCylinder::set_axes(const Mat3& axes) {
  // axes = Rz Ry Rx
  turn_rad = Vec3(std::atan2(axes(2, 1), axes(2, 2)), std::asin(std::clamp(-axes(2, 0), -1.0, 1.0)),
                  std::atan2(axes(1, 0), axes(0, 0)));
}

double BodyCylinder::scale_to(const Vec3& p_patient) const {
  const Vec3 p = (axes().transpose() * (p_patient - centre_mm)).cwiseQuotient(half_mm);
  return std::max(std::hypot(p.x(), p.y()), std::abs(p.z()));
}

double WallProbe::edge(const Vec3& p_patient, const Vec3& outward) const {
  constexpr double kInsideMm = 0.8;
  constexpr double kOutsideMm = 1.8;
  constexpr double kUnsureHu = 40.0;
  const Vec3 p_index = to_index_ * (p_patient - hu_.geometry.origin_mm);
  const Vec3 outward_index = to_index_ * outward;
  // Metal and calcium no more than cortex, lung no less than fat: a wall is a wall.
  const auto value = [&](double depth_mm) {
    return std::clamp(sample_clamped(hu_, p_index - depth_mm * outward_index), -100.0, 500.0);
  };
  const double outside_hu = value(-kOutsideMm);
  const double edge = std::clamp((value(kInsideMm) - outside_hu) / levels_.full_drop_hu, -1.0, 1.0);
  // From the cortex into cancellous bone that is bright the CT number falls too, and that is no wall.
  const double soft = std::clamp((levels_.bone_hu + kUnsureHu - outside_hu) / (2.0 * kUnsureHu), 0.0, 1.0);
  return edge > 0.0 ? edge * soft : edge;
}

BodyCylinder refine_body_cylinder(const WallProbe& probe, const BodyCylinder& start, const RefineLimits& limits) {
  BodyCylinder best = start;
  best.fit = fit_of(probe, best);
  for (double step_mm = 1.5; step_mm >= 0.25; step_mm *= 0.5) {
    constexpr int kMaxRounds = 12;
    for (int round = 0; round < kMaxRounds; ++round) {
      const double before = best.fit;
      for (int move = 0; move < kMoves; ++move) {
        for (const double sign : {-1.0, 1.0}) {
          BodyCylinder other = moved(best, move, sign * step_mm);
          if (!allowed(other, start, limits)) continue;
          other.fit = fit_of(probe, other);
          if (other.fit > best.fit) best = other;
        }
      }
      if (!(best.fit > before)) break;
    }
  }
  return best;
}

double WallProbe::hu(const Vec3& p_patient) const {
  return sample_clamped(hu_, to_index_ * (p_patient - hu_.geometry.origin_mm));
}

}  // namespace spinaltap
