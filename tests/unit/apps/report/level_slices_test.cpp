#include "apps/report/level_slices.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/apps/report/levels_scene.h"

namespace spinaltap {
namespace {

Colour colour_at(const LevelSlice& slice, const Vec3& p_patient) {
  const Vec3 p = slice.frame.to_pixel(p_patient);
  const auto at = 3 * (std::lround(p.y()) * slice.image.width + std::lround(p.x()));
  const std::uint8_t* rgb = slice.image.rgb.data() + at;
  return {rgb[0], rgb[1], rgb[2]};
}

int pixels_of_colour(const Image& image, const Colour& colour) {
  int count = 0;
  for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
    count += image.rgb[p] == colour[0] && image.rgb[p + 1] == colour[1] && image.rgb[p + 2] == colour[2] ? 1 : 0;
  }
  return count;
}

TEST(LevelSlices, PutThePatientsLeftOnTheRightOfAxialAndCoronalSlices) {
  const LevelsScene scene;
  const LevelSlices slices(scene.ct, scene.labels, scene.what);
  for (const Plane plane : {Plane::kAxial, Plane::kCoronal}) {
    const LevelSlice slice = slices.level_slice(plane, slices.levels()[1], 0.5);
    int brightest_column = -1;
    for (int column = 0; column < slice.image.width && brightest_column < 0; ++column) {
      for (int row = 0; row < slice.image.height; ++row) {
        if (slice.image.rgb[3 * static_cast<std::size_t>(row * slice.image.width + column)] == 255) {
          brightest_column = column;
        }
      }
    }
    EXPECT_GT(brightest_column, slice.image.width / 2);
  }
}

TEST(LevelSlices, FindBoneWhereItIsInCtsOfAnyOrientation) {
  Mat3 turned;  // i to the back, j up, k to the right
  turned << 0, 0, -1, 1, 0, 0, 0, 1, 0;
  for (const LevelsScene& scene :
       {LevelsScene(), LevelsScene(Vec3(1.0, 3.0, 1.0), turned),
        LevelsScene(Vec3::Ones(), Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix())}) {
    const LevelSlices slices(scene.ct, scene.labels, scene.what);
    for (const Plane plane : {Plane::kAxial, Plane::kSagittal, Plane::kCoronal}) {
      const LevelSlice slice = slices.level_slice(plane, slices.levels()[1], 0.5);
      // Bone of 400 HU is half grey in a window of -200 to 1,000 HU, soft tissue of 40 HU a fifth.
      EXPECT_NEAR(colour_at(slice, LevelsScene::centre_mm(3))[0], 128, 2);
      const Vec3 beside = LevelsScene::centre_mm(3) + Vec3(-18.5, 15.5, 0.0);
      if (plane == Plane::kAxial) {
        EXPECT_NEAR(colour_at(slice, beside)[0], 51, 2);
      }
    }
  }
}

TEST(LevelSlices, GiveEachLevelItsColourAndNeverNeighboursTheSame) {
  const LevelsScene scene;
  const LevelSlices slices(scene.ct, scene.labels, scene.what);
  ASSERT_EQ(slices.levels().size(), 4u);
  EXPECT_EQ(slices.levels().front().label, 4);  // from the head down
  std::set<Colour> colours;
  for (const PictureLevel& level : slices.levels()) {
    colours.insert(slices.colour(level));
    const LevelSlice axial = slices.level_slice(Plane::kAxial, level, 0.5);
    // The rim of 60 x 48 pixels, whose sides lie on voxel borders or half a voxel off.
    EXPECT_NEAR(pixels_of_colour(axial.image, slices.colour(level)), 212, 12);
  }
  EXPECT_EQ(colours.size(), 4u);
}

TEST(LevelSlices, OverviewsHoldALeaningColumnAndItsNames) {
  const LevelsScene scene;
  const LevelSlices slices(scene.ct, scene.labels, scene.what);
  const LevelSlice sagittal = slices.overview(Plane::kSagittal);
  for (int label = 1; label <= 4; ++label) {
    EXPECT_NEAR(colour_at(sagittal, LevelsScene::centre_mm(label))[0], 128, 2) << label;
    EXPECT_NEAR(sagittal.frame.to_pixel(LevelsScene::centre_mm(label)).z(), 0.0, 1.0) << label;
  }
  // L4's name, in its colour, lies before its body: left of it, at its height.
  const PictureLevel& lowest = slices.levels().back();
  const Vec3 middle = sagittal.frame.to_pixel(lowest.centre_mm);
  Image name{22, 14, std::vector<std::uint8_t>(22 * 14 * 3)};
  draw_text(name, 0, 0, "L4", 2, slices.colour(lowest));
  int drawn = 0;
  for (int row = 0; row < 14; ++row) {
    for (int column = 0; column < static_cast<int>(middle.x()) - 25; ++column) {
      const int y = static_cast<int>(std::lround(middle.y())) - 7 + row;
      const std::uint8_t* rgb =
          sagittal.image.rgb.data() + 3 * static_cast<std::ptrdiff_t>(y * sagittal.image.width + column);
      drawn += Colour{rgb[0], rgb[1], rgb[2]} == slices.colour(lowest) ? 1 : 0;
    }
  }
  EXPECT_EQ(drawn, pixels_of_colour(name, slices.colour(lowest)));
}

TEST(LevelSlices, DashAndQuestionASuspectLevel) {
  LevelsScene scene;
  const LevelSlices sure(scene.ct, scene.labels, scene.what);
  LevelsPicture doubting = scene.what;
  doubting.levels[2].suspect = true;
  const LevelSlices suspect(scene.ct, scene.labels, doubting);
  EXPECT_EQ(sure.title(sure.levels()[1]), "L2");
  EXPECT_EQ(suspect.title(suspect.levels()[1]), "L2 ?");
  const auto rim = [](const LevelSlices& slices) {
    return pixels_of_colour(slices.level_slice(Plane::kAxial, slices.levels()[1], 0.5).image,
                            slices.colour(slices.levels()[1]));
  };
  EXPECT_NEAR(rim(suspect) / static_cast<double>(rim(sure)), 9.0 / 16.0, 0.06);
}

TEST(LevelSlices, MarkTheSeedWhereItIsAndOnlyInSlicesNearIt) {
  LevelsScene scene;
  const LevelSlices without(scene.ct, scene.labels, scene.what);
  scene.what.seed_mm = LevelsScene::centre_mm(3) + Vec3(-5.0, 4.0, 2.0);
  const LevelSlices with(scene.ct, scene.labels, scene.what);
  const auto changed_around_seed = [&](const LevelSlice& before, const LevelSlice& after) {
    Eigen::AlignedBox2i box;
    for (int row = 0; row < before.image.height; ++row) {
      for (int column = 0; column < before.image.width; ++column) {
        const std::size_t at = 3 * static_cast<std::size_t>(row * before.image.width + column);
        if (before.image.rgb[at] != after.image.rgb[at]) box.extend(Eigen::Vector2i(column, row));
      }
    }
    return box;
  };
  for (const Plane plane : {Plane::kAxial, Plane::kSagittal, Plane::kCoronal}) {
    const LevelSlice slice = with.level_slice(plane, with.levels()[1], 0.5);
    const auto box = changed_around_seed(without.level_slice(plane, without.levels()[1], 0.5), slice);
    ASSERT_FALSE(box.isEmpty());
    const Vec3 seed = slice.frame.to_pixel(*scene.what.seed_mm);
    EXPECT_NEAR(0.5 * (box.min().x() + box.max().x()), seed.x(), 0.51);
    EXPECT_NEAR(0.5 * (box.min().y() + box.max().y()), seed.y(), 0.51);
    // Another level's axial slice lies 24 mm off.
    const LevelSlice far = with.level_slice(Plane::kAxial, with.levels()[0], 0.5);
    EXPECT_TRUE(changed_around_seed(without.level_slice(Plane::kAxial, without.levels()[0], 0.5), far).isEmpty());
  }
}

TEST(LevelSlices, ShowALevelThatTheBorderCutsWhereItsCentreLiesBeyond) {
  LevelsScene scene;
  // The topmost body's middle is 60 mm above the CT's: its bone's upper end is taken.
  scene.what.levels[3].centre_mm.z() += 70.0;
  const LevelSlices slices(scene.ct, scene.labels, scene.what);
  const LevelSlice axial = slices.level_slice(Plane::kAxial, slices.levels().front(), 0.5);
  EXPECT_NEAR(axial.frame.to_patient(0, 0).z(), LevelsScene::centre_mm(4).z() + 9.0, 3.0);
}

TEST(LevelSlices, FrameHoldsTheLettersAndTheBarBesideTheSlice) {
  const LevelsScene scene;
  const LevelSlices slices(scene.ct, scene.labels, scene.what);
  const LevelSlice axial = slices.level_slice(Plane::kAxial, slices.levels()[1], 0.5);
  const Image image = framed(axial);
  ASSERT_EQ(image.width, axial.image.width + 2 * kSliceBorder);
  // Nothing of the slice is hidden.
  for (int row = 0; row < axial.image.height; ++row) {
    const auto in_frame =
        image.rgb.begin() + 3 * ((row + kSliceBorder) * static_cast<std::ptrdiff_t>(image.width) + kSliceBorder);
    EXPECT_TRUE(std::equal(in_frame, in_frame + 3 * axial.image.width,
                           axial.image.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(row) * axial.image.width));
  }
  // 30 mm of bone and 16 mm of room: a bar of 10 mm, 20 pixels, which begins under the slice's left end.
  const int bar_row = image.height - 8;
  int white = 0;
  for (int x = 0; x < image.width / 3; ++x) {
    white += image.rgb[3 * static_cast<std::size_t>(bar_row * image.width + x)] == 255 ? 1 : 0;
  }
  EXPECT_EQ(white, 20);
}

}  // namespace
}  // namespace spinaltap
