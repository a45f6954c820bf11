#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/ct/ct_volume.h"
#include "core/phantom/vertebra.h"

namespace spinaltap::test {

/// Several vertebrae as one body to scan.
class StackedVertebrae : public Solid {
 public:
  explicit StackedVertebrae(const std::vector<VertebraAnatomy>& anatomies) {
    for (const VertebraAnatomy& anatomy : anatomies) vertebrae_.push_back(std::make_unique<Vertebra>(anatomy));
  }
  /// `count` copies of one vertebra, `step_mm` apart along its own axis, the middle one at the origin.
  StackedVertebrae(int count, double step_mm, const Vec3& rotation_deg) {
    for (int n = 0; n < count; ++n) {
      VertebraAnatomy anatomy;
      anatomy.placement.rotation_deg = rotation_deg;
      const Mat3 rotation = Vertebra(anatomy).rotation();
      anatomy.placement.position_mm = (n - count / 2) * step_mm * rotation.col(2);
      vertebrae_.push_back(std::make_unique<Vertebra>(anatomy));
    }
  }

  const Vertebra& operator[](std::size_t n) const { return *vertebrae_[n]; }

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    std::vector<double> values(points_mm.size());
    std::vector<Vec3> other(gradients.size());
    vertebrae_.front()->evaluate(points_mm, values_mm, gradients);
    for (std::size_t n = 1; n < vertebrae_.size(); ++n) {
      vertebrae_[n]->evaluate(points_mm, values, other);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(values[i] < values_mm[i])) continue;
        values_mm[i] = values[i];
        if (!gradients.empty()) gradients[i] = other[i];
      }
    }
  }
  Box3 bounds_mm() const override {
    Box3 box;
    for (const auto& vertebra : vertebrae_) box.extend(vertebra->bounds_mm());
    return box;
  }
  double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const override {
    return nearest(p_patient).hu(p_patient, distance_mm, aperture_mm);
  }

  /// Whether a point lies in vertebra n.
  bool holds(std::size_t n, const Vec3& p_patient) const { return value_mm(*vertebrae_[n], p_patient) < 0.0; }

 private:
  static double value_mm(const Vertebra& vertebra, const Vec3& p_patient) {
    double value = 0.0;
    vertebra.evaluate({&p_patient, 1}, {&value, 1}, {});
    return value;
  }
  const Vertebra& nearest(const Vec3& p_patient) const {
    return **std::min_element(vertebrae_.begin(), vertebrae_.end(), [&](const auto& a, const auto& b) {
      return value_mm(*a, p_patient) < value_mm(*b, p_patient);
    });
  }

  std::vector<std::unique_ptr<Vertebra>> vertebrae_;
};

/// The voxels whose centres lie in vertebra n.
inline BoneMask true_mask(const StackedVertebrae& stack, std::size_t n, const GridGeometry& geometry) {
  BoneMask mask{geometry, std::vector<std::uint8_t>(geometry.voxel_count(), 0)};
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
        if (stack[n].bounds_mm().exteriorDistance(p_mm) < 1.0 && stack.holds(n, p_mm)) {
          mask.inside[geometry.offset(i, j, k)] = 1;
        }
      }
    }
  }
  return mask;
}

}  // namespace spinaltap::test
