#include "vdb/detail/grid_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A bone with the given grid of CT numbers, and a distance grid that is not looked at.
BoneModel bone_of(const openvdb::FloatGrid::Ptr& hu) {
  auto sdf = openvdb::FloatGrid::create(0.75F);
  sdf->tree().setValue(Coord(0, 0, 0), 0.1F);
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = sdf;
  grids->hu = hu;
  return BoneModel(grids);
}

openvdb::math::Transform::Ptr oblique_transform() {
  const Mat3 axes = (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.3, Vec3::UnitY()) *
                     Eigen::AngleAxisd(1.1, Vec3::UnitZ()))
                        .toRotationMatrix() *
                    Vec3(0.6, 0.5, 2.0).asDiagonal();
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[row][column] = axes(column, row);
  }
  matrix[3][0] = 100.0;
  matrix[3][1] = -40.0;
  matrix[3][2] = -700.0;
  return openvdb::math::Transform::createLinearTransform(matrix);
}

std::vector<openvdb::math::Transform::Ptr> every_kind_of_transform() {
  const auto scale = openvdb::math::Transform::createLinearTransform(0.3);
  const auto moved = openvdb::math::Transform::createLinearTransform(0.7);
  moved->postTranslate(openvdb::Vec3d(13.1, -7.3, 250.9));
  openvdb::Mat4d stretched = openvdb::Mat4d::identity();
  stretched[0][0] = 0.35;
  stretched[1][1] = 0.35;
  stretched[2][2] = -0.5;
  const auto turned = openvdb::math::Transform::createLinearTransform(stretched);
  const auto shift = openvdb::math::Transform::createLinearTransform(1.0);
  shift->postTranslate(openvdb::Vec3d(0.1, 0.2, 0.3));
  return {scale, moved, turned, shift, oblique_transform()};
}

/// Random leaves, tiles and holes on both sides of index 0.
openvdb::FloatGrid::Ptr ragged_grid(const openvdb::math::Transform::Ptr& transform) {
  std::mt19937_64 random(11);
  std::uniform_int_distribution<int> place(-40, 40);
  std::uniform_real_distribution<float> value(-1000.0F, 3000.0F);
  auto grid = openvdb::FloatGrid::create(-1024.0F);
  grid->setTransform(transform);
  grid->fill(CoordBBox(Coord(-16, -16, -16), Coord(15, 15, 15)), 250.0F);
  grid->tree().addTile(1, Coord(32, -24, 8), -3.5F, false);
  for (int i = 0; i < 20000; ++i)
    grid->tree().setValue(Coord(place(random), place(random), place(random)), value(random));
  return grid;
}

std::vector<Vec3> random_points(const openvdb::FloatGrid& grid, std::size_t count) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> place(-60.0, 60.0);
  std::vector<Vec3> points_mm;
  while (points_mm.size() < count) {
    points_mm.push_back(
        detail::from_vdb(grid.indexToWorld(openvdb::Vec3d(place(random), place(random), place(random)))));
  }
  return points_mm;
}

TEST(LinearSampler, EqualsOpenVdbsBoxSamplerBitForBit) {
  initialize_openvdb();
  for (const auto& transform : every_kind_of_transform()) {
    const openvdb::FloatGrid::Ptr grid = ragged_grid(transform);
    std::vector<Vec3> points_mm = random_points(*grid, 100000);
    // Voxel centres and the faces between blocks.
    for (int i = -48; i <= 48; ++i) {
      points_mm.push_back(detail::from_vdb(grid->indexToWorld(Coord(i, -i, i))));
      points_mm.push_back(detail::from_vdb(grid->indexToWorld(openvdb::Vec3d(0.5 * i, 3.0, 7.5))));
    }
    std::vector<float> unused(points_mm.size());
    std::vector<float> values(points_mm.size());
    const BoneModel bone = bone_of(grid);
    bone.sample(points_mm, unused, values);
    const auto accessor = grid->getConstAccessor();
    const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler> sampler(
        accessor, *transform);
    std::size_t different = 0;
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      different += values[i] == sampler.wsSample(detail::to_vdb(points_mm[i])) ? 0U : 1U;
    }
    EXPECT_EQ(different, 0U) << transform->mapType();
  }
}

/// A grid that holds a function of patient space in 48 x 40 x 32 voxels.
openvdb::FloatGrid::Ptr grid_of(const std::function<double(const Vec3&)>& function,
                                const openvdb::math::Transform::Ptr& transform) {
  auto grid = openvdb::FloatGrid::create(-1024.0F);
  grid->setTransform(transform);
  for (const Coord& voxel : CoordBBox(Coord(-20, -20, -8), Coord(27, 19, 23))) {
    grid->tree().setValue(voxel, static_cast<float>(function(detail::from_vdb(grid->indexToWorld(voxel)))));
  }
  return grid;
}

/// Points whose stencils all lie within that grid.
std::vector<Vec3> points_within(const openvdb::FloatGrid& grid) {
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> x(-18.4, 25.4);
  std::uniform_real_distribution<double> y(-18.4, 17.4);
  std::uniform_real_distribution<double> z(-6.4, 21.4);
  std::vector<Vec3> points_mm;
  while (points_mm.size() < 5000) {
    points_mm.push_back(detail::from_vdb(grid.indexToWorld(openvdb::Vec3d(x(random), y(random), z(random)))));
  }
  return points_mm;
}

void expect_function(const openvdb::FloatGrid::Ptr& grid, const std::function<double(const Vec3&)>& function,
                     const std::function<Vec3(const Vec3&)>& gradient, Interpolation interpolation) {
  const BoneModel bone = bone_of(grid);
  const std::vector<Vec3> points_mm = points_within(*grid);
  std::vector<float> values(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  bone.hu(points_mm, values, gradients, interpolation);
  double worst_value = 0.0;
  double worst_gradient = 0.0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    worst_value = std::max(worst_value, std::abs(static_cast<double>(values[i]) - function(points_mm[i])));
    worst_gradient = std::max(worst_gradient, (gradients[i] - gradient(points_mm[i])).norm());
  }
  // Voxels of some hundred HU are rounded to floats: 3e-5 HU each, over half a mm and more.
  EXPECT_LT(worst_value, 2e-4) << grid->transform().mapType();
  EXPECT_LT(worst_gradient, 1e-3) << grid->transform().mapType();
}

TEST(LinearSampler, IsExactForLinearFunctionsOnEveryTransform) {
  initialize_openvdb();
  for (const auto& transform : every_kind_of_transform()) {
    const Vec3 centre = detail::from_vdb(transform->indexToWorld(openvdb::Vec3d(0.0)));
    const Vec3 slope(3.0, -4.0, 2.0);
    expect_function(
        grid_of([&](const Vec3& p) { return 20.0 + slope.dot(p - centre); }, transform),
        [&](const Vec3& p) { return 20.0 + slope.dot(p - centre); }, [&](const Vec3&) { return slope; },
        Interpolation::linear);
  }
}

TEST(QuadraticSampler, IsExactForQuadraticFunctionsOnEveryTransform) {
  initialize_openvdb();
  for (const auto& transform : every_kind_of_transform()) {
    const Vec3 centre = detail::from_vdb(transform->indexToWorld(openvdb::Vec3d(0.0)));
    Mat3 bend;
    bend << 0.30, 0.10, -0.05, 0.10, -0.20, 0.08, -0.05, 0.08, 0.15;
    const Vec3 slope(3.0, -4.0, 2.0);
    const auto function = [&](const Vec3& p) {
      return 20.0 + slope.dot(p - centre) + 0.5 * (p - centre).dot(bend * (p - centre));
    };
    expect_function(
        grid_of(function, transform), function, [&](const Vec3& p) -> Vec3 { return slope + bend * (p - centre); },
        Interpolation::quadratic);
  }
}

TEST(GridSampler, FindsTheBackgroundFarAwayAndWhereThereIsNoNumber) {
  initialize_openvdb();
  for (const auto& transform : every_kind_of_transform()) {
    const BoneModel bone = bone_of(ragged_grid(transform));
    std::vector<Vec3> points_mm{Vec3(kNan, 0.0, 0.0),      Vec3(0.0, kNan, 0.0),   Vec3(0.0, 0.0, kNan),
                                Vec3(kInfinity, 0.0, 0.0), Vec3(0.0, -1e300, 0.0), Vec3(0.0, 0.0, -kInfinity),
                                Vec3(1e9, 1e9, 1e9),       Vec3(-1e6, 3e9, 5e18)};
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::quadratic}) {
      std::vector<float> distance_mm(points_mm.size());
      std::vector<float> hu(points_mm.size());
      std::vector<Vec3> gradients(points_mm.size(), Vec3::Ones());
      bone.distance(points_mm, distance_mm, gradients, interpolation);
      EXPECT_THAT(distance_mm, testing::Each(0.75F));
      EXPECT_THAT(gradients, testing::Each(Vec3(0.0, 0.0, 0.0)));
      bone.hu(points_mm, hu, {}, interpolation);
      EXPECT_THAT(hu, testing::Each(-1024.0F));
    }
    std::vector<std::uint8_t> inside(points_mm.size(), 7);
    bone.inside(points_mm, inside);
    EXPECT_THAT(inside, testing::Each(std::uint8_t{0}));
    std::vector<Vec3> normals(points_mm.size(), Vec3::Ones());
    bone.normals(points_mm, normals);
    EXPECT_THAT(normals, testing::Each(Vec3(0.0, 0.0, 0.0)));
  }
}

TEST(GridSampler, TakesAnEmptyGridAsBackground) {
  const BoneModel bone = bone_of(openvdb::FloatGrid::create(-1024.0F));
  const std::vector<Vec3> points_mm{Vec3::Zero(), Vec3(4.0, -1.0, 0.5)};
  std::vector<float> hu(2);
  bone.hu(points_mm, hu, {}, Interpolation::quadratic);
  EXPECT_THAT(hu, testing::Each(-1024.0F));
}

TEST(GridSampler, RejectsAGridThatIsSpreadThinlyOverAHugeBox) {
  initialize_openvdb();
  for (const int far : {20000, 1 << 27, 1 << 30, std::numeric_limits<int>::max()}) {
    const auto grid = openvdb::FloatGrid::create(-1024.0F);
    grid->tree().setValue(Coord(0, 0, 0), 5.0F);
    grid->tree().setValue(Coord(far, far, far), 5.0F);
    EXPECT_THAT([&] { bone_of(grid); }, ThrowsMessage<Error>(HasSubstr("grid hu"))) << far;
  }
}

}  // namespace
}  // namespace spinaltap
