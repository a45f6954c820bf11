#include "core/anatomy/pedicle_section.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/anatomy/detail/lattice_ray.h"

namespace spinaltap {
namespace {

constexpr std::size_t kRays = BoneSection::kRays;

struct Unit {
  double x, y;
};

const std::array<Unit, kRays>& circle() {
  static const std::array<Unit, kRays> units = [] {
    std::array<Unit, kRays> made{};
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(ray) / static_cast<double>(kRays);
      made[ray] = {std::cos(angle), std::sin(angle)};
    }
    return made;
  }();
  return units;
}

/// Area, first and second moments of the contour's polygon about the centre.
struct Moments {
  double area = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
};

Moments moments_of(const std::array<double, kRays>& radii) {
  Moments sum;
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    const std::size_t next = (ray + 1) % kRays;
    const Eigen::Vector2d a(radii[ray] * circle()[ray].x, radii[ray] * circle()[ray].y);
    const Eigen::Vector2d b(radii[next] * circle()[next].x, radii[next] * circle()[next].y);
    const double cross = a.x() * b.y() - a.y() * b.x();
    sum.area += 0.5 * cross;
    sum.first += cross / 6.0 * (a + b);
    // Of a triangle with a corner at the centre.
    sum.second +=
        cross / 24.0 * (2.0 * a * a.transpose() + 2.0 * b * b.transpose() + a * b.transpose() + b * a.transpose());
  }
  return sum;
}

/// The principal axes of the moments about the centroid, and the half diameters of the ellipse that has them.
struct Ellipse {
  Eigen::Matrix2d axes;  ///< columns: along the small and the large diameter
  Eigen::Vector2d halves;

  double radius(const Unit& direction) const {
    const Eigen::Vector2d along = axes.transpose() * Eigen::Vector2d(direction.x, direction.y);
    return 1.0 / along.cwiseQuotient(halves).norm();
  }
};

Ellipse ellipse_of(const Moments& moments) {
  const Eigen::Vector2d centroid = moments.first / moments.area;
  const Eigen::Matrix2d spread = moments.second / moments.area - centroid * centroid.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  return {solver.eigenvectors(), 2.0 * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt()};
}

/// Radii of which, over those of the ellipse, the Fourier orders above 5 are left out.
std::array<double, kRays> smoothed(const std::array<double, kRays>& radii, const Ellipse& ellipse) {
  constexpr std::size_t kOrders = 5;
  std::array<double, kRays> result{};
  for (std::size_t order = 0; order <= kOrders; ++order) {
    double cosine = 0.0, sine = 0.0;
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      const double ratio = radii[ray] / ellipse.radius(circle()[ray]);
      cosine += ratio * circle()[order * ray % kRays].x;
      sine += ratio * circle()[order * ray % kRays].y;
    }
    const double scale = (order == 0 ? 1.0 : 2.0) / static_cast<double>(kRays);
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      result[ray] += scale * (cosine * circle()[order * ray % kRays].x + sine * circle()[order * ray % kRays].y);
    }
  }
  for (std::size_t ray = 0; ray < kRays; ++ray) result[ray] *= ellipse.radius(circle()[ray]);
  return result;
}

/// How far the contour reaches from one side to the other along a direction, between its points too.
double extent_along(const std::array<double, kRays>& radii, const Eigen::Vector2d& direction) {
  const auto height = [&](std::size_t ray, double sign) {
    const std::size_t at = (ray + kRays) % kRays;
    return sign * radii[at] * (direction.x() * circle()[at].x + direction.y() * circle()[at].y);
  };
  double extent = 0.0;
  for (const double sign : {1.0, -1.0}) {
    std::size_t top = 0;
    for (std::size_t ray = 1; ray < kRays; ++ray) {
      if (height(ray, sign) > height(top, sign)) top = ray;
    }
    // The parabola through the highest point and its neighbours.
    const double before = height(top + kRays - 1, sign), at = height(top, sign), after = height(top + 1, sign);
    const double bend = before - 2.0 * at + after;
    extent += bend < 0.0 ? at - 0.125 * (after - before) * (after - before) / bend : at;
  }
  return extent;
}

void cast(const BoneShape& bone, BoneSection& section) {
  section.endless = 0;
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    section.radii_mm[ray] =
        way_to_surface_mm(bone, section.centre_mm, section.direction(ray), BoneSection::kMaxRadiusMm);
    if (section.radii_mm[ray] >= BoneSection::kMaxRadiusMm) ++section.endless;
  }
}

}  // namespace

Vec3 BoneSection::direction(std::size_t ray) const { return circle()[ray].x * u + circle()[ray].y * v; }

BoneSection section_around(const BoneShape& bone, const Vec3& p_mm, const Vec3& normal, const Vec3& upward) {
  constexpr int kRounds = 3;
  BoneSection section;
  section.u = upward.cross(normal).normalized();
  section.v = normal.cross(section.u);
  section.centre_mm = p_mm;
  for (int round = 0; round <= kRounds; ++round) {
    section.inside = bone.lattice_mm(section.centre_mm) < 0.0;
    if (!section.inside) return section;
    cast(bone, section);
    const Moments moments = moments_of(section.radii_mm);
    section.area_mm2 = moments.area;
    if (round == kRounds) break;
    const Eigen::Vector2d shift = moments.first / moments.area;
    if (shift.norm() < 0.005) break;
    section.centre_mm += shift.x() * section.u + shift.y() * section.v;
  }
  return section;
}

BoneSection sharpened(const BoneShape& bone, BoneSection section) {
  constexpr int kRounds = 4;
  constexpr double kStepMm = 0.05, kMaxMoveMm = 0.15;
  std::vector<Vec3> points_mm(2 * kRays);
  std::vector<double> values_mm(2 * kRays);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      points_mm[2 * ray] = section.centre_mm + (section.radii_mm[ray] - kStepMm) * section.direction(ray);
      points_mm[2 * ray + 1] = section.centre_mm + (section.radii_mm[ray] + kStepMm) * section.direction(ray);
    }
    bone.surface().evaluate(points_mm, values_mm, {});
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      const double slope = (values_mm[2 * ray + 1] - values_mm[2 * ray]) / (2.0 * kStepMm);
      if (!(slope > 0.2) || section.radii_mm[ray] >= BoneSection::kMaxRadiusMm) continue;
      const double middle_mm = 0.5 * (values_mm[2 * ray] + values_mm[2 * ray + 1]);
      section.radii_mm[ray] -= std::clamp(middle_mm / slope, -kMaxMoveMm, kMaxMoveMm);
    }
  }
  section.area_mm2 = moments_of(section.radii_mm).area;
  return section;
}

SectionSize size_of(const BoneSection& section) {
  const Ellipse ellipse = ellipse_of(moments_of(section.radii_mm));
  const std::array<double, kRays> radii = smoothed(section.radii_mm, ellipse);
  SectionSize size;
  const auto axis = [&](int n, double& extent_mm) {
    const Eigen::Vector2d along = ellipse.axes.col(n);
    extent_mm = extent_along(radii, along);
    return Vec3(along.x() * section.u + along.y() * section.v);
  };
  size.small_axis = axis(0, size.small_mm);
  size.large_axis = axis(1, size.large_mm);
  return size;
}

}  // namespace spinaltap
