#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/anatomy/landmarks.h"
#include "tests/support/mesh_rays.h"

namespace spinaltap::test {

/// Of the mesh itself: the sizes at the isthmus, and that it is one.
inline void expect_isthmus(const TriangleMesh& mesh, const PedicleLandmarks& pedicle) {
  // The scan blurs steps of a mask of about a millimetre, on either side.
  constexpr double kStepsMm = 1.0;
  const MeshSection section(mesh, pedicle.isthmus_mm, pedicle.axis);
  std::printf("  pedicle %.1f x %.1f mm; its mesh %.1f x %.1f mm, %.0f mm²\n", pedicle.width_mm, pedicle.height_mm,
              section.extent_mm(pedicle.width_axis), section.extent_mm(pedicle.height_axis), section.area_mm2());
  EXPECT_NEAR(pedicle.width_mm, section.extent_mm(pedicle.width_axis), kStepsMm);
  EXPECT_NEAR(pedicle.height_mm, section.extent_mm(pedicle.height_axis), kStepsMm);
  // No section near by, along the axis or turned about width or height, is much smaller.
  constexpr double kMinShare = 0.93;
  for (const double shift_mm : {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0}) {
    const MeshSection other(mesh, pedicle.isthmus_mm + shift_mm * pedicle.axis, pedicle.axis);
    EXPECT_GE(other.area_mm2(), kMinShare * section.area_mm2()) << "moved by " << shift_mm << " mm";
  }
  for (const double turn : {-15.0 * kDegree, -7.0 * kDegree, 7.0 * kDegree, 15.0 * kDegree}) {
    for (const Vec3& about : {pedicle.width_axis, pedicle.height_axis}) {
      const Vec3 turned = Eigen::AngleAxisd(turn, about) * pedicle.axis;
      EXPECT_GE(MeshSection(mesh, pedicle.isthmus_mm, turned).area_mm2(), kMinShare * section.area_mm2())
          << "turned by " << turn / kDegree << " degrees";
    }
  }
}

inline void expect_body_and_canal(const TriangleMesh& mesh, const Landmarks& found) {
  const MeshRays rays(mesh);
  const Vec3 middle_mm = found.body.centre_mm;
  const double width_mm = rays.span_mm(middle_mm, found.left()), depth_mm = rays.span_mm(middle_mm, found.posterior());
  // Measured some millimetres from the middle, where spurs and a waist change them by that much.
  EXPECT_NEAR(found.body.width_mm, width_mm, 2.5);
  EXPECT_NEAR(found.body.depth_mm, depth_mm, 2.5);
  // The endplates are planes through hollows: the mean height of the middle half is not far from theirs.
  double sum_mm = 0.0;
  int count = 0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const Vec3 beside_mm =
          0.125 * (i * found.body.width_mm * found.left() + j * found.body.depth_mm * found.posterior());
      sum_mm += rays.span_mm(middle_mm + beside_mm, found.superior());
      ++count;
    }
  }
  const double height_mm = sum_mm / count;
  EXPECT_NEAR(found.body.height_mm, height_mm, 1.5);
  // The widest of the pedicles' level, to either side: in a canal like a clover leaf that is near the body.
  double left_mm = 0.0, right_mm = 0.0;
  constexpr int kPlaces = 40;
  for (int n = -kPlaces; n <= kPlaces; ++n) {
    const Vec3 p_mm = found.canal.centre_mm + 0.5 * found.canal.depth_mm * n / kPlaces * found.posterior();
    if (rays.is_inside(p_mm)) continue;
    left_mm = std::max(left_mm, rays.to_surface_mm(p_mm, found.left()));
    right_mm = std::max(right_mm, rays.to_surface_mm(p_mm, -found.left()));
  }
  EXPECT_NEAR(found.canal.width_mm, left_mm + right_mm, 1.5);
  std::printf("  body %.1f x %.1f x %.1f mm, its mesh %.1f x %.1f x %.1f mm; canal %.1f x %.1f mm, its mesh %.1f mm\n",
              found.body.width_mm, found.body.depth_mm, found.body.height_mm, width_mm, depth_mm, height_mm,
              found.canal.width_mm, found.canal.depth_mm, left_mm + right_mm);
}

/// That the landmarks found on a lumbar vertebra are those of its mesh, both in the patient's frame.
inline void expect_landmarks_of(const TriangleMesh& mesh, const Landmarks& found) {
  expect_isthmus(mesh, found.left_pedicle);
  expect_isthmus(mesh, found.right_pedicle);
  expect_body_and_canal(mesh, found);
  // What is known of any lumbar vertebra in the patient's frame.
  EXPECT_GT(found.left().x(), std::cos(15.0 * kDegree));
  EXPECT_GT(found.superior().z(), std::cos(40.0 * kDegree));
  const Vec3 left = found.to_own(found.left_pedicle.isthmus_mm), right = found.to_own(found.right_pedicle.isthmus_mm);
  EXPECT_LE((left - right.cwiseProduct(Vec3(-1.0, 1.0, 1.0))).norm(), 4.0);
  const Vec3 between_mm = 0.5 * (found.left_pedicle.isthmus_mm + found.right_pedicle.isthmus_mm);
  EXPECT_GT(found.superior().dot(between_mm - found.body.centre_mm), 0.0) << "in the upper half";
}

/// That no landmark looks unlike a lumbar vertebra's.
inline void expect_usual(const Landmarks& found) {
  // The Visible Human's pedicles are higher than most, and wider in L5; nothing else is unusual.
  for (const std::string& warning : found.warnings) {
    EXPECT_THAT(warning,
                testing::AnyOf(testing::HasSubstr("pedicle's height is"), testing::HasSubstr("pedicle's width is")));
  }
}

}  // namespace spinaltap::test
