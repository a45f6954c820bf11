// Label maps as DICOM structure sets, read: files put together byte by byte.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/staged_output.h"
#include "core/ct/label_map.h"
#include "core/ct/label_volume.h"
#include "tests/support/error_of.h"
#include "tests/support/made_dicom_labels.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::MadeStructureSet;
using test::TemporaryFolder;
using testing::HasSubstr;

GridGeometry ct_grid() {
  GridGeometry geometry;
  geometry.size = {60, 50, 40};
  geometry.spacing_mm = Vec3(0.8, 0.8, 1.0);
  geometry.origin_mm = Vec3(-20.0, 30.0, 10.0);
  return geometry;
}

LabelVolume read_set(const MadeStructureSet& set, const GridGeometry& grid = ct_grid()) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "set.dcm", set.bytes());
  return read_label_volume(folder.path() / "set.dcm", grid);
}

std::string set_error(const MadeStructureSet& set) {
  return error_of([&] { read_set(set); });
}

/// A square around a point, in the plane z, mm.
std::vector<Vec3> square(double x, double y, double z, double half) {
  return {{x - half, y - half, z}, {x + half, y - half, z}, {x + half, y + half, z}, {x - half, y + half, z}};
}

TEST(DicomContours, EncloseTheVoxelsWhoseCentresLieWithinAnOddNumberOfThem) {
  // Half-sizes that no voxel's centre lies on.
  MadeStructureSet set{{{3, "L3", {square(0.0, 50.0, 14.0, 10.1), square(0.0, 50.0, 14.0, 5.3)}}}};
  const LabelVolume map = read_set(set);
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 50; ++j) {
      for (int i = 0; i < 60; ++i) {
        const Vec3 p = map.geometry.to_patient(Vec3(i, j, k)) - Vec3(0.0, 50.0, 14.0);
        const double r = std::max(std::abs(p.x()), std::abs(p.y()));
        ASSERT_EQ(map.labels[map.geometry.offset(i, j, k)] == 3, k == 4 && r < 10.1 && r > 5.3)
            << i << " " << j << " " << k;
      }
    }
  }
  EXPECT_EQ(map.names.at(3).level, *level_from_name("L3"));
}

// An ellipsoid with a hole through it, drawn as polygons of 120 corners on slices of 1 mm: what the contours enclose is
// known, so that 0.98 is a bound on voxels alone.
TEST(DicomContours, OfAnEllipsoidWithAHoleGiveItsVoxels) {
  const GridGeometry grid = ct_grid();
  const Vec3 middle(3.0, 50.0, 30.0), half(18.0, 14.0, 12.0);
  const double hole_mm = 5.0;
  MadeStructureSet set{{{1, "T11", {}}}};
  for (int k = 0; k < grid.size[2]; ++k) {
    const double z = grid.origin_mm.z() + k * grid.spacing_mm.z();
    const double left = 1.0 - std::pow((z - middle.z()) / half.z(), 2);
    if (left <= 0.0) continue;
    const auto ring = [&](double a, double b) {
      std::vector<Vec3> points;
      for (int n = 0; n < 120; ++n) {
        const double angle = 2.0 * std::numbers::pi * n / 120;
        points.emplace_back(middle.x() + a * std::cos(angle), middle.y() + b * std::sin(angle), z);
      }
      return points;
    };
    set.rois[0].contours.push_back(ring(half.x() * std::sqrt(left), half.y() * std::sqrt(left)));
    if (half.y() * std::sqrt(left) > hole_mm) set.rois[0].contours.push_back(ring(hole_mm, hole_mm));
  }
  const LabelVolume map = read_set(set);
  double both = 0.0, either = 0.0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const Vec3 p = grid.to_patient(Vec3(i, j, k)) - middle;
        const bool is_narrow = half.y() * std::sqrt(std::max(0.0, 1.0 - std::pow(p.z() / half.z(), 2))) <= hole_mm;
        const bool is_in = p.cwiseQuotient(half).norm() < 1.0 && (is_narrow || p.head<2>().norm() > hole_mm);
        const bool is_read = map.labels[grid.offset(i, j, k)] != 0;
        both += is_in && is_read ? 2.0 : 0.0;
        either += (is_in ? 1.0 : 0.0) + (is_read ? 1.0 : 0.0);
      }
    }
  }
  EXPECT_GT(either, 1e4);
  EXPECT_GT(both / either, 0.98);
}

// Other programs lead channels through voxels' centres, which belong to the region (PS3.3, C.8.8.6.3), and rounding
// must not part the channel's two sides there.
TEST(DicomContours, MayReachTheirHolesByChannelsOfNoWidth) {
  for (const double spacing_mm : {0.3, 0.352, 0.7, 0.8}) {
    GridGeometry grid = ct_grid();
    grid.spacing_mm.head<2>().setConstant(spacing_mm);
    MadeStructureSet set{{{3, "L3", {{}}}}};
    const double around[][2] = {{10.5, 10.5}, {40.5, 10.5}, {40.5, 40.5}, {10.5, 40.5}, {10.5, 10.5}};
    const double hole[][2] = {{20.5, 20.5}, {20.5, 30.5}, {30.5, 30.5}, {30.5, 20.5}, {20.5, 20.5}};
    for (const auto& [i, j] : around) set.rois[0].contours[0].push_back(grid.to_patient(Vec3(i, j, 4.0)));
    for (const auto& [i, j] : hole) set.rois[0].contours[0].push_back(grid.to_patient(Vec3(i, j, 4.0)));
    const LabelVolume map = read_set(set, grid);
    const auto is_within = [](int n, int low, int high) { return n > low && n <= high; };
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const bool is_hole = is_within(i, 20, 30) && is_within(j, 20, 30);
        ASSERT_EQ(map.labels[grid.offset(i, j, 4)] == 3, is_within(i, 10, 40) && is_within(j, 10, 40) && !is_hole)
            << spacing_mm << " mm: " << i << " " << j;
      }
    }
  }
}

TEST(DicomContours, FillTheSlicesBetweenTheirPlanesButNoGap) {
  // Drawn on every third slice, then none, then one alone.
  MadeStructureSet set{{{1, "L1", {}}}};
  for (const double z : {15.0, 18.0, 21.0, 40.0}) set.rois[0].contours.push_back(square(0.0, 50.0, z, 4.1));
  const LabelVolume map = read_set(set);
  std::vector<int> filled;
  for (int k = 0; k < 40; ++k) {
    if (map.labels[map.geometry.offset(25, 25, k)] != 0) filled.push_back(k);
  }
  EXPECT_EQ(filled, (std::vector<int>{4, 5, 6, 7, 8, 9, 10, 11, 12, 29, 30, 31}));
}

// One slice more that was drawn leaves no holes beside the others.
TEST(DicomContours, FillTheSlicesBetweenUnevenPlanesToo) {
  for (const double step : {3.0, 4.0}) {
    MadeStructureSet set{{{1, "L1", {}}}};
    for (const double z : {15.0, 15.0 + step, 15.0 + 2 * step, 16.0 + 2 * step, 16.0 + 3 * step}) {
      set.rois[0].contours.push_back(square(0.0, 50.0, z, 4.1));
    }
    const LabelVolume map = read_set(set);
    for (int k = 5; k <= 6 + 3 * static_cast<int>(step); ++k) {
      EXPECT_EQ(map.labels[map.geometry.offset(25, 25, k)], 1) << step << " " << k;
    }
  }
}

TEST(DicomContours, LieInPlanesOfAnyAxisOfTheCt) {
  MadeStructureSet set{{{1, "L1", {}}}};
  const double x = -20.0 + 0.8 * 30;
  set.rois[0].contours = {{{x, 40.1, 20.2}, {x, 60.1, 20.2}, {x, 60.1, 30.2}, {x, 40.1, 30.2}}};  // sagittal
  const LabelVolume map = read_set(set);
  EXPECT_NE(map.labels[map.geometry.offset(30, 20, 15)], 0);
  EXPECT_EQ(map.labels[map.geometry.offset(31, 20, 15)], 0);
  EXPECT_EQ(map.labels[map.geometry.offset(29, 20, 15)], 0);
}

TEST(DicomContours, SayTheirLevelsByCodeOrNameAndTakeAnyRoiNumber) {
  MadeStructureSet set{{{900, "bone A", {square(0.0, 50.0, 14.0, 3.1)}, "CLOSED_PLANAR", "36470004"},
                        {1000, "Vertebra_L4", {square(10.0, 50.0, 14.0, 3.1)}, "CLOSEDPLANAR_XOR"},
                        {7, "isocentre", {{{0.0, 50.0, 14.0}}}, "POINT"}}};
  const LabelVolume map = read_set(set);
  EXPECT_EQ(levels_of(map), (std::vector<Level>{*level_from_name("L3"), *level_from_name("L4")}));
  set.rois[0].name = "L5";
  EXPECT_THAT(set_error(set), HasSubstr("code of L3 and the name of L5"));
}

TEST(DicomContours, HaveAsManyPointsAsTheySay) {
  MadeStructureSet set{{{1, "L3", {square(0.0, 50.0, 14.0, 4.1), square(0.0, 50.0, 15.0, 4.1)}}}};
  EXPECT_EQ(set_error(set), "");
  set.rois[0].points_too_many = 1;  // one was lost
  EXPECT_THAT(set_error(set), HasSubstr("NumberOfContourPoints, 5, found 4"));
}

// Two that are the same would leave nothing within an odd number of them.
TEST(DicomContours, WarnWhereAVertebrasNameHasTheCodeOfSomethingElse) {
  MadeStructureSet set{{{3, "L3", {square(0.0, 50.0, 14.0, 10.1)}}}};
  EXPECT_TRUE(read_set(set).warnings.empty());
  set.rois[0].code = "113197003";
  EXPECT_THAT(read_set(set).warnings, testing::ElementsAre(HasSubstr("named \"L3\"")));
}

// A hole whose plane was rounded to another height than its rim's.
TEST(DicomContours, OfOnePlaneMayDifferByRounding) {
  MadeStructureSet set{{{3, "L3", {}}}};
  for (int k = 0; k < 5; ++k) {
    set.rois[0].contours.push_back(square(0.0, 50.0, 14.0 + k, 10.1));
    set.rois[0].contours.push_back(square(0.0, 50.0, 14.1 + k, 5.3));
  }
  const LabelVolume map = read_set(set);
  for (int k = 4; k < 9; ++k) {
    EXPECT_EQ(map.labels[map.geometry.offset(25, 25, k)], 0) << k;  // the middle
    EXPECT_EQ(map.labels[map.geometry.offset(25, 16, k)], 3) << k;  // the rim
  }
  // Planes of a CT four times finer stay what they are.
  MadeStructureSet fine{{{3, "L3", {}}}};
  for (int n = 0; n < 20; ++n) fine.rois[0].contours.push_back(square(0.0, 50.0, 14.0 + 0.25 * n, 10.1));
  EXPECT_EQ(read_set(fine).labels[ct_grid().offset(25, 25, 6)], 3);
}

TEST(DicomContours, ThatAreCopiesCountOnce) {
  MadeStructureSet once{{{1, "L3", {square(0.0, 50.0, 14.0, 10.1), square(0.0, 50.0, 14.0, 5.3)}}}};
  MadeStructureSet twice = once;
  twice.rois[0].contours.insert(twice.rois[0].contours.end(), once.rois[0].contours.begin(),
                                once.rois[0].contours.end());
  EXPECT_EQ(read_set(twice).labels, read_set(once).labels);
}

TEST(DicomContours, SayWhatIsWrong) {
  MadeStructureSet set{{{1, "L1", {square(0.0, 50.0, 14.0, 4.1)}}, {2, "L2", {square(6.0, 50.0, 14.0, 4.1)}}}};
  EXPECT_THAT(set_error(set), HasSubstr("do not overlap"));
  MadeStructureSet open{{{1, "L1", {square(0.0, 50.0, 14.0, 4.1)}, "OPEN_PLANAR"}}};
  EXPECT_THAT(set_error(open), HasSubstr("closed planar contours of L1, found \"OPEN_PLANAR\""));
  MadeStructureSet leaning{{{1, "L1", {{{0.0, 50.0, 14.0}, {9.0, 50.0, 19.0}, {9.0, 60.0, 25.0}}}}}};
  EXPECT_THAT(set_error(leaning), HasSubstr("planes of the CT's slices"));
  MadeStructureSet far{{{1, "L1", {square(500.0, 50.0, 14.0, 4.1)}}}};
  EXPECT_THAT(set_error(far), HasSubstr("none in"));
  MadeStructureSet twice{{{1, "L1", {square(0.0, 50.0, 14.0, 4.1)}}, {1, "L2", {}}}};
  EXPECT_THAT(set_error(twice), HasSubstr("numbers of their own"));
  MadeStructureSet nan{{{1, "L1", {square(std::nan(""), 50.0, 14.0, 4.1)}}}};
  EXPECT_THAT(set_error(nan), HasSubstr("three numbers a point"));
}

}  // namespace
}  // namespace spinaltap
