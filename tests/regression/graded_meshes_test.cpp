// Grades of screws with heads on real lumbar vertebrae, against brute force over a dense sampling of their surfaces.
// See tests/support/test_data.h for where the meshes lie.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/point_tree.h"
#include "core/grading/instrument.h"
#include "core/tool/bit_profile.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

constexpr double kBruteMm = 0.05;

/// The surface as places about 0.08 mm apart, each drawn onto it by Newton's method, and whether they are the canal's.
struct DenseSurface {
  std::vector<Vec3> points_mm;
  std::vector<bool> is_canal;
};

DenseSurface dense_surface(const Bone& bone, const Box3& box) {
  constexpr double kStepMm = 0.08;
  constexpr int kAside = 1;
  const BoneShape& shape = bone.shape();
  DenseSurface dense;
  for (std::size_t n = 0; n < shape.points_mm().size(); ++n) {
    if (!box.contains(shape.points_mm()[n])) continue;
    const Vec3 u = any_perpendicular(shape.normals()[n]), v = shape.normals()[n].cross(u);
    std::vector<Vec3> places_mm;
    for (int i = -kAside; i <= kAside; ++i) {
      for (int j = -kAside; j <= kAside; ++j) places_mm.push_back(shape.points_mm()[n] + kStepMm * (i * u + j * v));
    }
    std::vector<double> values_mm(places_mm.size());
    std::vector<Vec3> gradients(places_mm.size());
    shape.surface().evaluate(places_mm, values_mm, gradients);
    for (std::size_t k = 0; k < places_mm.size(); ++k) {
      if (!(gradients[k].squaredNorm() > 0.01)) continue;
      dense.points_mm.push_back(places_mm[k] - values_mm[k] / gradients[k].squaredNorm() * gradients[k]);
      dense.is_canal.push_back(bone.landmarks().is_canal_wall[n] != 0);
    }
  }
  return dense;
}

/// The least signed distance from the surface to a body: of places 0.05 mm apart around those samples that may hold it.
double nearest_mm(const Bone& bone, const BodyBehind& body) {
  constexpr double kStepMm = 0.05, kMayMm = 0.5;
  constexpr int kAside = 3;
  const BitProfile profile(body.outline);
  const BoneShape& shape = bone.shape();
  const auto distance_mm = [&](const Vec3& p_mm) { return bit_distance_mm(profile, body.pose, p_mm); };
  double coarse_mm = std::numeric_limits<double>::infinity();
  for (const Vec3& p_mm : shape.points_mm()) coarse_mm = std::min(coarse_mm, distance_mm(p_mm));
  double nearest = coarse_mm;
  for (std::size_t n = 0; n < shape.points_mm().size(); ++n) {
    if (distance_mm(shape.points_mm()[n]) > coarse_mm + kMayMm) continue;
    const Vec3 u = any_perpendicular(shape.normals()[n]), v = shape.normals()[n].cross(u);
    for (int i = -kAside; i <= kAside; ++i) {
      for (int j = -kAside; j <= kAside; ++j) {
        const Vec3 place_mm = shape.points_mm()[n] + kStepMm * (i * u + j * v);
        double value_mm = 0.0;
        Vec3 gradient = Vec3::Zero();
        shape.surface().evaluate({&place_mm, 1}, {&value_mm, 1}, {&gradient, 1});
        if (!(gradient.squaredNorm() > 0.01)) continue;
        nearest = std::min(nearest, distance_mm(place_mm - value_mm / gradient.squaredNorm() * gradient));
      }
    }
  }
  return nearest;
}

/// How far the screw's surface stands out of bone from a depth on, of places 0.1 mm and 2 degrees apart.
double breach_by_brute_force_mm(const Bone& bone, const PointTree& surface, const DrillPath& path, double from_mm) {
  const BitProfile profile(path.screw->outline());
  const Vec3 axis = path.direction(), u = any_perpendicular(axis), v = axis.cross(u);
  double breach_mm = 0.0;
  for (double depth_mm = from_mm; depth_mm <= path.length_mm() + 1e-9; depth_mm += 0.1) {
    const double radius_mm = std::max(0.0, profile.widest_mm(0.0, path.length_mm() - depth_mm));
    for (int degree = 0; degree < 360; degree += 2) {
      const double angle = degree * kDegree;
      const Vec3 p_mm = path.entry_mm + depth_mm * axis + radius_mm * (std::cos(angle) * u + std::sin(angle) * v);
      if (bone.shape().lattice_mm(p_mm) < -1.0 || bone.shape().is_inside(p_mm)) continue;
      breach_mm = std::max(breach_mm, surface.nearest(p_mm).distance_mm);
    }
  }
  return breach_mm;
}

class GradedMeshes : public testing::TestWithParam<std::size_t> {};

WHOLE_RUNS("GradedMeshes.*");

TEST_P(GradedMeshes, AgreeWithBruteForceWithHeadsAndShanks) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const std::unique_ptr<Solid> solid = make_mesh_solid(test::read_in_lps(real), {.voxel_mm = 0.25});
  const Bone bone(bake_solid(*solid, {}, 40.0));
  const Landmarks& marks = bone.landmarks();
  double worst_mm = 0.0;
  for (const PedicleLandmarks* pedicle : {&marks.left_pedicle, &marks.right_pedicle}) {
    for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(3, 0, 1), Vec3(-4, 0, -2), Vec3(0, 0, 5)}) {
      // Along the pedicle's axis, shifted and a little turned, from where its axis enters bone behind.
      const Vec3 axis = (pedicle->axis + 0.02 * shift.z() * pedicle->height_axis).normalized();
      const Vec3 crossing_mm = pedicle->isthmus_mm + shift.x() * pedicle->width_axis + shift.z() * pedicle->height_axis;
      double behind_mm = 0.0;
      while (behind_mm < 25.0 && bone.shape().is_inside(crossing_mm - behind_mm * axis)) behind_mm += 0.05;
      DrillPath path{"", crossing_mm - behind_mm * axis, crossing_mm + (40.0 - behind_mm) * axis, {}};
      path.screw = PedicleScrew{"", 5.5, 40.0, 4.0};
      const PathGrade graded = grade(bone, path);
      Box3 box(path.entry_mm - Vec3::Constant(18.0), path.entry_mm + Vec3::Constant(18.0));
      box.extend(Box3(path.target_mm - Vec3::Constant(8.0), path.target_mm + Vec3::Constant(8.0)));
      const DenseSurface surface = dense_surface(bone, box);
      SCOPED_TRACE(std::string(real.name) + ", shifted by " + std::to_string(shift.x()) + ", " +
                   std::to_string(shift.z()));
      const auto expect_near = [&](double found, double known, const char* what) {
        EXPECT_NEAR(found, known, kBruteMm) << what;
        if (std::isfinite(found) && std::isfinite(known)) worst_mm = std::max(worst_mm, std::abs(found - known));
      };
      expect_near(graded.instrument.head_clearance_mm, nearest_mm(bone, *head_of(path)), "head");
      const double driver_mm = nearest_mm(bone, *driver_of(path));
      if (driver_mm < 20.0) expect_near(graded.instrument.driver_clearance_mm, driver_mm, "driver");
      // The way in: a cylinder as wide as the thread, from the end of the entry opening backwards.
      double cut_mm = 0.0;
      for (const Vec3& p_mm : surface.points_mm) {
        const Vec3 from_mm = p_mm - path.entry_mm;
        const double along_mm = from_mm.dot(axis);
        const double beyond_mm = -opening_limit_mm(2.75) - along_mm;
        const double in_mm = 2.75 - (from_mm - along_mm * axis).norm();
        if (beyond_mm > 0.0 && along_mm > -60.0) cut_mm = std::max(cut_mm, std::min(in_mm, beyond_mm));
      }
      expect_near(graded.instrument.cut_behind_mm, cut_mm, "way in");
      const double breach_mm =
          breach_by_brute_force_mm(bone, PointTree(surface.points_mm), path, graded.opening_end_mm);
      // Beyond the canal's wall places of the entry opening count too, which brute force leaves out.
      if (graded.breach_depth_mm >= graded.opening_end_mm || graded.breach_mm == 0.0) {
        expect_near(graded.breach_mm, breach_mm, "breach");
      }
      // The canal's wall: how near it is to the thread, where it is near.
      const BitProfile thread(path.screw->outline());
      double canal_mm = std::numeric_limits<double>::infinity();
      for (std::size_t n = 0; n < surface.points_mm.size(); ++n) {
        if (!surface.is_canal[n]) continue;
        canal_mm = std::min(canal_mm, bit_distance_mm(thread, {path.target_mm, axis}, surface.points_mm[n]));
      }
      if (graded.breach_mm == 0.0 && canal_mm < 3.0) expect_near(graded.canal.clearance_mm, canal_mm, "canal");
      EXPECT_EQ(std::min(graded.outer.clearance_mm, graded.canal.clearance_mm) < 0.0, graded.breach_mm > 0.0);
    }
  }
  std::printf("%s: at most %.3f mm off\n", real.name, worst_mm);
}

INSTANTIATE_TEST_SUITE_P(All, GradedMeshes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

}  // namespace
}  // namespace spinaltap
