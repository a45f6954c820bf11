#include "core/segment/body_cylinder.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/segment/binned_ct.h"

namespace spinaltap {
namespace {

const Vec3 kLeastHalfMm(10.0, 7.5, 6.5);
const Vec3 kMostHalfMm(32.0, 24.0, 17.5);
constexpr double kLeastWidthOverDepth = 0.95;   // T6, heart-shaped
constexpr double kMostWidthOverDepth = 1.75;    // L5
constexpr double kLeastHeightOverDepth = 0.65;  // less is a disc between two endplates
constexpr double kMostHeightOverDepth = 0.95;   // more is two bodies
const Vec3 kMostTurnRad(0.6, 0.4, 0.35);        // L5 may lie 35 degrees steep; the patient may be turned by 20

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
        points.emplace_back(std::cos(turn), std::sin(turn), 0.8 * (2.0 * (level + 0.5) / kUp - 1.0));
        normals.emplace_back(std::cos(turn), std::sin(turn), 0.0);
      }
    }
  }
};

/// The mean wall edge at every `stride`-th point of the surface.
double fit_of(const FloatGrid& hu, const BodyCylinder& cylinder, const WallLevels& levels, std::size_t stride) {
  static const UnitSurface unit;
  const Mat3 axes = cylinder.axes();
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < unit.points.size(); i += stride, count += 1.0) {
    const Vec3 p_mm = cylinder.centre_mm + axes * unit.points[i].cwiseProduct(cylinder.half_mm);
    const Vec3 outward = (axes * unit.normals[i].cwiseQuotient(cylinder.half_mm)).normalized();
    sum += wall_edge(hu, p_mm, outward, levels);
  }
  return sum / count;
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

/// What a search keeps to.
struct Search {
  Vec3 seed_mm;  ///< stays within the cylinder
  WallLevels levels;
  double facing_rad;  ///< the turn about z that the cylinder's own may differ from a little
};

bool allowed(const BodyCylinder& cylinder, const Search& search) {
  const double width_over_depth = cylinder.half_mm.x() / cylinder.half_mm.y();
  const double height_over_depth = cylinder.half_mm.z() / cylinder.half_mm.y();
  return width_over_depth >= kLeastWidthOverDepth && width_over_depth <= kMostWidthOverDepth &&
         height_over_depth >= kLeastHeightOverDepth && height_over_depth <= kMostHeightOverDepth &&
         (cylinder.half_mm.array() >= kLeastHalfMm.array()).all() &&
         (cylinder.half_mm.array() <= kMostHalfMm.array()).all() &&
         ((cylinder.turn_rad - Vec3(0.0, 0.0, search.facing_rad)).array().abs() <= kMostTurnRad.array()).all() &&
         cylinder.scale_to(search.seed_mm) < 1.05;
}

/// Makes one move at a time while that helps, with steps that halve.
BodyCylinder improve(const FloatGrid& hu, const Search& search, BodyCylinder best, double step_mm, double least_step_mm,
                     std::size_t stride) {
  best.fit = fit_of(hu, best, search.levels, stride);
  for (; step_mm >= least_step_mm; step_mm *= 0.5) {
    constexpr int kMostRounds = 12;
    for (int round = 0; round < kMostRounds; ++round) {
      const double before = best.worth();
      for (int move = 0; move < kMoves; ++move) {
        for (const double sign : {-1.0, 1.0}) {
          BodyCylinder other = moved(best, move, sign * step_mm);
          if (!allowed(other, search)) continue;
          other.fit = fit_of(hu, other, search.levels, stride);
          if (other.worth() > best.worth()) best = other;
        }
      }
      if (!(best.worth() > before)) break;
    }
  }
  return best;
}

std::vector<BodyCylinder> starts_around(const Vec3& centre_mm, double facing_rad) {
  const Mat3 facing = Eigen::AngleAxisd(facing_rad, Vec3::UnitZ()).toRotationMatrix();
  std::vector<BodyCylinder> starts;
  for (const Vec3& half_mm : {Vec3(16.0, 13.0, 11.0), Vec3(23.0, 17.0, 14.0)}) {
    for (const double x : {-0.55, 0.0, 0.55}) {
      for (const double y : {-0.55, 0.0, 0.55}) {
        for (const double z : {-0.8, 0.0, 0.8}) {
          starts.push_back(
              {centre_mm + facing * half_mm.cwiseProduct(Vec3(x, y, z)), half_mm, Vec3(0.0, 0.0, facing_rad), 0.0});
        }
      }
    }
  }
  return starts;
}

}  // namespace

Mat3 BodyCylinder::axes() const {
  return (Eigen::AngleAxisd(turn_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(turn_rad.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(turn_rad.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

bool BodyCylinder::is_body() const {
  constexpr double kLeastFit = 0.25;  // 0.36 in an L3 whose wall is as thin as the noise of 73 HU, 0.5 to 0.7 in others
  constexpr double kLargerMm = 0.3;
  return fit >= kLeastFit && half_mm.z() > kLeastHalfMm.z() + kLargerMm;
}

double BodyCylinder::worth() const {
  constexpr double kSizePower = 0.2;
  return fit * std::pow(half_mm.x() * half_mm.y(), kSizePower);
}

double BodyCylinder::scale_to(const Vec3& p_patient) const {
  const Vec3 p = (axes().transpose() * (p_patient - centre_mm)).cwiseQuotient(half_mm);
  return std::max(std::hypot(p.x(), p.y()), std::abs(p.z()));
}

double wall_edge(const FloatGrid& hu, const Vec3& p_patient, const Vec3& outward, const WallLevels& levels) {
  constexpr double kInsideMm = 0.8;
  constexpr double kOutsideMm = 1.8;
  constexpr double kUnsureHu = 40.0;
  const Mat3 to_index = hu.geometry.index_to_patient_matrix().inverse();
  const Vec3 p_index = to_index * (p_patient - hu.geometry.origin_mm);
  const Vec3 outward_index = to_index * outward;
  // Metal and calcium no more than cortex, lung no less than fat: a wall is a wall.
  const auto value = [&](double depth_mm) {
    return std::clamp(sample_clamped(hu, p_index - depth_mm * outward_index), -100.0, 500.0);
  };
  const double outside_hu = value(-kOutsideMm);
  const double edge = std::clamp((value(kInsideMm) - outside_hu) / levels.full_drop_hu, -1.0, 1.0);
  // From the cortex into marrow that is bright the CT number falls too, and that is no wall.
  const double soft = std::clamp((levels.bone_hu + kUnsureHu - outside_hu) / (2.0 * kUnsureHu), 0.0, 1.0);
  return edge > 0.0 ? edge * soft : edge;
}

double facing_of_arch_rad(const FloatGrid& hu, const BodyCylinder& body, double bone_hu) {
  constexpr double kArchMm = 35.0;  // how far behind the body laminae and spinous processes are looked for
  constexpr double kAboveMm = 5.0;  // and how far above and below its ends
  constexpr double kAtLeastTwice = 2.0;
  const Mat3 to_body = body.axes().transpose();
  std::array<double, 4> bone{};  // behind, and counter-clockwise from there as seen from above
  for (int k = 0; k < hu.geometry.size[2]; ++k) {
    for (int j = 0; j < hu.geometry.size[1]; ++j) {
      for (int i = 0; i < hu.geometry.size[0]; ++i) {
        if (static_cast<double>(hu.at(i, j, k)) < bone_hu) continue;
        const Vec3 p = to_body * (hu.geometry.to_patient(Vec3(i, j, k)) - body.centre_mm);
        if (std::abs(p.z()) > body.half_mm.z() + kAboveMm) continue;
        const std::array<Eigen::Vector2d, 4> turned{Eigen::Vector2d(p.x(), p.y()), Eigen::Vector2d(p.y(), -p.x()),
                                                    Eigen::Vector2d(-p.x(), -p.y()), Eigen::Vector2d(-p.y(), p.x())};
        for (std::size_t quarter = 0; quarter < 4; ++quarter) {
          const double half_depth_mm = body.half_mm[quarter % 2 == 0 ? 1 : 0];
          const double half_width_mm = body.half_mm[quarter % 2 == 0 ? 0 : 1];
          const double behind_mm = turned[quarter].y() - 1.1 * half_depth_mm;
          if (behind_mm > 0.0 && behind_mm < kArchMm && std::abs(turned[quarter].x()) < half_width_mm) {
            bone[quarter] += 1.0;
          }
        }
      }
    }
  }
  const auto most = std::max_element(bone.begin(), bone.end());
  return *most > kAtLeastTwice * bone[0] ? 0.5 * std::numbers::pi * static_cast<double>(most - bone.begin()) : 0.0;
}

FloatGrid smooth_around(const CtVolume& ct, const Vec3& p_mm) {
  constexpr double kStepMm = 0.8;
  constexpr double kBlurMm = 0.9;
  constexpr double kReachMm = 50.0;  // more than the largest body from any point in it
  const Box3 box_mm(p_mm - Vec3::Constant(kReachMm), p_mm + Vec3::Constant(kReachMm));
  return gaussian_blur(bin_hu(ct, voxels_of(box_mm, ct.geometry), bins_for(ct.geometry, kStepMm)), kBlurMm);
}

BodyCylinder fit_body_cylinder(const FloatGrid& hu, const Vec3& seed_mm, const WallLevels& levels, double facing_rad) {
  const Search search{seed_mm, levels, facing_rad};
  // The second round starts from the middle of what the first one found: a seed near a wall is a poor start.
  constexpr int kRounds = 2;
  constexpr std::size_t kBest = 12;
  constexpr std::size_t kCoarse = 2;  // every second point will do for a first look
  BodyCylinder best;
  best.centre_mm = seed_mm;
  best.fit = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<BodyCylinder> found = starts_around(best.centre_mm, facing_rad);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
      // Large steps leap over false walls, small ones stay near the start: all are tried.
      const BodyCylinder start = found[i];
      found[i].fit = -std::numeric_limits<double>::infinity();
      for (const double step_mm : {6.0, 3.0, 1.5}) {
        const BodyCylinder one = improve(hu, search, start, step_mm, 1.5, kCoarse);
        if (one.worth() > found[i].worth()) found[i] = one;
      }
    });
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.worth() > b.worth(); });
    found.resize(kBest);
    tbb::parallel_for(std::size_t{0}, found.size(),
                      [&](std::size_t i) { found[i] = improve(hu, search, found[i], 1.5, 0.25, 1); });
    for (const BodyCylinder& one : found) {
      if (one.worth() > best.worth()) best = one;
    }
  }
  return best;
}

}  // namespace spinaltap
