#include "core/ct/detail/slice_stack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

GridGeometry slices_of(int count) {
  GridGeometry geometry;
  geometry.size = {40, 30, count};
  geometry.spacing_mm = Vec3(0.5, 0.75, 2.0);
  geometry.origin_mm = Vec3(-3.0, 5.0, 10.0);
  return geometry;
}

/// What a scanner stores of a field (HU, over mm from the first voxel) in slices at these places.
template <class Field>
std::vector<std::int16_t> scan(const GridGeometry& slices, const std::vector<SlicePlace>& places, const Field& field) {
  std::vector<std::int16_t> hu(slices.voxel_count());
  for (int k = 0; k < slices.size[2]; ++k) {
    const SlicePlace& place = places[static_cast<std::size_t>(k)];
    for (int j = 0; j < slices.size[1]; ++j) {
      for (int i = 0; i < slices.size[0]; ++i) {
        const Vec3 p(i * slices.spacing_mm.x() + place.sideways_mm.x(),
                     j * slices.spacing_mm.y() + place.sideways_mm.y(), place.along_mm);
        hu[slices.offset(i, j, k)] = static_cast<std::int16_t>(std::lround(field(p)));
      }
    }
  }
  return hu;
}

TEST(ResampleStack, PutsATiltedGantrysSlicesOverEachOther) {
  const GridGeometry slices = slices_of(9);
  std::vector<SlicePlace> places;
  for (int k = 0; k < 9; ++k) places.push_back({2.0 * k, {0.0, 2.0 * k * std::tan(0.3)}});  // 17 degrees
  // Cubic convolution gives back polynomials up to the second degree, so only rounding to whole HU is left: half a unit
  // in the input, which the weights (their sizes add up to at most 1.25) enlarge, and half a unit in the output.
  const auto field = [](const Vec3& p) {
    return 20.0 * p.x() - 3.0 * p.y() * p.y() + 15.0 * p.z() + 4.0 * p.x() * p.y();
  };
  const CtVolume ct = resample_stack(slices, places, 2.0, scan(slices, places, field));
  const int drift = static_cast<int>(std::ceil(16.0 * std::tan(0.3) / 0.75));
  EXPECT_THAT(ct.geometry.size, ElementsAre(40, 30 + drift, 9));
  EXPECT_EQ(ct.geometry.origin_mm, slices.origin_mm);
  int inside = 0;
  for (int k = 0; k < 9; ++k) {
    const double from = places[static_cast<std::size_t>(k)].sideways_mm.y() / 0.75;
    for (int j = 0; j < ct.geometry.size[1]; ++j) {
      for (int i = 0; i < 40; ++i) {
        if (j < from - 1e-6 || j > from + 29.0 + 1e-6) {
          ASSERT_EQ(ct.at(i, j, k), -1024) << i << ' ' << j << ' ' << k;
        } else if (j >= from + 1.0 && j <= from + 28.0) {  // the outermost taps are the border's own value
          ASSERT_NEAR(ct.at(i, j, k), field(Vec3(0.5 * i, 0.75 * j, 2.0 * k)), 1.2) << i << ' ' << j << ' ' << k;
          ++inside;
        }
      }
    }
  }
  EXPECT_GT(inside, 9000);
}

TEST(ResampleStack, InterpolatesLinearlyBetweenUnequalStepsAndKeepsSlicesOnTheGrid) {
  const GridGeometry slices = slices_of(5);
  const std::vector<SlicePlace> places{{0.0, {0, 0}}, {2.0, {0, 0}}, {5.0, {0, 0}}, {6.0, {0, 0}}, {9.0, {0, 0}}};
  const auto field = [](const Vec3& p) { return 100.0 * p.z() + (static_cast<int>(p.x() * 2.0) % 2 == 0 ? 7.0 : 0.0); };
  const std::vector<std::int16_t> hu = scan(slices, places, field);
  const CtVolume ct = resample_stack(slices, places, 2.0, hu);
  ASSERT_THAT(ct.geometry.size, ElementsAre(40, 30, 5));  // 0, 2, 4, 6 and 8 mm
  for (int k = 0; k < 5; ++k) {
    for (int i = 0; i < 40; ++i) EXPECT_EQ(ct.at(i, 11, k), 200 * k + (i % 2 == 0 ? 7 : 0));
  }
}

TEST(ResampleStack, ShiftsSlicesByWholePixelsBitForBit) {
  const GridGeometry slices = slices_of(2);
  const std::vector<SlicePlace> places{{0.0, {0, 0}}, {2.0, {-1.5, 0.75}}};
  const auto field = [](const Vec3& p) { return 1000.0 * std::sin(7.0 * p.x()) * std::cos(5.0 * p.y()) + p.z(); };
  const CtVolume ct = resample_stack(slices, places, 2.0, scan(slices, places, field));
  EXPECT_THAT(ct.geometry.size, ElementsAre(43, 31, 2));
  EXPECT_EQ(ct.geometry.origin_mm, Vec3(-4.5, 5.0, 10.0));
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(ct.at(i + 3, 4, 0), std::lround(field(Vec3(0.5 * i, 3.0, 0.0))));
    EXPECT_EQ(ct.at(i, 4, 1), std::lround(field(Vec3(0.5 * i - 1.5, 3.0, 2.0))));
  }
}

TEST(ResampleStack, RejectsToGrowWithoutBounds) {
  const GridGeometry slices = slices_of(2);
  const std::vector<std::int16_t> hu(slices.voxel_count());
  const auto error = [&](const std::vector<SlicePlace>& places, double step_mm) {
    return test::error_of([&] { resample_stack(slices, places, step_mm, hu); });
  };
  EXPECT_THAT(error({{0.0, {0, 0}}, {2.0, {200.0, 0}}}, 2.0), HasSubstr("4 times"));
  EXPECT_THAT(error({{0.0, {0, 0}}, {2.0, {1e18, 0}}}, 2.0), HasSubstr("far apart"));
  EXPECT_THAT(error({{0.0, {0, 0}}, {2.0, {NAN, 0}}}, 2.0), HasSubstr("far apart"));
  EXPECT_THAT(error({{0.0, {0, 0}}, {2.0, {0, 0}}}, 1e-9), HasSubstr("4 times"));
  EXPECT_THAT(error({{0.0, {0, 0}}, {2.0, {0, 0}}}, NAN), HasSubstr("step above 0"));
}

}  // namespace
}  // namespace spinaltap
