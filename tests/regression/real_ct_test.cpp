// Compiled with optimisation: long loops of its own.
// The whole chain on real CTs; see tests/support/test_data.h for where they lie.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/point_grid.h"
#include "core/ct/dicom_read.h"
#include "core/ct/label_map.h"
#include "core/session/operator/path_motion.h"
#include "mesh/display_mesh.h"
#include "mesh/mesh_quality.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/grid/isosurface.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/drilling.h"

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
  EXPECT_TRUE(quality.closed()) << quality.boundary_edges << " border edges, " << quality.rejected_faces << " rejected";
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_GT(quality.volume_mm3, 1e4);
}

/// The faces between voxels inside and outside a mask: its boundary as the label map has it, with steps.
class MaskBoundary {
 public:
  explicit MaskBoundary(const BoneMask& mask) : geometry_(mask.geometry) {
    const auto& size = geometry_.size;
    const auto is_inside = [&](int i, int j, int k) { return geometry_.contains(i, j, k) && mask.at(i, j, k); };
    for (int k = -1; k < size[2]; ++k) {
      for (int j = -1; j < size[1]; ++j) {
        for (int i = -1; i < size[0]; ++i) {
          for (int axis = 0; axis < 3; ++axis) {
            if (is_inside(i, j, k) == is_inside(i + (axis == 0), j + (axis == 1), k + (axis == 2))) continue;
            centres_mm_.push_back(geometry_.to_patient(Vec3(i, j, k) + 0.5 * Vec3::Unit(axis)));
            axes_.push_back(axis);
          }
        }
      }
    }
    grid_.emplace(centres_mm_, 2.0);
  }

  /// Distance to the nearest face, mm; infinite beyond `reach_mm`.
  double distance_mm(const Vec3& p_mm, double reach_mm) const {
    const double half_face_mm = 0.5 * geometry_.spacing_mm.norm();
    double nearest_mm = std::numeric_limits<double>::infinity();
    grid_->for_each_within(p_mm, reach_mm + half_face_mm, [&](std::size_t face) {
      // In the face's own axes: how far beyond its rim, and how far off its plane.
      Vec3 off_mm = (geometry_.directions.transpose() * (p_mm - centres_mm_[face])).cwiseAbs();
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != axes_[face]) off_mm[axis] = std::max(0.0, off_mm[axis] - 0.5 * geometry_.spacing_mm[axis]);
      }
      nearest_mm = std::min(nearest_mm, off_mm.norm());
    });
    return nearest_mm;
  }

 private:
  GridGeometry geometry_;
  std::vector<Vec3> centres_mm_;
  std::vector<int> axes_;  ///< across which the face's voxels lie
  std::optional<PointGrid> grid_;
};

WHOLE_RUNS("RealCt.*");

TEST(RealCt, L3WithItsLabelMapBecomesOneClosedBoneThatCanBeDrilled) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  const CtVolume ct = read_dicom(folder / "dicom");
  const LabelChoice labels{folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22};
  BakeCtOptions bake_options;
  bake_options.labels = labels;
  const BakedCt baked = bake_ct(ct, bake_options);
  EXPECT_EQ(baked.mask_voxels, 17698U);
  expect_closed(print_quality("L3, label 22", baked));

  // The surface between the label's voxels and the others has steps of a voxel; the bone's surface stays within one.
  const MaskBoundary boundary(read_label_map(labels.file, labels.label, ct.geometry));
  const double voxel_mm = ct.geometry.spacing_mm.maxCoeff();
  const TriangleMesh mesh = bone_surface(baked.bone);
  double max_mm = 0.0;
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    max_mm = std::max(max_mm, boundary.distance_mm(vertex.cast<double>(), 2.0 * voxel_mm));
  }
  std::printf("furthest vertex from the label's boundary: %.2f mm\n", max_mm);
  EXPECT_LE(max_mm, voxel_mm);

  const Bone planning(baked.bone);
  const std::vector<DrillPath> paths = paths_of(auto_plan(planning.walls(), planning.hu_sampler()));
  ASSERT_EQ(paths.size(), 2U);
  const DrillPath path = paths.front();
  SessionSetup setup;
  setup.path = path;
  setup.has_clearances = false;
  PlannedMotion tool_operator(path, in_steps_of(0.02, {.lead_in_mm = setup.volume.lead_in_mm}));
  const Drilling drilling = drill_bone(Bone(baked.bone), setup, tool_operator);
  std::printf("suggested path: %.1f mm, %zu points in bone, %zu removed, max thrust %.2f N\n", path.length_mm(),
              drilling.points_in_bone, drilling.removed, drilling.max_thrust_n);
  EXPECT_GE(path.length_mm(), 30.0);
  // Nearly all of a bit's section lies in bone over the path's length.
  EXPECT_GT(drilling.removed, 0.7 * path.length_mm() / 0.1 * 661.0);
  // Powers' porcine vertebrae took 0.6 to 29.6 N.
  EXPECT_GT(drilling.max_thrust_n, 0.6);
  EXPECT_LT(drilling.max_thrust_n, 60.0);
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

// As `demo` makes it; slivers of 0.4 degrees were what such meshes had.
TEST(RealCt, T11DrilledHasNoThinTriangles) {
  SPINALTAP_NEED_TEST_DATA(folder, "T11_ct_0.78mm")
  const Bone bone(bake_ct(read_dicom(folder / "dicom")).bone);
  const std::vector<DrillPath> paths = paths_of(bone.suggest({}));
  ASSERT_EQ(paths.size(), 2U);
  SessionSetup setup;
  setup.path = paths.front();
  setup.has_clearances = false;
  PlannedMotion tool_operator(setup.path, in_steps_of(0.02, {.lead_in_mm = setup.volume.lead_in_mm}));
  RemeshReport report;
  const TriangleMesh mesh = display_mesh(drill_bone(bone, setup, tool_operator).drilled, {}, &report);
  const MeshQuality quality = measure_mesh(mesh);
  std::printf("T11, drilled: %zu triangles, smallest angle %.1f degrees, mesh to surface %.3f mm, back %.3f mm\n",
              quality.triangles, quality.smallest_angle_deg, report.to_surface.max_mm, report.from_surface.max_mm);
  EXPECT_TRUE(report.reached);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 0);
  EXPECT_GE(quality.smallest_angle_deg, 5.0);
}

TEST(RealCt, Jpeg2000ThoraxIsClosed) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_ct_j2k")
  const CtVolume ct = read_dicom(folder / "dicom");
  EXPECT_EQ(ct.geometry.size[2], 20);
  expect_closed(print_quality("thorax", bake_ct(ct)));
}

}  // namespace
}  // namespace spinaltap
