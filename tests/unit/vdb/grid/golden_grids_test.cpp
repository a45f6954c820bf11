// Baked grids against figures in data/golden/: number and box of the active voxels exactly, norms to 1e-6. A change of
// baking shows here first. Where the change is wanted, this writes the new figures, to be looked at and committed:
//
//     SPINALTAP_WRITE_GOLDEN=1 build/bin/test_vdb --gtest_filter='Grids/GoldenGrid.*'

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/files/json_file.h"
#include "core/phantom/vertebra.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"
#include "tests/support/test_paths.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace {

using test::kBall;
using test::kTorus;

/// Of the active voxels of a distance grid.
struct Figures {
  std::uint64_t active_voxels = 0;
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  double l1_mm = 0.0;  ///< mean of |distance|
  double l2_mm = 0.0;  ///< root mean square
  double linf_mm = 0.0;
};

Figures measure(const BoneModel& bone) {
  const openvdb::FloatGrid& grid = *bone.grids().sdf;
  Figures figures;
  figures.active_voxels = grid.activeVoxelCount();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    figures.low[axis] = box.min()[axis];
    figures.high[axis] = box.max()[axis];
  }
  double sum = 0.0;
  double squares = 0.0;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    const double value_mm = std::abs(static_cast<double>(*voxel));
    sum += value_mm * static_cast<double>(voxel.getVoxelCount());
    squares += value_mm * value_mm * static_cast<double>(voxel.getVoxelCount());
    figures.linf_mm = std::max(figures.linf_mm, value_mm);
  }
  figures.l1_mm = sum / static_cast<double>(figures.active_voxels);
  figures.l2_mm = std::sqrt(squares / static_cast<double>(figures.active_voxels));
  return figures;
}

struct GoldenCase {
  const char* name;
  std::function<BoneModel()> bake;
};

class GoldenGrid : public testing::TestWithParam<GoldenCase> {};

TEST_P(GoldenGrid, HasTheFiguresOnRecord) {
  if (std::string(GetParam().name) == "phantom") RELEASE_ONLY();
  const BoneModel bone = GetParam().bake();
  const Figures found = measure(bone);
  const auto file =
      std::filesystem::path(test::kSourceFolder) / "data/golden" / (std::string(GetParam().name) + ".json");
  if (std::getenv("SPINALTAP_WRITE_GOLDEN") != nullptr) {
    write_json({{"grid", "sdf"},
                {"voxel_mm", bone.voxel_mm()},
                {"active_voxels", found.active_voxels},
                {"low", found.low},
                {"high", found.high},
                {"l1_mm", found.l1_mm},
                {"l2_mm", found.l2_mm},
                {"linf_mm", found.linf_mm}},
               file);
  }
  const Json record = read_json(file);
  EXPECT_EQ(found.active_voxels, record.at("active_voxels").get<std::uint64_t>());
  EXPECT_EQ(found.low, (record.at("low").get<std::array<int, 3>>()));
  EXPECT_EQ(found.high, (record.at("high").get<std::array<int, 3>>()));
  EXPECT_NEAR(found.l1_mm, record.at("l1_mm").get<double>(), 1e-6 * found.l1_mm);
  EXPECT_NEAR(found.l2_mm, record.at("l2_mm").get<double>(), 1e-6 * found.l2_mm);
  EXPECT_NEAR(found.linf_mm, record.at("linf_mm").get<double>(), 1e-6 * found.linf_mm);
}

INSTANTIATE_TEST_SUITE_P(Grids, GoldenGrid,
                         testing::Values(GoldenCase{"ball", [] { return test::bake_ball(kBall); }},
                                         GoldenCase{"torus", [] { return test::bake_torus(kTorus); }},
                                         GoldenCase{"phantom",
                                                    [] { return bake_solid(Vertebra(), {.voxel_mm = 0.5}, 40.0); }}),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// The figures of a distance that is right, from geometry. Counting voxels of a smooth layer of some ten thousand is
/// good to a few in a thousand; baked distances may be a tenth of a voxel off at the band's edge, so the band 3% wider
/// or narrower.
void expect_figures(const Figures& found, double band_volume_mm3, double rms_mm, const Box3& band_box_mm,
                    double voxel_mm) {
  const double expected = band_volume_mm3 / std::pow(voxel_mm, 3);
  EXPECT_NEAR(static_cast<double>(found.active_voxels), expected, 0.035 * expected);
  EXPECT_NEAR(found.l2_mm, rms_mm, 0.03 * rms_mm);
  EXPECT_LE(found.linf_mm, 3.0 * voxel_mm);
  EXPECT_GT(found.linf_mm, 2.95 * voxel_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    EXPECT_NEAR(found.low[axis], std::ceil(band_box_mm.min()[at] / voxel_mm), 1.0);
    EXPECT_NEAR(found.high[axis], std::floor(band_box_mm.max()[at] / voxel_mm), 1.0);
  }
}

TEST(GoldenGrids, OfABallIsTheShellAroundIt) {
  const double b = 0.75;
  const double r = kBall.radius_mm;
  const double shell_mm3 = 4.0 / 3.0 * std::numbers::pi * (std::pow(r + b, 3) - std::pow(r - b, 3));
  // The mean of d² over a shell whose area grows as (r + d)².
  const double rms_mm = std::sqrt((r * r * b * b / 3.0 + std::pow(b, 4) / 5.0) / (r * r + b * b / 3.0));
  const Box3 box{kBall.bounds_mm().min().array() - b, kBall.bounds_mm().max().array() + b};
  expect_figures(measure(test::bake_ball(kBall)), shell_mm3, rms_mm, box, 0.25);
}

TEST(GoldenGrids, OfARingIsTheLayerAroundIt) {
  const double b = 0.75;
  const double t = kTorus.tube_mm;
  const double pi = std::numbers::pi;
  const double layer_mm3 = 2.0 * pi * pi * kTorus.ring_mm * ((t + b) * (t + b) - (t - b) * (t - b));
  const Box3 box{kTorus.bounds_mm().min().array() - b, kTorus.bounds_mm().max().array() + b};
  // The layer's area grows linearly with d, evenly on both sides.
  expect_figures(measure(test::bake_torus(kTorus)), layer_mm3, b / std::sqrt(3.0), box, 0.25);
}

}  // namespace
}  // namespace spinaltap
