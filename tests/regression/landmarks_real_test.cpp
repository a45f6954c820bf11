// The anatomy found on real vertebrae: a scanned mesh and two CTs; see tests/support/test_data.h for where they lie.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/ct/dicom_read.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bake_ct.h"

namespace spinaltap {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Landmarks printed_landmarks(const char* what, const BoneModel& bone) {
  const auto start = std::chrono::steady_clock::now();
  const BoneShape shape(std::make_shared<BoneField>(bone), bone.bounds_mm(), bone.voxel_mm());
  const double shape_s = seconds_since(start);
  const Landmarks found = find_landmarks(shape);
  std::printf("%s: shape %.2f s, landmarks %.2f s, %zu points\n", what, shape_s, seconds_since(start) - shape_s,
              shape.points_mm().size());
  for (const PedicleLandmarks* pedicle : {&found.left_pedicle, &found.right_pedicle}) {
    const Vec3 isthmus = found.to_own(pedicle->isthmus_mm), axis = found.axes.transpose() * pedicle->axis;
    std::printf("  pedicle %.1f x %.1f mm at (%.1f, %.1f, %.1f), axis (%.2f, %.2f, %.2f)\n", pedicle->width_mm,
                pedicle->height_mm, isthmus.x(), isthmus.y(), isthmus.z(), axis.x(), axis.y(), axis.z());
  }
  std::printf("  body %.1f x %.1f x %.1f mm, canal %.1f x %.1f mm\n", found.body.width_mm, found.body.depth_mm,
              found.body.height_mm, found.canal.width_mm, found.canal.depth_mm);
  for (const std::string& warning : found.warnings) std::printf("  warning: %s\n", warning.c_str());
  return found;
}

/// What is known of any such vertebra: that its sides are much alike, and that pedicles converge forward.
void expect_sides_alike(const Landmarks& found) {
  const PedicleLandmarks &left = found.left_pedicle, &right = found.right_pedicle;
  EXPECT_NEAR(left.width_mm / right.width_mm, 1.0, 0.25);
  EXPECT_NEAR(left.height_mm / right.height_mm, 1.0, 0.25);
  const Vec3 left_own = found.to_own(left.isthmus_mm), right_own = found.to_own(right.isthmus_mm);
  EXPECT_LE((left_own - right_own.cwiseProduct(Vec3(-1, 1, 1))).norm(), 4.0);
  const Vec3 left_axis = found.axes.transpose() * left.axis, right_axis = found.axes.transpose() * right.axis;
  EXPECT_LE((left_axis - right_axis.cwiseProduct(Vec3(-1, 1, 1))).norm(), 0.3);
  EXPECT_LT(left_axis.y(), -0.8);
  // In the upper half of the body.
  EXPECT_GT(found.superior().dot(left.isthmus_mm - found.body.centre_mm), 0.0);
  EXPECT_LT(left_own.z(), found.to_own(found.body.upper.centre_mm).z());
}

WHOLE_RUNS("LandmarksOfRealVertebrae.*");

TEST(LandmarksOfRealVertebrae, ScannedL3) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_mesh")
  const BoneModel bone = bake_solid(*make_mesh_solid(test::read_real_vertebra(folder)), {}, 40.0);
  const Landmarks found = printed_landmarks("scanned L3", bone);
  expect_sides_alike(found);
  // The mesh is turned into the patient's frame by its file's axes alone.
  EXPECT_GT(found.left().x(), 0.97);
  EXPECT_GT(found.superior().z(), 0.9);
  // Its pedicles are 24 mm high, as its picture shows too, and rightly doubted.
  for (const std::string& warning : found.warnings)
    EXPECT_NE(warning.find("pedicle's height"), std::string::npos) << warning;
}

TEST(LandmarksOfRealVertebrae, L3OfACtOfThickSlices) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  BakeCtOptions options;
  options.labels = LabelChoice{folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22};
  const Landmarks found = printed_landmarks("L3 of a CT", bake_ct(read_dicom(folder / "dicom"), options).bone);
  expect_sides_alike(found);
  EXPECT_TRUE(found.warnings.empty());
}

TEST(LandmarksOfRealVertebrae, T11OfACt) {
  SPINALTAP_NEED_TEST_DATA(folder, "T11_ct_0.78mm")
  const Landmarks found = printed_landmarks("T11 of a CT", bake_ct(read_dicom(folder / "dicom")).bone);
  expect_sides_alike(found);
}

}  // namespace
}  // namespace spinaltap
