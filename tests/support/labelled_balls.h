#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/ct/label_volume.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap::test {

/// Three balls of bone one below the other, marked as T11, T12 and L1 in VerSe's numbers; the CT's border cuts the
/// last.
struct LabelledBalls {
  static constexpr double kRadiusMm = 5.0;
  static constexpr double kVoxelMm = 0.8;

  std::vector<Ball> balls{
      {Vec3(10.3, -4.1, 44.6), kRadiusMm}, {Vec3(10.9, -3.6, 32.1), kRadiusMm}, {Vec3(10.1, -4.4, 20.9), kRadiusMm}};
  CtVolume ct;
  LabelVolume labels;

  LabelledBalls() {
    GridGeometry geometry;
    geometry.size = {24, 24, 40};
    geometry.spacing_mm = Vec3::Constant(kVoxelMm);
    geometry.origin_mm = Vec3(1.0, -13.5, 20.6);
    std::vector<std::int16_t> hu;
    labels.geometry = geometry;
    for (int k = 0; k < geometry.size[2]; ++k) {
      for (int j = 0; j < geometry.size[1]; ++j) {
        for (int i = 0; i < geometry.size[0]; ++i) {
          const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
          double nearest_mm = 1e9;
          std::uint8_t label = 0;
          for (std::size_t n = 0; n < balls.size(); ++n) {
            const double distance_mm = balls[n].distance_mm(p_mm);
            nearest_mm = std::min(nearest_mm, distance_mm);
            if (distance_mm < 0.0) label = static_cast<std::uint8_t>(18 + n);
          }
          // Bone of 700 HU in tissue of 40, with a voxel's blur between them.
          const double share = std::clamp(0.5 - nearest_mm / kVoxelMm, 0.0, 1.0);
          hu.push_back(static_cast<std::int16_t>(std::lround(40.0 + 660.0 * share)));
          labels.labels.push_back(label);
        }
      }
    }
    ct = make_ct_volume(geometry, std::move(hu));
    labels.names = {{18, {"T11", Level{18}}}, {19, {"T12", Level::kT12}}, {20, {"L1", Level::kL1}}};
    labels.level_source = "names in the label map";  // as of one that was read
  }
};

}  // namespace spinaltap::test
