#include "core/ct/detail/dicom_stack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Slices named a, b, c, ... at the given z, mm.
std::vector<DicomHeader> slices_at(const std::vector<double>& z_mm) {
  std::vector<DicomHeader> slices;
  for (const double z : z_mm) {
    DicomHeader slice;
    slice.file = std::string(1, static_cast<char>('a' + slices.size())) + ".dcm";
    slice.columns = slice.rows = 8;
    slice.position_mm = {10.0, 20.0, z};
    slice.orientation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    slice.pixel_spacing_mm = {0.5, 0.5};
    slices.push_back(slice);
  }
  return slices;
}

template <class Change>
std::string error_with(const Change& change) {
  std::vector<DicomHeader> slices = slices_at({0, 1, 2, 3});
  change(slices);
  return error_of([&] { stack_slices(slices); });
}

std::string error_at(const std::vector<double>& z_mm) {
  return error_of([&] { stack_slices(slices_at(z_mm)); });
}

TEST(StackSlices, NamesTheSlicesAroundAMissingOne) {
  EXPECT_THAT(error_at({0, 1, 2, 4, 5}),
              AllOf(HasSubstr("a slice is missing: expected a step of 1 mm, found 2 mm between c.dcm and d.dcm")));
  EXPECT_THAT(error_at({0, 1, 2, 6, 7, 8}), HasSubstr("slices are missing: expected a step of 1 mm, found 4 mm"));
}

TEST(StackSlices, NamesTwoSlicesAtOnePosition) {
  EXPECT_THAT(error_at({0, 1, 2, 1, 3}), AllOf(HasSubstr("two"), HasSubstr("b.dcm and d.dcm")));
  EXPECT_THAT(error_at({0, 0, 1, 1, 2, 2}), HasSubstr("a.dcm and b.dcm"));
  EXPECT_THAT(error_at({5, 5}), HasSubstr("a.dcm and b.dcm"));
}

TEST(StackSlices, NamesTheSliceOfAnUnevenStep) {
  EXPECT_THAT(error_at({0, 1, 2.3, 3.3, 4.3}), AllOf(HasSubstr("uneven"), HasSubstr("b.dcm and c.dcm")));
  EXPECT_THAT(error_at({0, 1, 2, 3.05, 4.05}), AllOf(HasSubstr("uneven"), HasSubstr("c.dcm and d.dcm")));
}

TEST(StackSlices, RejectsFewerThanTwoSlices) {
  EXPECT_THAT(error_at({0}), AllOf(HasSubstr("at least two slices, found 1"), HasSubstr("a.dcm")));
  EXPECT_THAT(error_at({}), HasSubstr("found 0"));
}

/// Slices of a gantry tilted about the patient's x axis.
std::vector<DicomHeader> tilted_slices(double degrees) {
  std::vector<DicomHeader> slices = slices_at({0, 1, 2, 3});
  for (DicomHeader& slice : slices) slice.position_mm[1] += slice.position_mm[2] * std::tan(degrees * M_PI / 180.0);
  return slices;
}

TEST(StackSlices, MarksATiltedGantryForResampling) {
  const DicomStack stack = stack_slices(tilted_slices(15.0));
  EXPECT_TRUE(stack.needs_resampling);
  ASSERT_EQ(stack.places.size(), 4u);
  EXPECT_DOUBLE_EQ(stack.places[2].along_mm, 2.0);
  EXPECT_NEAR(stack.places[2].sideways_mm.x(), 0.0, 1e-12);
  EXPECT_NEAR(stack.places[2].sideways_mm.y(), 2.0 * std::tan(15.0 * M_PI / 180.0), 1e-12);
  EXPECT_NEAR(measure_stack(tilted_slices(15.0)).tilt_rad, 15.0 * M_PI / 180.0, 1e-12);
  EXPECT_FALSE(stack_slices(slices_at({0, 1, 2, 3})).needs_resampling);
}

TEST(StackSlices, RejectsATiltNoGantryHas) {
  EXPECT_THAT(error_of([&] { stack_slices(tilted_slices(60.0), true); }), HasSubstr("found 60 degrees"));
}

TEST(StackSlices, InterpolatesUnequalStepsAndGapsOnlyWhereAskedTo) {
  const DicomStack stack = stack_slices(slices_at({0, 1, 2, 4.5, 5.5}), true);
  EXPECT_TRUE(stack.needs_resampling);
  EXPECT_EQ(stack.geometry.spacing_mm.z(), 1.0);  // the usual step
  EXPECT_EQ(stack.places[3].along_mm, 4.5);
  EXPECT_THAT(error_at({0, 1, 2, 4, 5}), HasSubstr("CtReadOptions::resample"));
  try {
    stack_slices(slices_at({0, 1, 2, 4, 5}), false);
    ADD_FAILURE() << "a gap was read";
  } catch (const UnevenSlices& uneven) {
    EXPECT_THAT(uneven.found, AllOf(HasSubstr("a slice is missing"), Not(HasSubstr("CtReadOptions"))));
  }
  EXPECT_THAT(error_of([&] {
                stack_slices(slices_at({0, 1, 2, 9, 10}), true);
              }),
              AllOf(HasSubstr("found 7 mm between c.dcm and d.dcm"), HasSubstr("more than the 6 mm")));
  EXPECT_THAT(error_of([&] { stack_slices(slices_at({0, 1, 1, 2}), true); }), HasSubstr("two"));
}

TEST(StackSlices, TellsWhatNoSliceOfAGapShows) {
  // Slices stand for half a step to each side: of a gap of 2.5 mm they leave 1.5 mm, of unequal steps nothing.
  DicomStack stack = stack_slices(slices_at({10, 11, 12, 14.5, 15.5, 16.7, 17.7, 18.7}), true);
  ASSERT_EQ(stack.geometry.spacing_mm.z(), 1.0);
  const double base_mm = stack.geometry.directions.col(2).dot(stack.geometry.origin_mm);
  std::vector<Interval> slabs_mm = made_up_slabs(stack);
  ASSERT_EQ(slabs_mm.size(), 1U);
  EXPECT_NEAR(slabs_mm[0].low, base_mm + 2.5, 1e-9);
  EXPECT_NEAR(slabs_mm[0].high, base_mm + 4.0, 1e-9);
  EXPECT_TRUE(made_up_slabs(stack_slices(slices_at({0, 1, 2, 3}), true)).empty());
}

TEST(StackSlices, NamesASliceShiftedSideways) {
  EXPECT_THAT(error_with([](std::vector<DicomHeader>& slices) { slices[2].position_mm[0] += 0.2; }),
              AllOf(HasSubstr("sideways by 0.2 mm"), HasSubstr("c.dcm")));
  std::vector<DicomHeader> slices = slices_at({0, 1, 2, 3});
  slices[2].position_mm[0] += 0.2;
  EXPECT_NEAR(stack_slices(slices, true).places[2].sideways_mm.x(), 0.2, 1e-9);
}

TEST(StackSlices, RejectsNumbersThatAreMissingOrNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_with([&](auto& slices) {
                slices[1].pixel_spacing_mm = {nan, 0.5};
              }),
              AllOf(HasSubstr("PixelSpacing above 0 mm, found nan"), HasSubstr("b.dcm")));
  EXPECT_THAT(error_with([](auto& slices) { slices[1].pixel_spacing_mm = {0.5, 0.0}; }), HasSubstr("found 0 in b.dcm"));
  EXPECT_THAT(error_with([](auto& slices) { slices[1].pixel_spacing_mm = {0.6, 0.5}; }), HasSubstr("b.dcm"));
  EXPECT_THAT(error_with([](auto& slices) { slices[1].pixel_spacing_mm = {}; }), HasSubstr("found 0 in b.dcm"));
  EXPECT_THAT(error_with([&](auto& slices) { slices[1].position_mm[2] = nan; }), HasSubstr("b.dcm"));
  EXPECT_THAT(error_with([](auto& slices) { slices[1].position_mm = {}; }),
              HasSubstr("expected 3 numbers in ImagePositionPatient, found 0 in b.dcm"));
  EXPECT_THAT(error_with([](auto& slices) { slices[0].orientation = {1, 0, 0, 1, 0, 0}; }), HasSubstr("right angles"));
  EXPECT_THAT(error_with([](auto& slices) { slices[0].orientation = {1, 0, 0}; }), HasSubstr("6 numbers"));
}

}  // namespace
}  // namespace spinaltap
