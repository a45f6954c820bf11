// Compiled with optimisation: long loops of its own.
// Occupied voxels to look at: the map that other programs open, and the live mesh, which is cut from the swept tool and
// knows no voxel, beside them.

#include "vdb/engine/voxel_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/anatomy/point_tree.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "mesh/mesh_distance.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/random_drilling.h"
#include "tests/support/temporary_folder.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

using Eigen::Vector3i;
using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kMappedBall{Vec3(3.0, -4.0, 5.0), 7.0};

/// A trembling ball burr that mills a pit of 6 x 6 mm into the ball from above, in two layers.
std::vector<ToolInput> pit(std::uint64_t seed) {
  test::Random random(seed);
  std::vector<ToolInput> inputs;
  Vec3 off_mm = Vec3::Zero();
  for (const double depth_mm : {1.0, 2.0}) {
    for (int line = 0; line <= 6; ++line) {
      for (int n = 0; n <= 120; ++n) {
        off_mm = 0.9 * off_mm + 0.02 * random.direction();
        const double along_mm = (line % 2 == 0 ? 1.0 : -1.0) * (0.05 * n - 3.0);
        const Vec3 tip_mm = kMappedBall.centre_mm + Vec3(along_mm, line - 3.0, kMappedBall.radius_mm - depth_mm);
        inputs.push_back({{tip_mm + off_mm, (off_mm - Vec3::UnitZ()).normalized()}, true, 1e-3});
      }
    }
  }
  return inputs;
}

Session milled_ball() {
  const Vec3 entry_mm = kMappedBall.centre_mm + kMappedBall.radius_mm * Vec3::UnitZ();
  const DrillBit burr{4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  SessionSetup setup;
  setup.engine = EngineKind::voxel;
  setup.has_clearances = false;
  Session session(Bone(test::bake_ball(kMappedBall, 0.2)), {"pit", entry_mm, entry_mm - 3.0 * Vec3::UnitZ(), burr},
                  setup);
  session.run(pit(7));
  return session;
}

TEST(VoxelMap, HasWhatLivesWhereItLies) {
  const BoneModel bone = test::bake_ball(kMappedBall, 0.25);
  VoxelBone voxels(bone, {.voxel_mm = 0.2});
  make_voxel_engine(voxels, {4.0, 40.0, 2.0}, {})->step({kMappedBall.centre_mm, Vec3::UnitX()});
  const LabelVolume map = voxel_map(voxels);
  const test::TemporaryFolder folder;
  for (const char* name : {"voxels.nii.gz", "voxels.seg.nrrd"}) {
    SCOPED_TRACE(name);
    write_whole_file(folder.path() / name, encode_label_volume(map, name));
    const LabelVolume read =
        read_label_volume(folder.path() / name, map.geometry, {.convention = LabelConvention::any_names});
    EXPECT_EQ(read.names.at(1).name, "occupied bone");
    std::size_t occupied = 0;
    for (int k = 0; k < map.geometry.size[2]; ++k) {
      for (int j = 0; j < map.geometry.size[1]; ++j) {
        for (int i = 0; i < map.geometry.size[0]; ++i) {
          const Vec3 p_mm = map.geometry.to_patient(Vec3(i, j, k));
          const Vector3i voxel = (p_mm / 0.2).array().round().matrix().cast<int>();
          const bool is_occupied = voxels.is_occupied(voxel);
          ASSERT_EQ(read.labels[map.geometry.offset(i, j, k)] == 1, is_occupied) << p_mm.transpose();
          ASSERT_LT((voxels.centre_mm(voxel) - p_mm).norm(), 1e-9);
          occupied += is_occupied ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(occupied, voxels.occupied_count());
  }
  make_voxel_engine(voxels, {20.0, 40.0, 1.0}, {})->step({kMappedBall.centre_mm + Vec3(0, 0, 12), Vec3::UnitZ()});
  EXPECT_EQ(voxels.occupied_count(), 0U);
  EXPECT_THAT([&] { voxel_map(voxels); }, ThrowsMessage<Error>(HasSubstr("found none")));
}

TEST(VoxelMap, AgreesWithTheLiveMeshWithinAVoxelOfItEverywhere) {
  Session session = milled_ball();
  std::vector<std::shared_ptr<const SurfaceBlock>> blocks;
  for (const SurfaceUpdate& update : session.surface_changes()) {
    if (update.surface) blocks.push_back(update.surface);
  }
  const TriangleMesh mesh = join_blocks(blocks);
  const VoxelBone& voxels = *session.voxels();
  const double voxel_mm = voxels.voxel_mm();
  constexpr double kDisplayVoxelMm = 0.2;  // RemainingBoneOptions
  // Occupied voxels with a dead one beside them: the surface passes between the two.
  std::vector<Vec3> outermost_mm;
  voxels.for_each_occupied([&](const Vector3i& voxel) {
    for (int axis = 0; axis < 3; ++axis) {
      if (voxels.is_occupied(voxel + Vector3i::Unit(axis)) && voxels.is_occupied(voxel - Vector3i::Unit(axis)))
        continue;
      outermost_mm.push_back(voxels.centre_mm(voxel));
      break;
    }
  });
  ASSERT_GT(outermost_mm.size(), 20'000U);
  const MeshDistance to_mesh = detail::figures_of(detail::point_distances_mm(outermost_mm, mesh));
  EXPECT_LT(to_mesh.max_mm, kDisplayVoxelMm);
  EXPECT_LT(to_mesh.mean_mm, voxel_mm);
  // And no part of the mesh is where no voxel is near: a voxel's diagonal, and what the mesh may be off.
  const PointTree tree(outermost_mm);
  std::vector<double> to_voxels_mm;
  for (const Eigen::Vector3f& vertex_mm : mesh.vertices_mm) {
    to_voxels_mm.push_back(tree.nearest(vertex_mm.cast<double>()).distance_mm);
  }
  const MeshDistance to_voxels = detail::figures_of(to_voxels_mm);
  EXPECT_LT(to_voxels.max_mm, std::sqrt(3.0) * voxel_mm + 0.25 * kDisplayVoxelMm);
  // The pit is there: the middle of its floor has gone by 2 mm.
  const Vec3 was_mm = kMappedBall.centre_mm + (kMappedBall.radius_mm - 1.0) * Vec3::UnitZ();
  EXPECT_GT(detail::point_distances_mm(std::span(&was_mm, 1), mesh)[0], 0.7);
}

}  // namespace
}  // namespace spinaltap
