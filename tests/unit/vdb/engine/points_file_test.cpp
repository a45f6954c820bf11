#include "vdb/engine/points_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointCount.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <tuple>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Far from the patient frame's origin, along no axis.
const DrillPath kPath{
    "left \"pedicle\"", Vec3(1234.5, -987.6, 1500.3), Vec3(1234.5, -987.6, 1500.3) + Vec3(1, 2, -3), {}};

/// Points of a jittered volume, of which every third is dead.
PointVolume sample() {
  PointVolume volume(kPath, {.radius_mm = 0.9, .spacing_mm = 0.1, .jitter = 0.3});
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      volume.set_hu(disc, i, static_cast<double>((static_cast<std::size_t>(disc) * 31 + i * 7) % 2500) - 500.0);
      if ((static_cast<std::size_t>(disc) + i) % 3 == 0) volume.set_occupied(disc, i, false);
    }
  }
  return volume;
}

class PointsFile : public testing::Test {
 protected:
  fs::path file(const char* name) const { return folder_.path() / name; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(PointsFile, GivesBackPositionsWithinAMicronAndTheirNumbers) {
  const PointVolume volume = sample();
  const HuToDensity line;
  write_points(volume, kPath, file("points.vdb"), {.density = line});
  const SavedPoints saved = read_points(file("points.vdb"));
  ASSERT_EQ(saved.positions_mm.size(), volume.occupied_count());
  ASSERT_EQ(saved.hu.size(), volume.occupied_count());
  ASSERT_EQ(saved.density_g_cm3.size(), volume.occupied_count());
  // The grid's order is its own: each point is found by the disc and index that it is nearest to.
  std::vector<bool> is_found(volume.point_count(), false);
  for (std::size_t n = 0; n < saved.positions_mm.size(); ++n) {
    const Vec3 p = volume.frame().to_path(saved.positions_mm[n]);
    double nearest_mm = 1e9;
    int nearest_disc = 0;
    std::size_t nearest_index = 0;
    const auto plane = static_cast<int>(std::lround(p.z() / 0.1));
    for (int disc = std::max(0, plane - 1); disc <= std::min(plane + 1, volume.disc_count() - 1); ++disc) {
      for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
        const double off_mm = (volume.point_in_path_mm(disc, i) - p).norm();
        if (off_mm < nearest_mm) std::tie(nearest_mm, nearest_disc, nearest_index) = std::tuple(off_mm, disc, i);
      }
    }
    ASSERT_LT(nearest_mm, 0.001);
    ASSERT_TRUE(volume.is_occupied(nearest_disc, nearest_index));
    ASSERT_EQ(saved.hu[n], volume.hu(nearest_disc, nearest_index));
    ASSERT_FLOAT_EQ(saved.density_g_cm3[n], static_cast<float>(line.density_g_cm3(saved.hu[n])));
    const std::size_t place = static_cast<std::size_t>(nearest_disc) * volume.pattern().point_count() + nearest_index;
    ASSERT_FALSE(is_found[place]);
    is_found[place] = true;
  }
}

TEST_F(PointsFile, SaysWhichPathItIsOf) {
  write_points(sample(), kPath, file("points.vdb"));
  const SavedPoints saved = read_points(file("points.vdb"));
  EXPECT_TRUE(saved.density_g_cm3.empty());
  EXPECT_EQ(saved.metadata.at("path"), kPath.name);
  EXPECT_THAT(saved.metadata.at("entry_mm"), HasSubstr("1234.5"));
  EXPECT_THAT(saved.metadata.at("target_mm"), HasSubstr("1235.5"));
  EXPECT_EQ(std::stod(saved.metadata.at("spacing_mm")), 0.1);
  EXPECT_NEAR(std::stod(saved.metadata.at("radius_mm")), 0.9, 1e-6);
}

TEST_F(PointsFile, IsAGridOfPointsToOtherPrograms) {
  const PointVolume volume = sample();
  write_points(volume, kPath, file("points.vdb"));
  initialize_openvdb();
  openvdb::io::File in(file("points.vdb").string());
  in.open();
  ASSERT_EQ(in.getGrids()->size(), 1U);
  const auto grid = openvdb::gridPtrCast<openvdb::points::PointDataGrid>(in.readGrid("points"));
  ASSERT_TRUE(grid);
  EXPECT_EQ(openvdb::points::pointCount(grid->tree()), volume.occupied_count());
  const auto leaf = grid->tree().cbeginLeaf();
  ASSERT_TRUE(leaf);
  EXPECT_TRUE(leaf->hasAttribute("P"));
  EXPECT_TRUE(leaf->hasAttribute("hu"));
  if (std::system("command -v vdb_print >/dev/null 2>&1") != 0) return;
  const std::string command = "vdb_print " + file("points.vdb").string() + " >" + file("list.txt").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(read_whole_file(file("list.txt")), HasSubstr("points"));
}

TEST_F(PointsFile, HasTheSameBytesAtOneAndTwoThreads) {
  const PointVolume volume = sample();
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    write_points(volume, kPath, file("one.vdb"));
  }
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  write_points(volume, kPath, file("two.vdb"));
  EXPECT_EQ(read_whole_file(file("one.vdb")), read_whole_file(file("two.vdb")));
}

TEST_F(PointsFile, MayHoldNone) {
  PointVolume volume(kPath, {.radius_mm = 0.5, .spacing_mm = 0.1});
  for (int disc = 0; disc < volume.disc_count(); ++disc) std::ranges::fill(volume.occupancy_words(disc), 0);
  write_points(volume, kPath, file("none.vdb"));
  EXPECT_TRUE(read_points(file("none.vdb")).positions_mm.empty());
}

TEST_F(PointsFile, LeavesTheOldOneOnAFullDisk) {
  std::ofstream(file("points.vdb")) << "old";
  {
    const test::FullDisk full(1000);
    EXPECT_THAT([&] { write_points(sample(), kPath, file("points.vdb")); },
                ThrowsMessage<Error>(HasSubstr("cannot write")));
  }
  EXPECT_EQ(read_whole_file(file("points.vdb")), "old");
}

TEST_F(PointsFile, IsRejectedWhenItIsNone) {
  EXPECT_THAT([&] { read_points(file("none.vdb")); }, ThrowsMessage<Error>(HasSubstr("no such file")));
  const auto other = openvdb::FloatGrid::create();
  other->setName("points");
  initialize_openvdb();
  openvdb::io::File out(file("other.vdb").string());
  out.write(openvdb::GridPtrVec{other});
  out.close();
  EXPECT_THAT([&] { read_points(file("other.vdb")); }, ThrowsMessage<Error>(HasSubstr("grid of points")));
  write_points(sample(), kPath, file("whole.vdb"));
  const std::string whole = read_whole_file(file("whole.vdb"));
  for (const double share : {0.01, 0.3, 0.7, 0.99}) {
    const auto keep = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    std::ofstream(file("cut.vdb"), std::ios::binary | std::ios::trunc) << whole.substr(0, keep);
    EXPECT_THROW(read_points(file("cut.vdb")), Error) << share;
  }
}

}  // namespace
}  // namespace spinaltap
