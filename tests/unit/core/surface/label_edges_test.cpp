// Compiled with optimisation: long loops of its own.

#include "core/surface/label_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "core/ct/label_map.h"
#include "core/ct/read_ct.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

/// A bone without any symmetry: a body, an arch to one side, and two processes of unequal length. Below 0 inside.
double outside_mm(const Vec3& p) {
  const auto ellipsoid = [&](const Vec3& centre, const Vec3& half) {
    const Vec3 q = (p - centre).cwiseQuotient(half);
    return (q.norm() - 1.0) * half.minCoeff();
  };
  return std::min({ellipsoid(Vec3(0, -8, -2), Vec3(15, 11, 9)), ellipsoid(Vec3(6, 12, 7), Vec3(6, 15, 8)),
                   ellipsoid(Vec3(20, 4, 10), Vec3(15, 5, 5)), ellipsoid(Vec3(-13, 9, -7), Vec3(10, 8, 5))});
}

struct LabelledScan {
  CtVolume ct;
  BoneMask mask;
};

/// The bone in tissue with noise, and the mask of where it is, moved, grown, and seen through `turn`.
LabelledScan labelled_scan(double voxel_mm, const Vec3& moved_mm = Vec3::Zero(), double grown_mm = 0.0,
                           const std::function<Vec3(const Vec3&)>& turn = {}) {
  constexpr std::uint64_t kSeed = 11;
  GridGeometry geometry;
  const double half_mm = 48.0;
  const int side = static_cast<int>(std::lround(2.0 * half_mm / voxel_mm));
  geometry.size = {side, side, side * 2 / 3};
  geometry.spacing_mm = Vec3::Constant(voxel_mm);
  geometry.origin_mm = Vec3(-half_mm, -half_mm, -half_mm * 2 / 3);
  std::vector<std::int16_t> hu;
  BoneMask mask{geometry, {}};
  std::size_t n = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
        const double share = std::clamp(0.5 - outside_mm(p_mm) / std::max(1.2, voxel_mm), 0.0, 1.0);
        const double noise_hu = 120.0 * (random_uniform(kSeed, n++) - 0.5);
        hu.push_back(static_cast<std::int16_t>(std::lround(40.0 + 360.0 * share + noise_hu)));
        const Vec3 q_mm = turn ? turn(p_mm - moved_mm) : Vec3(p_mm - moved_mm);
        mask.inside.push_back(outside_mm(q_mm) < grown_mm ? 1 : 0);
      }
    }
  }
  return {make_ct_volume(geometry, std::move(hu)), std::move(mask)};
}

LabelEdges edges_of(const LabelledScan& made) { return find_label_edges(made.ct, made.mask); }

class LabelEdgesByVoxel : public testing::TestWithParam<double> {};

TEST_P(LabelEdgesByVoxel, FindsHowFarALabelWasMoved) {
  const double voxel_mm = GetParam();
  // A tenth of a voxel and of a millimetre: what was seen is a third of that.
  const double near_mm = 0.1 + 0.1 * voxel_mm;
  const LabelEdges in_place = edges_of(labelled_scan(voxel_mm));
  EXPECT_GT(in_place.on_edge, 0.8);
  EXPECT_LT(in_place.moved_mm.norm(), near_mm);
  for (const Vec3& moved_mm : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(-3, 2, 0), Vec3(12, 0, 0)}) {
    const LabelEdges edges = edges_of(labelled_scan(voxel_mm, moved_mm));
    EXPECT_LT((edges.moved_mm - moved_mm).norm(), near_mm) << moved_mm.transpose();
    EXPECT_GT(edges.on_edge, 0.8) << moved_mm.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, LabelEdgesByVoxel, testing::Values(0.8, 1.5));

TEST(LabelEdges, TakesALabelThatIsAVoxelTooLargeOrTooSmallForWhatItIs) {
  for (const double grown_mm : {-1.5, 1.5}) {
    const LabelEdges edges = edges_of(labelled_scan(1.5, Vec3::Zero(), grown_mm));
    EXPECT_GT(edges.on_edge, 0.7) << grown_mm;
    EXPECT_LT(edges.moved_mm.norm(), 0.3) << grown_mm;
    EXPECT_NEAR(edges.grown_mm, grown_mm, 0.7);
  }
}

TEST(LabelEdges, SeesALabelThatWasTurnedRound) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto turn = [axis](Vec3 p) {
      p[axis] = -p[axis];
      return p;
    };
    const LabelEdges edges = edges_of(labelled_scan(1.5, Vec3::Zero(), 0.0, turn));
    EXPECT_GT(edges.on_edge_mirrored[axis], 0.8);
    EXPECT_GT(edges.on_edge_mirrored[axis], edges.on_edge + 0.2);
    EXPECT_EQ(edges.on_edge_mirrored[axis], edges.on_edge_mirrored.maxCoeff());
  }
}

TEST(LabelEdges, FindsFewEdgesOfBoneUnderAnotherBonesLabel) {
  // The same bone, a quarter turned: as good as another's.
  const auto turn = [](const Vec3& p) { return Vec3(p.y(), -p.x(), p.z()); };
  EXPECT_LT(edges_of(labelled_scan(1.5, Vec3::Zero(), 0.0, turn)).on_edge, 0.42);
}

TEST(LabelEdges, SaysNothingOfALabelTooSmallToSay) {
  LabelledScan made = labelled_scan(1.5);
  for (std::size_t v = 0; v < made.mask.inside.size(); ++v) made.mask.inside[v] = 0;
  made.mask.inside[made.mask.geometry.offset(30, 30, 20)] = made.mask.inside[made.mask.geometry.offset(31, 30, 20)] = 1;
  made.mask.inside[made.mask.geometry.offset(30, 31, 20)] = made.mask.inside[made.mask.geometry.offset(30, 30, 21)] = 1;
  made.mask.inside[made.mask.geometry.offset(31, 31, 21)] = made.mask.inside[made.mask.geometry.offset(31, 31, 20)] = 1;
  EXPECT_EQ(edges_of(made).places, 0U);
}

TEST(LabelEdges, AgreeWithAPersonsLabelsOfARealL3) {
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume ct = read_ct(data / "dicom");
  for (const int label : {21, 22, 23}) {
    const LabelEdges edges =
        find_label_edges(ct, read_label_map(data / "sub-ct_seg-vert_label-22_msk.nii.gz", label, ct.geometry));
    EXPECT_GT(edges.on_edge, 0.7) << label;
    EXPECT_LT(edges.moved_mm.norm(), 0.6) << label;
    EXPECT_LT(edges.on_edge_mirrored.maxCoeff(), 0.5) << label;
  }
}

}  // namespace
}  // namespace spinaltap
