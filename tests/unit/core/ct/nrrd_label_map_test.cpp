#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/gzip.h"
#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/label_map.h"
#include "tests/support/error_of.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::voxel_count;
using testing::HasSubstr;

/// 3 x 2 x 2 voxels of 1 mm, voxel (0, 0, 0) at LPS (-10, -20, 30); label 5 at (2, 0, 0), 7 at (0, 0, 1).
struct HandMadeNrrd {
  std::string type = "unsigned char";
  std::string sizes = "3 2 2";
  std::string space = "space: left-posterior-superior\n";
  std::string directions = "(1,0,0) (0,1,0) (0,0,1)";
  std::string origin = "(-10,-20,30)";
  std::string encoding = "raw";
  std::string more = {};
  std::string voxels = std::string("\0\0\5\0\0\0\7\0\0\0\0\0", 12);
  std::string dimension = "3";

  std::string bytes() const {
    return "NRRD0004\n# by hand\ntype: " + type + "\ndimension: " + dimension + "\n" + space + "sizes: " + sizes +
           "\nspace directions: " + directions + "\nspace origin: " + origin + "\nencoding: " + encoding + "\n" + more +
           "\n" + voxels;
  }
};

GridGeometry nrrd_grid() {
  GridGeometry geometry;
  geometry.size = {3, 2, 2};
  geometry.origin_mm = Vec3(-10.0, -20.0, 30.0);
  return geometry;
}

BoneMask read_nrrd(const std::string& bytes, int label, const GridGeometry& geometry = nrrd_grid(),
                   const std::string& name = "labels.nrrd") {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / name, bytes);
  return read_label_map(folder.path() / name, label, geometry);
}

std::string nrrd_error(const HandMadeNrrd& nrrd, int label = 5) {
  return error_of([&] { read_nrrd(nrrd.bytes(), label); });
}

TEST(ReadNrrd, FindsALabelWhereItLies) {
  const BoneMask mask = read_nrrd(HandMadeNrrd{}.bytes(), 5);
  EXPECT_EQ(voxel_count(mask), 1);
  EXPECT_TRUE(mask.at(2, 0, 0));
  EXPECT_TRUE(read_nrrd(HandMadeNrrd{}.bytes(), 7).at(0, 0, 1));
}

TEST(ReadNrrd, TurnsRasAndLasIntoLps) {
  HandMadeNrrd ras;
  ras.space = "space: RAS\n";
  ras.directions = "(-1,0,0)(0,-1,0)(0,0,1)";  // also without blanks between
  ras.origin = "( 10, 20, 30 )";
  EXPECT_TRUE(read_nrrd(ras.bytes(), 5).at(2, 0, 0));
  HandMadeNrrd las;
  las.space = "space: left-anterior-superior\n";
  las.directions = "(1,0,0) (0,-1,0) (0,0,1)";
  las.origin = "(-10,20,30)";
  EXPECT_TRUE(read_nrrd(las.bytes(), 5).at(2, 0, 0));
}

TEST(ReadNrrd, ReadsGzipAndBothByteOrders) {
  HandMadeNrrd zipped;
  zipped.encoding = "gzip";
  zipped.voxels = gzip(zipped.voxels);
  EXPECT_TRUE(read_nrrd(zipped.bytes(), 5).at(2, 0, 0));
  HandMadeNrrd big;
  big.type = "uint16";
  big.more = "endian: big\n";
  big.voxels = std::string(24, '\0');
  big.voxels[4] = 1;
  big.voxels[5] = 2;
  EXPECT_TRUE(read_nrrd(big.bytes(), 258).at(2, 0, 0));
  big.more = "endian: little\n";
  EXPECT_TRUE(read_nrrd(big.bytes(), 513).at(2, 0, 0));
}

TEST(ReadNrrd, TakesOneLayerOf3DSlicerAndRejectsMore) {
  HandMadeNrrd layer;
  layer.sizes = "1 3 2 2";
  layer.dimension = "4";
  layer.directions = "none (1,0,0) (0,1,0) (0,0,1)";
  layer.more = "kinds: list domain domain domain\nSegment0_LabelValue:=5\nSegment0_Name:=L3: mine\n";
  EXPECT_TRUE(read_nrrd(layer.bytes(), 5, nrrd_grid(), "s.seg.nrrd").at(2, 0, 0));
  layer.sizes = "2 3 2 1";
  EXPECT_THAT(nrrd_error(layer), HasSubstr("one layer"));
}

TEST(ReadNrrd, TakesTheNearestVoxelOnAFinerGrid) {
  GridGeometry fine = nrrd_grid();
  fine.size = {12, 8, 8};
  fine.spacing_mm = Vec3::Constant(0.25);
  fine.origin_mm -= Vec3::Constant(0.375);  // four fine voxels fill each of the file's, along each axis
  EXPECT_EQ(voxel_count(read_nrrd(HandMadeNrrd{}.bytes(), 5, fine)), 64);
}

TEST(ReadNrrd, SaysWhatIsWrong) {
  EXPECT_THAT(nrrd_error({}, 6), HasSubstr("there are: 5, 7"));
  EXPECT_THAT(error_of([] { read_nrrd("not NRRD at all", 5); }), HasSubstr("expected an NRRD file"));
  EXPECT_THAT(error_of([] { read_nrrd("NRRD0004\ntype: uint8\n", 5); }), HasSubstr("empty line"));
  EXPECT_THAT(nrrd_error({.type = "block"}), HasSubstr("\"block\""));
  EXPECT_THAT(nrrd_error({.sizes = "3 2", .dimension = "2"}), HasSubstr("three NRRD axes"));
  EXPECT_THAT(nrrd_error({.sizes = "3 2"}), HasSubstr("as the dimension, \"3\", says, found \"3 2\""));
  // Without a blank behind the colon it is no field, to other readers neither: a skip that is passed over moves all.
  EXPECT_THAT(nrrd_error({.more = "byte skip:3\n"}), HasSubstr("found \"byte skip:3\""));
  EXPECT_THAT(nrrd_error({.sizes = "3 2 -2"}), HasSubstr("\"3 2 -2\""));
  EXPECT_THAT(nrrd_error({.sizes = "99999 99999 99999"}), HasSubstr("at most"));
  EXPECT_THAT(nrrd_error({.sizes = "900 900 900"}), HasSubstr("cut short"));
  EXPECT_THAT(nrrd_error({.space = ""}), HasSubstr("\"space\""));
  EXPECT_THAT(nrrd_error({.space = "space: scanner-xyz\n"}), HasSubstr("LPS, RAS or LAS"));
  EXPECT_THAT(nrrd_error({.directions = "(1,0,0) (0,1,0)"}), HasSubstr("three NRRD space directions"));
  EXPECT_THAT(nrrd_error({.directions = "(1,0,0) (0,1,0) (0,0,x)"}), HasSubstr("three numbers"));
  EXPECT_THAT(nrrd_error({.directions = "(1,0,0) (0,1,0) (1,1,0)"}), HasSubstr("volume"));
  EXPECT_THAT(nrrd_error({.origin = "(nan,0,0)"}), HasSubstr("NRRD"));
  EXPECT_THAT(nrrd_error({.encoding = "bzip2"}), HasSubstr("raw or gzip"));
  EXPECT_THAT(nrrd_error({.encoding = "gzip"}), HasSubstr("gzip stream"));
  EXPECT_THAT(nrrd_error({.more = "data file: other.raw\n"}), HasSubstr("no such file with the voxels"));
}

class WrittenLabelMap : public ::testing::TestWithParam<std::string> {};

TEST_P(WrittenLabelMap, ComesBackVoxelForVoxel) {
  constexpr std::uint64_t kSeed = 17;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  BoneMask mask;
  mask.geometry.size = {9, 7, 5};
  mask.geometry.spacing_mm = Vec3(0.352, 0.352, 0.5);
  mask.geometry.origin_mm = Vec3(-101.25, 33.7, -679.8);
  mask.geometry.directions = Eigen::AngleAxisd(0.6, Vec3(1, -2, 2).normalized()).toRotationMatrix();
  for (std::size_t v = 0; v < mask.geometry.voxel_count(); ++v) {
    mask.inside.push_back(random_uniform(kSeed, v) < 0.4 ? 1 : 0);
  }
  for (const int label : {1, 22, 300}) {
    const std::string bytes = encode_label_map(mask, label, GetParam());
    EXPECT_EQ(encode_label_map(mask, label, GetParam()), bytes);
    EXPECT_EQ(read_nrrd(bytes, label, mask.geometry, GetParam()).inside, mask.inside) << label;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, WrittenLabelMap,
                         ::testing::Values("map.nii", "map.nii.gz", "map.nrrd", "map.seg.nrrd"));

TEST(EncodeLabelMap, RejectsOtherNamesAndLabels) {
  const BoneMask mask{nrrd_grid(), std::vector<std::uint8_t>(12, 1)};
  EXPECT_THAT(error_of([&] { encode_label_map(mask, 1, "map.png"); }), HasSubstr("map.png"));
  EXPECT_THAT(error_of([&] { encode_label_map(mask, 0, "map.nrrd"); }), HasSubstr("1 to 32767"));
  EXPECT_THAT(error_of([&] { encode_label_map(mask, 32768, "map.nrrd"); }), HasSubstr("1 to 32767"));
}

}  // namespace
}  // namespace spinaltap
