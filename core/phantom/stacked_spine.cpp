#include <algorithm>
#include <cmath>

#include "core/base/error.h"
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

/// The least value that a body has at points moved by `by_mm`.
double least_value_mm(const Solid& body, const std::vector<Vec3>& points, const Vec3& by_mm) {
  const Box3 box = body.bounds_mm();
  double least = 1e9;
  for (const Vec3& point : points) {
    const Vec3 p = point + by_mm;
    const double way = box.exteriorDistance(p);
    if (way >= least) continue;
    double value = 0.0;
    body.evaluate({&p, 1}, {&value, 1}, {});
    least = std::min(least, way > 0.0 ? std::max(value, way) : value);
  }
  return least;
}

}  // namespace

Spine stacked_spine(std::vector<SpinePart> parts, double gap_mm) {
  constexpr double kSeedMm = 1.5;   // between points that stand for a surface; each lies within 0.87 of it
  constexpr double kStepMm = 0.25;  // of the way down
  if (!(gap_mm >= 0.0 && gap_mm <= 50.0)) fail("spine phantom: a gap of 0 to 50 mm expected, found ", gap_mm);
  for (std::size_t n = 1; n < parts.size(); ++n) {
    const Solid& above = *parts[n - 1].solid;
    std::vector<Vec3> surface;
    for (Vec3 p : surface_seeds(*parts[n].solid, kSeedMm)) {
      // Onto the surface, as far as the value is a distance.
      Vec3 gradient;
      double value = 0.0;
      parts[n].solid->evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
      surface.push_back(p - value * gradient / std::max(gradient.squaredNorm(), 0.25));
    }
    const Box3 upper = above.bounds_mm(), lower = parts[n].solid->bounds_mm();
    Vec3 by(upper.center().x() - lower.center().x(), upper.min().y() - lower.min().y(), 0.0);
    // From far below, up until it is as near as it may be.
    double z = upper.min().z() - lower.max().z() - gap_mm;
    const double highest = upper.max().z() - lower.min().z();
    const auto near_mm = [&](double at) { return least_value_mm(above, surface, by + at * Vec3::UnitZ()); };
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
