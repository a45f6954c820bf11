#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "core/phantom/spine.h"
#include "core/phantom/surface_seeds.h"

namespace spinaltap {
namespace {

/// A solid moved as a whole.
class MovedSolid final : public Solid {
 public:
  MovedSolid(std::shared_ptr<const Solid> solid, const Vec3& by_mm) : solid_(std::move(solid)), by_mm_(by_mm) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      const Vec3 p = points_mm[n] - by_mm_;
      solid_->evaluate({&p, 1}, values_mm.subspan(n, 1), gradients.empty() ? gradients : gradients.subspan(n, 1));
    }
  }
  Box3 bounds_mm() const override { return solid_->bounds_mm().translated(by_mm_); }
  double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const override {
    return solid_->hu(p_patient - by_mm_, distance_mm, aperture_mm);
  }

 private:
  std::shared_ptr<const Solid> solid_;
  Vec3 by_mm_;
};

/// Points on a body's surface, as far as its value is a distance; each place of it has one within kSeedMm.
std::vector<Vec3> surface_of(const Solid& body) {
  constexpr double kSeedMm = 1.5;
  std::vector<Vec3> surface;
  for (const Vec3& p : surface_seeds(body, kSeedMm)) {
    Vec3 gradient;
    double value = 0.0;
    body.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    surface.push_back(p - value * gradient / std::max(gradient.squaredNorm(), 0.25));
  }
  return surface;
}

/// How near points come to a body.
class Nearness {
 public:
  /// Distances of `reach_mm` and more are all the same. `surface`: points on the body's; must outlive this.
  Nearness(const Solid& body, const std::vector<Vec3>& surface, double reach_mm)
      : body_(body), surface_(surface, std::max(reach_mm, 1.0)), reach_mm_(reach_mm) {}

  /// The least distance of points moved by `by_mm`, below 0 inside.
  double min_mm(const std::vector<Vec3>& points, const Vec3& by_mm) const {
    const Box3 box = body_.bounds_mm();
    double min_mm = reach_mm_;
    for (const Vec3& point : points) {
      const Vec3 p = point + by_mm;
      const double way_mm = box.exteriorDistance(p);
      if (way_mm < min_mm) min_mm = std::min(min_mm, way_mm > 0.0 ? std::max(way_mm, distance_mm(p)) : distance_mm(p));
    }
    return min_mm;
  }

 private:
  double distance_mm(const Vec3& p) const {
    constexpr double kPromisedMm = 2.0;  // further off a solid's value need not be a distance
    double value = 0.0;
    body_.evaluate({&p, 1}, {&value, 1}, {});
    if (value < kPromisedMm) return value;
    return std::max(kPromisedMm, surface_.nearest_within(p, reach_mm_).distance_mm);
  }

  const Solid& body_;
  PointGrid surface_;
  double reach_mm_;
};

}  // namespace

Spine stacked_spine(std::vector<SpinePart> parts, double gap_mm) {
  constexpr double kStepMm = 0.25;  // of the way down
  if (!(gap_mm >= 0.0 && gap_mm <= 50.0)) fail("spine phantom: a gap of 0 to 50 mm expected, found ", gap_mm);
  for (std::size_t n = 1; n < parts.size(); ++n) {
    const Solid& above = *parts[n - 1].solid;
    const std::vector<Vec3> above_surface = surface_of(above), surface = surface_of(*parts[n].solid);
    const Nearness nearness(above, above_surface, gap_mm + 1.0);
    const Box3 upper = above.bounds_mm(), lower = parts[n].solid->bounds_mm();
    Vec3 by(upper.center().x() - lower.center().x(), upper.min().y() - lower.min().y(), 0.0);
    // From far below, up until it is as near as it may be.
    double z = upper.min().z() - lower.max().z() - gap_mm;
    const double highest = upper.max().z() - lower.min().z();
    const auto near_mm = [&](double at) { return nearness.min_mm(surface, by + at * Vec3::UnitZ()); };
    while (near_mm(z + kStepMm) >= gap_mm) {
      z += kStepMm;
      if (z > highest) fail("spine phantom: ", level_name(static_cast<Level>(parts[n].label)), " finds no place below");
    }
    double clear = z, near = z + kStepMm;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = 0.5 * (clear + near);
      (near_mm(middle) >= gap_mm ? clear : near) = middle;
    }
    by.z() = clear;
    parts[n].solid = std::make_shared<const MovedSolid>(parts[n].solid, by);
    parts[n].vertebra.reset();  // which would still say where it stood
  }
  return Spine(std::move(parts));
}

}  // namespace spinaltap
