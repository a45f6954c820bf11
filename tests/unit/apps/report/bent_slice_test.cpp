#include "apps/report/bent_slice.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace spinaltap {
namespace {

SliceFrame sagittal(double x_mm) {
  return plane_frame(Plane::kSagittal, Vec3(x_mm, 0.0, 0.0), Box3(Vec3(-30, -20, -50), Vec3(30, 20, 50)), 0.5);
}

TEST(BentSlice, HoldsItsPointsAndIsStraightBetweenThem) {
  // The column leans: 20 mm to the patient's left over 40 mm upward.
  const std::vector<Vec3> points{Vec3(10, 3, 20), Vec3(-10, -3, -20)};
  const BentFrame frame = bent_through(sagittal(0.0), points);
  const auto x_at = [&](double z_mm) {
    const int row = static_cast<int>(std::lround(frame.plane.to_pixel(Vec3(0.0, 0.0, z_mm)).y()));
    return frame.to_patient(0, row).x();
  };
  const double half_pixel_mm = 0.25;  // half a row at a lean of a half
  EXPECT_NEAR(x_at(20.0), 10.0, half_pixel_mm);
  EXPECT_NEAR(x_at(-20.0), -10.0, half_pixel_mm);
  EXPECT_NEAR(x_at(10.0), 5.0, half_pixel_mm);
  EXPECT_NEAR(x_at(45.0), 10.0, 1e-9);
  EXPECT_NEAR(x_at(-45.0), -10.0, 1e-9);
  for (const Vec3& p : points) EXPECT_NEAR(frame.to_pixel(p).z(), 0.0, 0.5);
}

TEST(BentSlice, TakesTheMeanOfPointsAtOneHeightAndStaysFlatWithoutAny) {
  const BentFrame one = bent_through(sagittal(0.0), {Vec3(4, 0, 0), Vec3(8, 0, 0.5)});
  EXPECT_NEAR(one.to_patient(3, 7).x(), 6.0, 1e-9);
  EXPECT_NEAR(bent_through(sagittal(2.0), {}).to_patient(3, 7).x(), 2.0, 1e-9);
}

/// A bright rod of 4 mm that leans by x = z / 2, on a grid that is turned by 30 degrees and has slices of 3 mm.
struct LeaningRod {
  CtVolume ct;
  LabelVolume labels;

  LeaningRod() {
    GridGeometry grid;
    grid.size = {90, 90, 40};
    grid.spacing_mm = Vec3(1.0, 1.0, 3.0);
    grid.directions = Eigen::AngleAxisd(30.0 * kDegree, Vec3::UnitZ()).toRotationMatrix();
    grid.origin_mm = -(grid.directions * Vec3(44.5, 44.5, 58.5));
    std::vector<std::int16_t> hu(grid.voxel_count(), 0);
    labels = {grid, std::vector<std::uint8_t>(grid.voxel_count(), 0), {{7, {"T7", Level::kNone}}}};
    for (int k = 0; k < 40; ++k) {
      for (int j = 0; j < 90; ++j) {
        for (int i = 0; i < 90; ++i) {
          const Vec3 p = grid.to_patient(Vec3(i, j, k));
          if (std::hypot(p.x() - 0.5 * p.z(), p.y()) > 4.0) continue;
          hu[grid.offset(i, j, k)] = 1000;
          labels.labels[grid.offset(i, j, k)] = 7;
        }
      }
    }
    ct = make_ct_volume(grid, std::move(hu));
  }
};

TEST(BentSlice, FollowsALeaningRodThroughAThickSlicedTurnedCt) {
  const LeaningRod rod;
  const BentFrame frame = bent_through(sagittal(0.0), {Vec3(20, 0, 40), Vec3(-20, 0, -40)});
  const Image image = bent_slice(rod.ct, frame, {1000.0, 500.0}, {1, 2, 3});
  const std::vector<int> labels = labels_on(rod.labels, frame);
  for (const double z_mm : {-39.0, -20.5, -3.0, 0.0, 17.0, 39.0}) {
    const Vec3 p = frame.plane.to_pixel(Vec3(0.0, 0.0, z_mm));
    const auto at = static_cast<std::size_t>(std::lround(p.y())) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(std::lround(p.x()));
    // On the rod's axis; slices of 3 mm shift it by 1.5 mm at most, within its 4 mm.
    EXPECT_GT(image.rgb[3 * at], 240) << z_mm;
    EXPECT_EQ(labels[at], 7) << z_mm;
  }
  // The flat plane through x = 0 loses the rod 10 mm off.
  const BentFrame straight = flat(sagittal(0.0));
  const Vec3 p = straight.plane.to_pixel(Vec3(0.0, 0.0, 39.0));
  EXPECT_EQ(
      labels_on(
          rod.labels,
          straight)[static_cast<std::size_t>(std::lround(p.y())) * static_cast<std::size_t>(straight.plane.width) +
                    static_cast<std::size_t>(std::lround(p.x()))],
      0);
}

TEST(BentSlice, ShowsWhatLiesBeyondTheCt) {
  GridGeometry grid;
  grid.size = {10, 10, 10};
  const CtVolume ct = make_ct_volume(grid, std::vector<std::int16_t>(1000, 500));
  const LabelVolume labels{grid, std::vector<std::uint8_t>(1000, 3), {}};
  const BentFrame frame =
      flat(plane_frame(Plane::kAxial, Vec3(5, 5, 5), Box3(Vec3(-4.5, -0.5, 5), Vec3(9.5, 9.5, 5)), 1.0));
  const Image image = bent_slice(ct, frame, {}, {1, 2, 3});
  ASSERT_EQ(image.width, 14);
  EXPECT_EQ(image.rgb[3 * 3 + 1], 2);  // column 3 of row 0: x = -1
  EXPECT_EQ(labels_on(labels, frame)[3], -1);
  EXPECT_EQ(labels_on(labels, frame)[4], 3);
}

}  // namespace
}  // namespace spinaltap
