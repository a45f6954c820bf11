// Landmarks of surfaces of real lumbar vertebrae: each is scanned alone, its CT baked, and what is found compared with
// the mesh's own triangles. See tests/support/test_data.h for where the meshes lie.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/phantom/scanner.h"
#include "core/plan/landmarks.h"
#include "core/rbf/fit_surface.h"
#include "core/surface/surface_points.h"
#include "tests/support/mesh_rays.h"
#include "tests/support/real_meshes.h"
#include "vdb/bake.h"
#include "vdb/bone_field.h"
#include "vdb/mesh_solid.h"

namespace spinaltap {
namespace {

CtVolume scan_alone(const Solid& solid) {
  constexpr double kMarginMm = 10.0;
  ScanOptions options;
  options.pixel_mm = 0.5;
  options.slice_step_mm = 0.7;
  options.noise_hu = 12.0;
  const Vec3 sides_mm = solid.bounds_mm().sizes() + Vec3::Constant(2.0 * kMarginMm);
  options.columns = static_cast<int>(sides_mm.x() / options.pixel_mm);
  options.rows = static_cast<int>(sides_mm.y() / options.pixel_mm);
  options.slices = static_cast<int>(sides_mm.z() / options.slice_step_mm);
  return scan(solid, options);
}

/// The voxels whose centres lie in the body: what a flawless segmentation would find.
BoneMask true_mask(const Solid& solid, const GridGeometry& geometry) {
  BoneMask mask{geometry, {}};
  mask.inside.reserve(geometry.voxel_count());
  std::vector<Vec3> row_mm(static_cast<std::size_t>(geometry.size[0]));
  std::vector<double> values_mm(row_mm.size());
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i)
        row_mm[static_cast<std::size_t>(i)] = geometry.to_patient(Vec3(i, j, k));
      solid.evaluate(row_mm, values_mm, {});
      for (const double value_mm : values_mm) mask.inside.push_back(value_mm < 0.0 ? 1 : 0);
    }
  }
  return mask;
}

Landmarks landmarks_through_a_ct(const TriangleMesh& mesh) {
  const std::unique_ptr<Solid> solid = make_mesh_solid(mesh, {.voxel_mm = 0.3});
  const CtVolume ct = scan_alone(*solid);
  const SurfacePoints surface = extract_surface(ct, true_mask(*solid, ct.geometry));
  const SurfaceFit fit = fit_surface(surface, {.spacing_mm = 0.8});
  const BoneModel bone = bake_bone(fit.field, surface.positions_mm, ct, {.voxel_mm = 0.4}, {});
  return find_landmarks(BoneShape(std::make_shared<BoneField>(bone), bone.bounds_mm(), bone.voxel_mm()));
}

/// Of the mesh itself: the sizes at the isthmus, and that it is one.
void expect_isthmus(const TriangleMesh& mesh, const PedicleLandmarks& pedicle) {
  // The scan blurs steps of a mask of about a millimetre, on either side.
  constexpr double kStepsMm = 1.0;
  const test::MeshSection section(mesh, pedicle.isthmus_mm, pedicle.axis);
  std::printf("  pedicle %.1f x %.1f mm; its mesh %.1f x %.1f mm, %.0f mm²\n", pedicle.width_mm, pedicle.height_mm,
              section.extent_mm(pedicle.width_axis), section.extent_mm(pedicle.height_axis), section.area_mm2());
  EXPECT_NEAR(pedicle.width_mm, section.extent_mm(pedicle.width_axis), kStepsMm);
  EXPECT_NEAR(pedicle.height_mm, section.extent_mm(pedicle.height_axis), kStepsMm);
  // No section near by, along the axis or turned about width or height, is much smaller.
  constexpr double kLeastShare = 0.93;
  for (const double shift_mm : {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0}) {
    const test::MeshSection other(mesh, pedicle.isthmus_mm + shift_mm * pedicle.axis, pedicle.axis);
    EXPECT_GE(other.area_mm2(), kLeastShare * section.area_mm2()) << "moved by " << shift_mm << " mm";
  }
  for (const double turn : {-15.0 * kDegree, -7.0 * kDegree, 7.0 * kDegree, 15.0 * kDegree}) {
    for (const Vec3& about : {pedicle.width_axis, pedicle.height_axis}) {
      const Vec3 turned = Eigen::AngleAxisd(turn, about) * pedicle.axis;
      EXPECT_GE(test::MeshSection(mesh, pedicle.isthmus_mm, turned).area_mm2(), kLeastShare * section.area_mm2())
          << "turned by " << turn / kDegree << " degrees";
    }
  }
}

void expect_body_and_canal(const TriangleMesh& mesh, const Landmarks& found) {
  const test::MeshRays rays(mesh);
  const Vec3 middle_mm = found.body.centre_mm;
  // Measured some millimetres from the middle, where spurs and a waist change them by that much.
  EXPECT_NEAR(found.body.width_mm, rays.span_mm(middle_mm, found.left()), 2.5);
  EXPECT_NEAR(found.body.depth_mm, rays.span_mm(middle_mm, found.posterior()), 2.5);
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
  EXPECT_NEAR(found.body.height_mm, sum_mm / count, 1.5);
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
  std::printf("  body %.1f x %.1f x %.1f mm, canal %.1f x %.1f mm\n", found.body.width_mm, found.body.depth_mm,
              found.body.height_mm, found.canal.width_mm, found.canal.depth_mm);
}

class LandmarksOfRealMeshes : public testing::TestWithParam<std::size_t> {};

TEST_P(LandmarksOfRealMeshes, AreThoseOfTheMesh) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const TriangleMesh mesh = test::read_in_lps(real);
  const Landmarks found = landmarks_through_a_ct(mesh);
  std::printf("%s\n", real.name);
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
  // The Visible Human's pedicles are higher than most, and wider in L5; nothing else is unusual.
  for (const std::string& doubt : found.doubts) {
    EXPECT_THAT(doubt,
                testing::AnyOf(testing::HasSubstr("pedicle's height is"), testing::HasSubstr("pedicle's width is")));
  }
}

INSTANTIATE_TEST_SUITE_P(All, LandmarksOfRealMeshes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

}  // namespace
}  // namespace spinaltap
