#pragma once

#include <cmath>

#include "apps/report/levels_picture.h"

namespace spinaltap {

/// Soft tissue with four boxes of bone of 30 x 24 x 18 mm, labels 1 to 4 from below, 24 mm apart, each 6 mm further to
/// the patient's left than the one below; to the left of each, 20 mm off its middle, a bright ball of 4 mm.
struct LevelsScene {
  CtVolume ct;
  LabelVolume labels;
  LevelsPicture what;

  explicit LevelsScene(const Vec3& spacing_mm = Vec3(1.0, 1.0, 3.0), const Mat3& directions = Mat3::Identity()) {
    GridGeometry grid;
    grid.spacing_mm = spacing_mm;
    grid.directions = directions;
    // 110 mm a side around (0, 0, 0).
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      grid.size[static_cast<std::size_t>(axis)] = static_cast<int>(std::lround(110.0 / spacing_mm[axis]));
    }
    const Vec3 middle(0.5 * (grid.size[0] - 1), 0.5 * (grid.size[1] - 1), 0.5 * (grid.size[2] - 1));
    grid.origin_mm = -(grid.index_to_patient_matrix() * middle);
    labels = {grid, std::vector<std::uint8_t>(grid.voxel_count(), 0), {}};
    std::vector<std::int16_t> hu(grid.voxel_count(), 40);
    for (int k = 0; k < grid.size[2]; ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i) {
          const Vec3 p = grid.to_patient(Vec3(i, j, k));
          for (int label = 1; label <= 4; ++label) {
            const Vec3 from_centre = p - centre_mm(label);
            if ((from_centre.cwiseAbs() - Vec3(15.0, 12.0, 9.0)).maxCoeff() < 0.0) {
              labels.labels[grid.offset(i, j, k)] = static_cast<std::uint8_t>(label);
              hu[grid.offset(i, j, k)] = 400;
            }
            if ((from_centre - Vec3(20.0, 0.0, 0.0)).norm() < 4.0) hu[grid.offset(i, j, k)] = 1500;
          }
        }
      }
    }
    ct = make_ct_volume(grid, std::move(hu));
    for (int label = 1; label <= 4; ++label) {
      labels.names[label] = {"L" + std::to_string(5 - label), Level::kNone};
      what.levels.push_back({label, centre_mm(label), false, {}});
    }
    what.pixel_mm = 0.5;
  }

  static Vec3 centre_mm(int label) { return {6.0 * label - 15.0, 2.0, 24.0 * label - 60.0}; }
};

}  // namespace spinaltap
