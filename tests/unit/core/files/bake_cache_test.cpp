#include "core/files/bake_cache.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "core/base/staged_output.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

BoneMask made_mask() {
  BoneMask mask;
  mask.geometry.size = {7, 6, 5};
  mask.geometry.spacing_mm = Vec3(0.352, 0.352, 0.7);
  mask.geometry.origin_mm = Vec3(-31.25, 17.1, -0.3);
  const double angle = 0.31;
  mask.geometry.directions.col(0) = Vec3(std::cos(angle), std::sin(angle), 0.0);
  mask.geometry.directions.col(1) = Vec3(-std::sin(angle), std::cos(angle), 0.0);
  for (std::size_t i = 0; i < mask.geometry.voxel_count(); ++i) {
    mask.inside.push_back(static_cast<std::uint8_t>(i % 3 == 1 || i % 7 == 2 ? 1 : 0));
  }
  return mask;
}

SurfaceFit made_fit() {
  const test::Ball ball{Vec3(1.0, 2.0, 3.0), 5.0};
  SurfacePoints surface;
  surface.positions_mm = ball.surface_points(1.5);
  for (const Vec3& p : surface.positions_mm) surface.normals.push_back((p - ball.centre_mm).normalized());
  return fit_surface(surface);
}

TEST(BakeCache, GivesBackAMaskVoxelForVoxel) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path() / "cache");
  const BoneMask mask = made_mask();
  EXPECT_FALSE(cache.find_mask("a", mask.geometry).has_value());
  cache.keep_mask("a", {mask, "threshold 150 HU"});
  const std::optional<MaskStage> found = cache.find_mask("a", mask.geometry);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->mask.inside, mask.inside);
  EXPECT_EQ(found->mask.geometry.size, mask.geometry.size);
  EXPECT_EQ(found->method, "threshold 150 HU");
  EXPECT_FALSE(cache.find_mask("b", mask.geometry).has_value());
}

TEST(BakeCache, KeepsWhatIsKnownOfAMask) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path());
  const LevelWarnings warnings{{"the left pedicle is thin", "metal"}, 0.625};
  cache.keep_mask("a", {made_mask(), "found", Level::kT12, warnings});
  const std::optional<MaskStage> found = cache.find_mask("a", made_mask().geometry);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->level, Level::kT12);
  EXPECT_EQ(found->warnings, warnings);
  cache.keep_mask("b", {made_mask(), "label 3"});
  EXPECT_EQ(cache.find_mask("b", made_mask().geometry)->level, Level::kNone);
  EXPECT_FALSE(cache.find_mask("b", made_mask().geometry)->warnings.has_value());
}

TEST(BakeCache, GivesBackAFitBitForBit) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path() / "cache");
  const SurfaceFit fit = made_fit();
  cache.keep_fit("a", fit);
  const std::optional<SurfaceFit> found = cache.find_fit("a");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->field.model().weights, fit.field.model().weights);
  EXPECT_EQ(found->field.model().polynomial, fit.field.model().polynomial);
  EXPECT_EQ(found->report.points, fit.report.points);
  EXPECT_EQ(found->report.iterations, fit.report.iterations);
  EXPECT_EQ(found->report.mean_residual_mm, fit.report.mean_residual_mm);
  EXPECT_EQ(found->report.p99_residual_mm, fit.report.p99_residual_mm);
  EXPECT_EQ(found->report.max_residual_mm, fit.report.max_residual_mm);
}

TEST(BakeCache, TakesADamagedFileForNone) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path());
  const BoneMask mask = made_mask();
  for (const char* damaged : {"mask-a.nrrd", "mask-a.json", "fit-a.rbf", "fit-a.json"}) {
    cache.keep_mask("a", {mask, "by hand"});
    cache.keep_fit("a", made_fit());
    const fs::path path = folder.path() / damaged;
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_EQ(cache.find_mask("a", mask.geometry).has_value(), damaged[0] != 'm') << damaged;
    EXPECT_EQ(cache.find_fit("a").has_value(), damaged[0] != 'f') << damaged;
  }
}

TEST(BakeCache, IsPrunedToASizeTheLeastLatelyFoundFirst) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path());
  const SurfaceFit fit = made_fit();
  const auto age = [&](const char* key, int hours) {
    for (const char* ending : {".rbf", ".json"}) {
      fs::last_write_time(folder.path() / (std::string("fit-") + key + ending),
                          fs::file_time_type::clock::now() - std::chrono::hours(hours));
    }
  };
  for (const char* key : {"a", "b", "c"}) cache.keep_fit(key, fit);
  write_whole_file(folder.path() / "notes.txt", "mine");
  age("a", 72);
  age("b", 48);
  age("c", 24);
  ASSERT_TRUE(cache.find_fit("a").has_value());  // now it is the newest
  const std::uint64_t one = fs::file_size(folder.path() / "fit-a.rbf") + fs::file_size(folder.path() / "fit-a.json");
  cache.prune(10 * one, 30);
  EXPECT_TRUE(fs::exists(folder.path() / "fit-b.rbf"));
  cache.prune(2 * one, 30);
  EXPECT_TRUE(cache.find_fit("a").has_value());
  EXPECT_TRUE(cache.find_fit("c").has_value());
  EXPECT_FALSE(fs::exists(folder.path() / "fit-b.rbf"));
  EXPECT_FALSE(fs::exists(folder.path() / "fit-b.json"));
  age("c", 31 * 24);
  cache.prune(10 * one, 30);
  EXPECT_FALSE(cache.find_fit("c").has_value());
  EXPECT_TRUE(cache.find_fit("a").has_value());
  EXPECT_TRUE(fs::exists(folder.path() / "notes.txt"));
}

TEST(BakeCache, RemovesItsOwnFilesOnly) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path() / "cache");
  cache.keep_mask("a", {made_mask(), "by hand"});
  cache.keep_fit("a", made_fit());
  cache.remove();
  EXPECT_FALSE(fs::exists(folder.path() / "cache"));
  cache.keep_fit("a", made_fit());
  write_whole_file(folder.path() / "cache/notes.txt", "mine");
  cache.remove();
  EXPECT_TRUE(fs::exists(folder.path() / "cache/notes.txt"));
  EXPECT_FALSE(fs::exists(folder.path() / "cache/fit-a.rbf"));
}

TEST(BakeCache, RemovesWhatAKilledRunLeftThere) {
  const test::TemporaryFolder folder;
  const BakeCache cache(folder.path() / "cache");
  cache.keep_fit("a", made_fit());
  const pid_t killed = ::fork();
  if (killed == 0) {
    StagedOutput output;
    output.stage(folder.path() / "cache/fit-b.json");
    ::_exit(0);
  }
  ASSERT_EQ(::waitpid(killed, nullptr, 0), killed);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "cache"), {}), 3);
  cache.remove();
  EXPECT_FALSE(fs::exists(folder.path() / "cache"));
}

TEST(BakeCache, WithoutAFolderKeepsNothing) {
  const test::TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const BakeCache cache{{}};
  cache.keep_fit("a", made_fit());
  EXPECT_FALSE(cache.find_fit("a").has_value());
  cache.remove();
  EXPECT_TRUE(fs::is_empty(folder.path()));
  fs::current_path(before);
}

}  // namespace
}  // namespace spinaltap
