// The whole chain on real CTs; see tests/support/test_data.h for where they lie.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/common/bake_ct.h"
#include "apps/common/bone_path.h"
#include "apps/common/drilling.h"
#include "core/ct/dicom_read.h"
#include "core/ct/label_map.h"
#include "core/segment/distance_transform.h"
#include "mesh/mesh_quality.h"
#include "tests/support/test_data.h"
#include "vdb/isosurface.h"

namespace spinaltap {
namespace {

MeshQuality print_quality(const char* what, const BakedCt& baked) {
  const MeshQuality quality = measure_mesh(bone_surface(baked.bone));
  std::printf(
      "%s: %zu mask voxels, %zu centres, mean residual %.3f mm; %zu triangles, %zu pieces, Euler number %ld, "
      "%.0f mm3, dropped %zu\n",
      what, baked.mask_voxels, baked.fit.centres, baked.fit.mean_residual_mm, quality.triangles, quality.pieces,
      quality.euler_number, quality.volume_mm3, baked.bake.dropped_pieces);
  return quality;
}

void expect_closed(const MeshQuality& quality) {
  EXPECT_TRUE(quality.closed()) << quality.boundary_edges << " border edges, " << quality.refused_faces << " refused";
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_GT(quality.volume_mm3, 1e4);
}

/// Distance from each voxel to the label map's boundary: to the nearest voxel of the other kind.
std::vector<float> distance_to_boundary_mm(const BoneMask& mask) {
  std::vector<std::uint8_t> outside(mask.inside.size());
  std::transform(mask.inside.begin(), mask.inside.end(), outside.begin(),
                 [](std::uint8_t inside) { return static_cast<std::uint8_t>(inside != 0 ? 0 : 1); });
  const std::vector<float> to_inside = squared_distance_to(mask.inside, mask.geometry);
  std::vector<float> distance_mm = squared_distance_to(outside, mask.geometry);
  for (std::size_t i = 0; i < distance_mm.size(); ++i) {
    distance_mm[i] = std::sqrt(std::max(distance_mm[i], to_inside[i]));
  }
  return distance_mm;
}

TEST(RealCt, L3WithItsLabelMapBecomesOneClosedBoneThatCanBeDrilled) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  const CtVolume ct = read_dicom(folder / "dicom");
  const LabelChoice labels{folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22};
  BakeCtOptions bake_options;
  bake_options.labels = labels;
  const BakedCt baked = bake_ct(ct, bake_options);
  EXPECT_EQ(baked.mask_voxels, 17698U);
  expect_closed(print_quality("L3, label 22", baked));

  // Every vertex near the label map's boundary: the label's edge has steps of a voxel (1.5 mm), its smoothing and the
  // move to the cortex's edge by one voxel at most take it further.
  const BoneMask mask = read_label_map(labels.file, labels.label, ct.geometry);
  const std::vector<float> to_boundary_mm = distance_to_boundary_mm(mask);
  const TriangleMesh mesh = bone_surface(baked.bone);
  double most_mm = 0.0;
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    const Vec3 p = ct.geometry.to_index(vertex.cast<double>());
    const auto index = [&](int axis) { return static_cast<int>(std::lround(p[axis])); };
    ASSERT_TRUE(ct.geometry.contains(index(0), index(1), index(2))) << vertex.transpose();
    const double here_mm = static_cast<double>(to_boundary_mm[ct.geometry.offset(index(0), index(1), index(2))]);
    most_mm = std::max(most_mm, here_mm);
  }
  std::printf("furthest vertex from the label's boundary: %.2f mm\n", most_mm);
  EXPECT_LE(most_mm, 2.0 * 1.5 + 1e-3);

  const DrillPath path = suggest_path(baked.bone, {});
  DrillingOptions options;
  options.motion.step_mm = 0.02;
  const Drilling drilling = drill_bone(baked.bone, path, {}, options);
  std::printf("suggested path: %.1f mm, %zu points in bone, %zu removed, greatest thrust %.2f N\n", path.length_mm(),
              drilling.points_in_bone, drilling.removed, drilling.most_thrust_n);
  EXPECT_GE(path.length_mm(), 30.0);
  // Nearly all of a bit's section lies in bone over the path's length.
  EXPECT_GT(drilling.removed, 0.7 * path.length_mm() / 0.1 * 661.0);
  // Powers' porcine vertebrae took 0.6 to 29.6 N.
  EXPECT_GT(drilling.most_thrust_n, 0.6);
  EXPECT_LT(drilling.most_thrust_n, 60.0);
  const MeshQuality drilled = measure_mesh(bone_surface(drilling.drilled));
  EXPECT_TRUE(drilled.closed());
  EXPECT_LT(drilled.volume_mm3, measure_mesh(mesh).volume_mm3 - 100.0);
}

TEST(RealCt, L3WithoutItsLabelMapIsClosed) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  expect_closed(print_quality("L3, no label map", bake_ct(read_dicom(folder / "dicom"))));
}

TEST(RealCt, T11IsClosed) {
  SPINALTAP_NEED_TEST_DATA(folder, "T11_ct_0.78mm")
  const CtVolume ct = read_dicom(folder / "dicom");
  EXPECT_EQ(ct.geometry.size, (std::array<int, 3>{512, 512, 70}));
  expect_closed(print_quality("T11", bake_ct(ct)));
}

TEST(RealCt, Jpeg2000ThoraxIsClosed) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_ct_j2k")
  const CtVolume ct = read_dicom(folder / "dicom");
  EXPECT_EQ(ct.geometry.size[2], 20);
  expect_closed(print_quality("thorax", bake_ct(ct)));
}

}  // namespace
}  // namespace spinaltap
