#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/phantom/solid.h"
#include "core/segment/float_grid.h"

namespace spinaltap::test {

/// A solid's values near its surface on a grid, tri-linear between: evaluated in a tenth of a microsecond instead of
/// several, and still within 0.01 mm at the surface of a phantom vertebra at 0.4 mm. Values end at +-kBandMm.
class GriddedField : public ScalarField {
 public:
  static constexpr double kBandMm = 1.2;

  explicit GriddedField(const Solid& solid, double voxel_mm = 0.4) {
    const Box3 bounds_mm = solid.bounds_mm();
    grid_.geometry.origin_mm = bounds_mm.min() - Vec3::Constant(2.0);
    grid_.geometry.spacing_mm = Vec3::Constant(voxel_mm);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 4.0;
      grid_.geometry.size[axis] = static_cast<int>(side_mm / voxel_mm) + 2;
    }
    grid_.values.resize(grid_.geometry.voxel_count());
    const int blocks = (grid_.geometry.size[2] + kBlock - 1) / kBlock;
    tbb::parallel_for(0, blocks, [&](int k) {
      for (int j = 0; j < grid_.geometry.size[1]; j += kBlock) {
        for (int i = 0; i < grid_.geometry.size[0]; i += kBlock) fill(solid, {i, j, k * kBlock});
      }
    });
  }

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    const double step_mm = 0.5 * grid_.geometry.spacing_mm.x();
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = at(points_mm[n]);
      if (gradients.empty()) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = step_mm * Vec3::Unit(axis);
        gradients[n][axis] = (at(points_mm[n] + step) - at(points_mm[n] - step)) / (2.0 * step_mm);
      }
    }
  }

 private:
  static constexpr int kBlock = 6;

  double at(const Vec3& p_mm) const {
    return sample_clamped(grid_, (p_mm - grid_.geometry.origin_mm) / grid_.geometry.spacing_mm.x());
  }

  /// The solid's values change by at most 1 mm per mm, so that one tells of a block far from the surface.
  void fill(const Solid& solid, const std::array<int, 3>& low) {
    const auto value_mm = [&](const Vec3& p_index) {
      const Vec3 p_mm = grid_.geometry.to_patient(p_index);
      double value = 0.0;
      solid.evaluate({&p_mm, 1}, {&value, 1}, {});
      return value;
    };
    const Vec3 middle = Vec3(low[0], low[1], low[2]) + Vec3::Constant(0.5 * (kBlock - 1));
    const double half_diagonal_mm = 0.5 * std::sqrt(3.0) * kBlock * grid_.geometry.spacing_mm.x();
    const double at_middle_mm = value_mm(middle);
    const bool far = std::abs(at_middle_mm) > half_diagonal_mm + kBandMm;
    for (int k = low[2]; k < std::min(low[2] + kBlock, grid_.geometry.size[2]); ++k) {
      for (int j = low[1]; j < std::min(low[1] + kBlock, grid_.geometry.size[1]); ++j) {
        for (int i = low[0]; i < std::min(low[0] + kBlock, grid_.geometry.size[0]); ++i) {
          const double value = far ? at_middle_mm : value_mm(Vec3(i, j, k));
          grid_.values[grid_.geometry.offset(i, j, k)] = static_cast<float>(std::clamp(value, -kBandMm, kBandMm));
        }
      }
    }
  }

  FloatGrid grid_;
};

}  // namespace spinaltap::test
