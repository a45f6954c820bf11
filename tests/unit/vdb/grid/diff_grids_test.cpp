#include "vdb/grid/diff_grids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/temporary_folder.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using openvdb::Coord;
using openvdb::CoordBBox;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Index = std::array<int, 3>;

class DiffGrids : public testing::Test {
 protected:
  void SetUp() override { initialize_openvdb(); }

  /// A cube of 4 x 4 x 4 voxels of 2.5 from (low, low, low) on, 0 around it; voxels of 0.5 mm.
  static openvdb::FloatGrid::Ptr cube(int low = 0, const char* name = "density") {
    auto grid = openvdb::FloatGrid::create(0.0F);
    grid->setName(name);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    for (const Coord& voxel : CoordBBox(Coord(low), Coord(low + 3))) grid->tree().setValue(voxel, 2.5F);
    return grid;
  }

  fs::path file(const char* name, const openvdb::GridPtrVec& grids) const {
    const fs::path path = folder_.path() / name;
    openvdb::io::File out(path.string());
    out.write(grids);
    out.close();
    return path;
  }

  std::vector<GridDifference> diff(const openvdb::GridPtrVec& a, const openvdb::GridPtrVec& b,
                                   double tolerance = 0.0) const {
    return diff_grids(file("a.vdb", a), file("b.vdb", b), {.tolerance = tolerance});
  }

  test::TemporaryFolder folder_;
};

TEST_F(DiffGrids, FindsNothingBetweenEqualGrids) {
  const auto grids = diff({cube()}, {cube()});
  ASSERT_EQ(grids.size(), 1U);
  const GridDifference& grid = grids[0];
  EXPECT_EQ(grid.name, "density");
  EXPECT_TRUE(grid.in_a && grid.in_b && grid.same && grid.same_transform && grid.same_background);
  EXPECT_EQ(grid.a, (ActiveVoxels{64, {0, 0, 0}, {3, 3, 3}}));
  EXPECT_EQ(grid.b, grid.a);
  EXPECT_EQ(grid.compared, 64U);
  EXPECT_EQ(grid.different + grid.inactive_different + grid.only_in_a + grid.only_in_b, 0U);
  EXPECT_EQ(grid.l1 + grid.l2 + grid.linf, 0.0);
  EXPECT_FALSE(grid.first);
  EXPECT_THAT(grid.metadata, testing::IsEmpty());
}

TEST_F(DiffGrids, MeasuresOneVoxelChangedByAHalf) {
  const auto changed = cube();
  changed->tree().setValue(Coord(1, 3, 2), 3.0F);
  const GridDifference grid = diff({cube()}, {changed})[0];
  EXPECT_FALSE(grid.same);
  EXPECT_EQ(grid.different, 1U);
  EXPECT_EQ(grid.l1, 0.5 / 64.0);
  EXPECT_EQ(grid.l2, 0.5 / 8.0);
  EXPECT_EQ(grid.linf, 0.5);
  ASSERT_TRUE(grid.first);
  EXPECT_EQ(grid.first->index, (Index{1, 3, 2}));
  EXPECT_EQ(grid.first->position_mm, Vec3(0.5, 1.5, 1.0));
  EXPECT_EQ(grid.first->a, 2.5F);
  EXPECT_EQ(grid.first->b, 3.0F);
  EXPECT_TRUE(diff({cube()}, {changed}, 0.5)[0].same);
  EXPECT_FALSE(diff({cube()}, {changed}, 0.499)[0].same);
}

TEST_F(DiffGrids, CountsTheVoxelsOfAShiftedGrid) {
  // Two cubes of 64 that share 3 x 3 x 3.
  const GridDifference grid = diff({cube(0)}, {cube(1)})[0];
  EXPECT_EQ(grid.b, (ActiveVoxels{64, {1, 1, 1}, {4, 4, 4}}));
  EXPECT_EQ(grid.only_in_a, 64U - 27U);
  EXPECT_EQ(grid.only_in_b, 64U - 27U);
  EXPECT_EQ(grid.compared, 64U + 37U);
  EXPECT_EQ(grid.different, 74U);
  EXPECT_NEAR(grid.l1, 2.5 * 74.0 / 101.0, 1e-15);
  EXPECT_NEAR(grid.l2, 2.5 * std::sqrt(74.0 / 101.0), 1e-15);
  EXPECT_EQ(grid.linf, 2.5);
  EXPECT_EQ(grid.first->index, (Index{0, 0, 0}));
  EXPECT_FALSE(grid.same);
}

TEST_F(DiffGrids, FindsTheFirstVoxelByXThenYThenZ) {
  const auto changed = cube();
  for (const Coord& voxel : {Coord(0, 3, 3), Coord(1, 0, 0), Coord(0, 3, 1)}) changed->tree().setValue(voxel, 0.0F);
  // Another leaf, further down.
  changed->tree().setValue(Coord(-1, 100, 100), 1.0F);
  EXPECT_EQ(diff({cube()}, {changed})[0].first->index, (Index{-1, 100, 100}));
  EXPECT_EQ(diff({changed}, {cube()})[0].first->index, (Index{-1, 100, 100}));
  changed->tree().setValueOff(Coord(-1, 100, 100), 0.0F);
  EXPECT_EQ(diff({cube()}, {changed})[0].first->index, (Index{0, 3, 1}));
}

TEST_F(DiffGrids, NamesGridsThatOneFileLacks) {
  const auto grids = diff({cube(0, "b"), cube(0, "a")}, {cube(0, "b"), cube(0, "c"), cube(0, "b")});
  ASSERT_EQ(grids.size(), 4U);
  EXPECT_EQ(grids[0].name, "a");
  EXPECT_TRUE(grids[0].in_a && !grids[0].in_b && !grids[0].same);
  EXPECT_TRUE(grids[1].same);
  EXPECT_EQ(grids[2].name, "b (2)");
  EXPECT_FALSE(grids[2].in_a);
  EXPECT_EQ(grids[3].name, "c");
  EXPECT_TRUE(grids[3].in_b && !grids[3].in_a && !grids[3].same);
  EXPECT_EQ(grids[3].b.count, 64U);
}

TEST_F(DiffGrids, SeesTransformBackgroundAndMetadata) {
  const auto other = cube();
  other->setTransform(openvdb::math::Transform::createLinearTransform(0.51));
  EXPECT_FALSE(diff({cube()}, {other})[0].same_transform);
  EXPECT_FALSE(diff({cube()}, {other}, 10.0)[0].same);
  const auto raised = cube();
  raised->tree().root().setBackground(0.25F, false);
  EXPECT_FALSE(diff({cube()}, {raised})[0].same_background);
  EXPECT_FALSE(diff({cube()}, {raised})[0].same);
  const auto noted = cube();
  noted->insertMeta("who", openvdb::StringMetadata("me"));
  EXPECT_THAT(diff({cube()}, {noted})[0].metadata, ElementsAre("who"));
  EXPECT_TRUE(diff({cube()}, {noted})[0].same);
}

TEST_F(DiffGrids, TakesANumberThatIsNoneAsDifferent) {
  const auto broken = cube();
  broken->tree().setValue(Coord(2, 2, 2), std::numeric_limits<float>::quiet_NaN());
  for (const auto& grid : {diff({broken}, {cube()}, 100.0)[0], diff({broken}, {broken}, 100.0)[0]}) {
    EXPECT_FALSE(grid.same);
    EXPECT_EQ(grid.different, 1U);
    EXPECT_EQ(grid.first->index, (Index{2, 2, 2}));
    EXPECT_EQ(grid.linf, 0.0);
  }
}

TEST_F(DiffGrids, NeedsTheSameActiveVoxelsWithoutATolerance) {
  const auto fewer = cube();
  fewer->tree().setValueOff(Coord(1, 1, 1));
  const GridDifference grid = diff({cube()}, {fewer})[0];
  EXPECT_EQ(grid.only_in_a, 1U);
  EXPECT_EQ(grid.different, 0U);
  EXPECT_FALSE(grid.same);
  EXPECT_TRUE(diff({cube()}, {fewer}, 1e-6)[0].same);
}

TEST_F(DiffGrids, ComparesTilesWithVoxelsAndTilesOfAnotherSize) {
  // One box of 256^3 voxels, as large tiles, as leaves of equal values, and with one leaf that differs.
  const CoordBBox box(Coord(0), Coord(255));
  const std::uint64_t voxels = std::uint64_t{256} * 256 * 256;
  const auto tiles = openvdb::FloatGrid::create(0.0F);
  tiles->setName("density");
  tiles->fill(box, 1.0F);
  const auto mixed = tiles->deepCopy();
  mixed->tree().touchLeaf(Coord(128, 8, 8));
  const GridDifference same = diff({tiles}, {mixed})[0];
  EXPECT_TRUE(same.same);
  EXPECT_EQ(same.compared, voxels);
  mixed->tree().setValue(Coord(128, 8, 9), 5.0F);
  for (const auto& grid : {diff({tiles}, {mixed})[0], diff({mixed}, {tiles})[0]}) {
    EXPECT_EQ(grid.compared, voxels);
    EXPECT_EQ(grid.different, 1U);
    EXPECT_EQ(grid.l1, 4.0 / static_cast<double>(voxels));
    EXPECT_EQ(grid.first->index, (Index{128, 8, 9}));
  }
}

TEST_F(DiffGrids, SeesAnInsideThatIsOutsideInTheOther) {
  // Inactive tiles carry a level set's sign.
  const auto inside = cube();
  inside->tree().addTile(1, Coord(64, 64, 64), -0.75F, false);
  const GridDifference grid = diff({inside}, {cube()})[0];
  EXPECT_EQ(grid.different, 0U);
  EXPECT_EQ(grid.inactive_different, 512U);
  EXPECT_FALSE(grid.same);
}

TEST_F(DiffGrids, RejectsFilesItCannotReadAndTolerancesThatAreNone) {
  const fs::path good = file("good.vdb", {cube()});
  const fs::path cut = folder_.path() / "cut.vdb";
  const std::string whole = read_whole_file(good);
  std::ofstream(cut, std::ios::binary) << whole.substr(0, whole.size() - 1);
  const auto whole_numbers = openvdb::Int32Grid::create(0);
  whole_numbers->setName("density");
  const fs::path other = file("other.vdb", {whole_numbers});
  EXPECT_THAT([&] { diff_grids(good, folder_.path() / "none.vdb"); }, ThrowsMessage<Error>(HasSubstr("no such file")));
  EXPECT_THAT([&] { diff_grids(cut, good); }, ThrowsMessage<Error>(HasSubstr("cut.vdb")));
  EXPECT_THAT([&] { diff_grids(good, other); }, ThrowsMessage<Error>(HasSubstr("floats")));
  for (const double tolerance : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT([&] { diff_grids(good, good, {.tolerance = tolerance}); },
                ThrowsMessage<Error>(HasSubstr("tolerance")));
  }
}

}  // namespace
}  // namespace spinaltap
