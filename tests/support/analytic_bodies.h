#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/ct/ct_volume.h"
#include "vdb/bake/bake.h"

namespace spinaltap::test {

/// A field by formula.
class FormulaField final : public ScalarField {
 public:
  using Value = std::function<double(const Vec3&)>;
  using Gradient = std::function<Vec3(const Vec3&)>;
  FormulaField(Value value, Gradient gradient) : value_(std::move(value)), gradient_(std::move(gradient)) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      values_mm[i] = value_(points_mm[i]);
      if (!gradients.empty()) gradients[i] = gradient_(points_mm[i]);
    }
  }

 private:
  Value value_;
  Gradient gradient_;
};

struct Ball {
  Vec3 centre_mm = Vec3::Zero();
  double radius_mm = 10.0;

  double distance_mm(const Vec3& p_mm) const { return (p_mm - centre_mm).norm() - radius_mm; }
  double volume_mm3() const { return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3); }
  double area_mm2() const { return 4.0 * std::numbers::pi * radius_mm * radius_mm; }
  Box3 bounds_mm() const { return {centre_mm - Vec3::Constant(radius_mm), centre_mm + Vec3::Constant(radius_mm)}; }

  /// r² - R²: its slope on the surface is 2 R, not 1.
  FormulaField field() const {
    return {
        [ball = *this](const Vec3& p) { return (p - ball.centre_mm).squaredNorm() - ball.radius_mm * ball.radius_mm; },
        [ball = *this](const Vec3& p) -> Vec3 { return 2.0 * (p - ball.centre_mm); }};
  }

  /// Points all over the surface, about `spacing_mm` apart.
  std::vector<Vec3> surface_points(double spacing_mm) const {
    // A Fibonacci lattice gives every point the same share of the sphere.
    const auto count = static_cast<int>(area_mm2() / (spacing_mm * spacing_mm));
    std::vector<Vec3> points_mm;
    for (int i = 0; i < count; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / count;
      const double turn = 2.0 * std::numbers::pi * i / std::numbers::phi;
      const double r = std::sqrt(1.0 - z * z);
      points_mm.push_back(centre_mm + radius_mm * Vec3(r * std::cos(turn), r * std::sin(turn), z));
    }
    return points_mm;
  }
};

/// A ring around z.
struct Torus {
  Vec3 centre_mm = Vec3::Zero();
  double ring_mm = 12.0;
  double tube_mm = 4.0;

  double distance_mm(const Vec3& p_mm) const {
    const Vec3 q = p_mm - centre_mm;
    return std::hypot(std::hypot(q.x(), q.y()) - ring_mm, q.z()) - tube_mm;
  }
  double volume_mm3() const { return 2.0 * std::numbers::pi * std::numbers::pi * ring_mm * tube_mm * tube_mm; }
  double area_mm2() const { return 4.0 * std::numbers::pi * std::numbers::pi * ring_mm * tube_mm; }
  Box3 bounds_mm() const {
    const Vec3 half(ring_mm + tube_mm, ring_mm + tube_mm, tube_mm);
    return {centre_mm - half, centre_mm + half};
  }

  /// Three times the distance.
  FormulaField field() const {
    return {[torus = *this](const Vec3& p) { return 3.0 * torus.distance_mm(p); },
            [torus = *this](const Vec3& p) -> Vec3 {
              const Vec3 q = p - torus.centre_mm;
              const Vec3 on_ring = torus.ring_mm * Vec3(q.x(), q.y(), 0.0).normalized();
              return 3.0 * (q - on_ring).normalized();
            }};
  }
  Vec3 surface_point() const { return centre_mm + Vec3(ring_mm + tube_mm, 0.0, 0.0); }
};

// Away from the origin, askew to every lattice of voxels.
inline const Ball kBall{Vec3(3.1, -2.3, 105.7), 10.0};
inline const Ball kSmallBall{kBall.centre_mm, 6.0};
inline const Ball kLargeBall{kBall.centre_mm, 15.0};
inline const Torus kTorus{Vec3(-4.2, 1.7, -60.3), 12.0, 4.0};

inline Box3 grown(const Box3& box_mm, double margin_mm) {
  return {box_mm.min().array() - margin_mm, box_mm.max().array() + margin_mm};
}

/// A CT of one number everywhere, that holds `box`.
inline CtVolume even_ct(const Box3& box_mm, double voxel_mm, std::int16_t hu) {
  GridGeometry geometry;
  geometry.spacing_mm = Vec3::Constant(voxel_mm);
  geometry.origin_mm = box_mm.min() - Vec3::Constant(4.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.size[axis] = static_cast<int>((box_mm.sizes()[static_cast<Eigen::Index>(axis)] + 8.0) / voxel_mm) + 2;
  }
  return make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), hu));
}

inline BoneModel bake_ball(const Ball& ball, double voxel_mm = 0.25, std::int16_t hu = 300) {
  return bake_bone(ball.field(), ball.surface_points(1.0), even_ct(ball.bounds_mm(), 1.0, hu), {.voxel_mm = voxel_mm},
                   {{"method", "ball"}});
}

inline BoneModel bake_torus(const Torus& torus, double voxel_mm = 0.25) {
  const std::vector<Vec3> seeds_mm{torus.surface_point()};
  return bake_bone(torus.field(), seeds_mm, even_ct(torus.bounds_mm(), 1.0, 300), {.voxel_mm = voxel_mm}, {});
}

inline double distance_at(const BoneModel& bone, const Vec3& p_mm) {
  float value = 0.0F;
  bone.sample({&p_mm, 1}, {&value, 1}, {});
  return static_cast<double>(value);
}

inline double hu_at(const BoneModel& bone, const Vec3& p_mm) {
  float distance = 0.0F;
  float value = 0.0F;
  bone.sample({&p_mm, 1}, {&distance, 1}, {&value, 1});
  return static_cast<double>(value);
}

}  // namespace spinaltap::test
