#include "apps/report/levels_picture.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "core/base/error.h"
#include "tests/unit/apps/report/levels_scene.h"

namespace spinaltap {
namespace {

TEST(LevelsPicture, ShowsTheChosenLevelOrAllInOneWholePicture) {
  LevelsScene scene;
  const Image all = levels_picture(scene.ct, scene.labels, scene.what);
  scene.what.chosen = 2;
  const Image chosen = levels_picture(scene.ct, scene.labels, scene.what);
  for (const Image& image : {all, chosen}) {
    EXPECT_EQ(image.rgb.size(), 3u * static_cast<unsigned>(image.width) * static_cast<unsigned>(image.height));
    EXPECT_LE(std::max(image.width, image.height), 2000);
  }
  EXPECT_NE(all.rgb, chosen.rgb);
}

TEST(LevelsPicture, WritesWarningsBelow) {
  LevelsScene scene;
  const Image without = levels_picture(scene.ct, scene.labels, scene.what);
  scene.what.levels[1].warnings = {"touches L2 over 120 mm2"};
  const Image with = levels_picture(scene.ct, scene.labels, scene.what);
  EXPECT_EQ(with.width, without.width);
  EXPECT_EQ(with.height, without.height + 20);  // a line
  // A warning longer than the picture is wide takes more lines.
  scene.what.levels[1].warnings = {std::string(static_cast<std::size_t>(without.width) / 12 + 5, 'x')};
  EXPECT_GE(levels_picture(scene.ct, scene.labels, scene.what).height, without.height + 40);
}

TEST(LevelsPicture, IsTheSameAtAnyThreadCount) {
  LevelsScene scene;
  scene.what.levels[0].suspect = true;
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return levels_picture(scene.ct, scene.labels, scene.what).rgb;
  };
  const auto one = with_threads(1);
  EXPECT_EQ(one, with_threads(2));
  EXPECT_EQ(one, with_threads(7));
}

TEST(LevelsPicture, StaysBoundedForManyLevelsAndForALabelThatFillsTheCt) {
  LevelsScene scene;
  scene.what.pixel_mm = 0.05;
  const Image fine = levels_picture(scene.ct, scene.labels, scene.what);
  EXPECT_LE(std::max(fine.width, fine.height), 4500);
  std::fill(scene.labels.labels.begin(), scene.labels.labels.end(), std::uint8_t{1});
  scene.what.levels.resize(1);
  const Image full = levels_picture(scene.ct, scene.labels, scene.what);
  EXPECT_LE(std::max(full.width, full.height), 4500);
}

TEST(LevelsPicture, RejectsWhatItCannotShow) {
  const LevelsScene scene;
  const auto rejected = [&](auto&& spoil) {
    LevelsScene bad = scene;
    spoil(bad);
    EXPECT_THROW(levels_picture(bad.ct, bad.labels, bad.what), Error);
  };
  rejected([](LevelsScene& bad) { std::fill(bad.labels.labels.begin(), bad.labels.labels.end(), std::uint8_t{0}); });
  rejected([](LevelsScene& bad) { bad.labels.geometry.size[2] -= 1; });
  rejected([](LevelsScene& bad) { bad.labels.geometry.origin_mm.x() += 1.0; });
  rejected([](LevelsScene& bad) { bad.labels.labels.pop_back(); });
  rejected([](LevelsScene& bad) { bad.what.levels.clear(); });
  rejected([](LevelsScene& bad) { bad.what.levels[0].label = 9; });
  rejected([](LevelsScene& bad) { bad.what.levels[0].label = 2; });  // twice
  rejected([](LevelsScene& bad) { bad.what.chosen = 9; });
  rejected([](LevelsScene& bad) { bad.what.pixel_mm = 0.0; });
  rejected([](LevelsScene& bad) { bad.what.seed_mm = Vec3::Constant(std::numeric_limits<double>::infinity()); });
  rejected([](LevelsScene& bad) { bad.what.levels[0].centre_mm.x() = std::numeric_limits<double>::quiet_NaN(); });
}

}  // namespace
}  // namespace spinaltap
