#include "core/ct/detail/nifti_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// 101 voxels of 1.5 mm along each axis, both transforms the scanner's and alike.
NiftiForms alike() {
  NiftiForms forms;
  forms.size = {101, 101, 101};
  forms.sform = {1, 1.5 * Mat3::Identity(), Vec3(-30, 135, -103)};
  forms.qform = forms.sform;
  forms.pixdim_mm = Vec3::Constant(1.5);
  return forms;
}

NiftiPlace place(const NiftiForms& forms, NiftiAffine choice = NiftiAffine::automatic) {
  return place_nifti(forms, choice, "ct.nii");
}

std::string rejection(const NiftiForms& forms, NiftiAffine choice = NiftiAffine::automatic) {
  return error_of([&] { place(forms, choice); });
}

TEST(PlaceNifti, SaysNothingWhereBothTransformsAgreeButForRounding) {
  EXPECT_THAT(place(alike()).warnings, IsEmpty());
  NiftiForms rounded = alike();
  rounded.qform.origin_mm.x() += 0.05;
  EXPECT_THAT(place(rounded).warnings, IsEmpty());
  // Near half a turn a quaternion of 32 bits is good to 6e-4 rad: 0.16 mm at 260 mm.
  rounded = alike();
  rounded.qform.steps_mm = Eigen::AngleAxisd(6e-4, Vec3::UnitX()) * rounded.qform.steps_mm;
  rounded.qform_rounding_rad = 7e-4;
  EXPECT_THAT(place(rounded).warnings, IsEmpty());
  rounded.qform_rounding_rad = 1e-6;
  EXPECT_THAT(place(rounded).warnings, SizeIs(1));
  // Of two that agree the code says nothing.
  NiftiForms in_template = alike();
  in_template.sform.code = 4;
  EXPECT_THAT(place(in_template).warnings, IsEmpty());
}

TEST(PlaceNifti, TakesTheScannersQformBesideAnSformThatIsScaledToATemplate) {
  for (const int code : {3, 4, 5}) {
    NiftiForms forms = alike();
    forms.sform.code = code;
    forms.sform.steps_mm *= 1.1;
    const NiftiPlace found = place(forms);
    EXPECT_EQ(found.steps_mm, forms.qform.steps_mm);
    ASSERT_THAT(found.warnings, SizeIs(1));
    // 10 % of the diagonal of 150 mm; both places of the farthest corner.
    EXPECT_THAT(found.warnings.front(),
                AllOf(HasSubstr("25.9808 mm apart"), HasSubstr("135"), HasSubstr("120"), HasSubstr("1.65 x 1.65"),
                      HasSubstr("the qform is taken"), HasSubstr("ITK"), HasSubstr("3D Slicer"), HasSubstr("nibabel")));
  }
}

TEST(PlaceNifti, TakesTheScannersSformBesideAQformThatLiesElsewhere) {
  NiftiForms forms = alike();
  forms.qform.origin_mm.y() += 4.0;
  const NiftiPlace found = place(forms);
  EXPECT_EQ(found.origin_mm, forms.sform.origin_mm);
  ASSERT_THAT(found.warnings, SizeIs(1));
  EXPECT_THAT(found.warnings.front(),
              AllOf(HasSubstr("4 mm apart"), HasSubstr("3D Slicer from 5.0 on take the sform")));
  forms.qform = alike().qform;
  forms.qform.steps_mm = Eigen::AngleAxisd(0.02, Vec3::UnitZ()) * forms.qform.steps_mm;
  EXPECT_THAT(place(forms).warnings, SizeIs(1));
}

TEST(PlaceNifti, TakesSlicesThatLeanFromTheSformWhichAQformCannotHold) {
  NiftiForms forms = alike();
  forms.sform.steps_mm.col(2) = 1.5 * Vec3(0.0, std::sin(0.2), std::cos(0.2));
  const NiftiPlace found = place(forms);
  EXPECT_EQ(found.steps_mm, forms.sform.steps_mm);
  ASSERT_THAT(found.warnings, SizeIs(1));
  EXPECT_THAT(found.warnings.front(), AllOf(HasSubstr("lean"), HasSubstr("3D Slicer from 5.0 on take the qform")));
  forms.pixdim_mm.z() = 1.5 * std::cos(0.2);  // the slices' distance is said by some
  EXPECT_EQ(place(forms).steps_mm, forms.sform.steps_mm);
}

TEST(PlaceNifti, RejectsWhatLeavesThePlaceUnsure) {
  // Shear half undone, as dcm2niix of 2022 wrote it.
  NiftiForms forms = alike();
  forms.sform.steps_mm.col(1) = Vec3(0.0, 1.6, -0.5);
  forms.sform.steps_mm.col(2) = Vec3(0.0, 0.0, 1.4);
  EXPECT_THAT(rejection(forms), AllOf(HasSubstr("tilted gantry"), HasSubstr("pixdim says 1.5 x 1.5 x 1.5 mm"),
                                      HasSubstr("apart at the farthest corner"), HasSubstr("ct.nii")));
  forms = alike();
  forms.sform.steps_mm.col(0) *= -1.0;
  EXPECT_THAT(rejection(forms), HasSubstr("mirrors"));
  forms = alike();
  forms.sform.code = 2;
  forms.sform.origin_mm.x() += 3.0;
  EXPECT_THAT(rejection(forms), HasSubstr("neither is sure"));
  forms = alike();
  forms.qform.code = 0;
  forms.sform.steps_mm *= 1.1;
  EXPECT_THAT(rejection(forms), AllOf(HasSubstr("1.65 x 1.65 x 1.65"), HasSubstr("no qform")));
  forms = alike();
  forms.sform.code = forms.qform.code = 0;
  EXPECT_THAT(rejection(forms), HasSubstr("both codes are 0"));
  forms = alike();
  forms.pixdim_mm.y() = -1.5;
  EXPECT_THAT(rejection(forms), HasSubstr("above 0 as pixdim"));
}

TEST(PlaceNifti, TakesWhatIsAskedFor) {
  NiftiForms forms = alike();
  forms.sform.steps_mm.col(1) = Vec3(0.0, 1.6, -0.5);
  EXPECT_EQ(place(forms, NiftiAffine::sform).steps_mm, forms.sform.steps_mm);
  EXPECT_EQ(place(forms, NiftiAffine::qform).steps_mm, forms.qform.steps_mm);
  EXPECT_THAT(place(forms, NiftiAffine::qform).warnings, IsEmpty());
  forms.qform.code = 0;
  EXPECT_THAT(rejection(forms, NiftiAffine::qform), HasSubstr("qform_code is 0"));
}

TEST(PlaceNifti, WarnsOfAnSformAloneInATemplatesSpace) {
  NiftiForms forms = alike();
  forms.qform.code = 0;
  EXPECT_THAT(place(forms).warnings, IsEmpty());
  forms.sform.code = 3;
  EXPECT_THAT(place(forms).warnings, ElementsAre(HasSubstr("Talairach")));
  // Steps that are not said cannot contradict.
  forms.sform.code = 1;
  forms.pixdim_mm = Vec3(0.0, std::numeric_limits<double>::quiet_NaN(), 1.5);
  EXPECT_THAT(place(forms).warnings, IsEmpty());
}

TEST(PlaceNifti, RejectsStepsThatAreNoCtsInTheHeadersUnit) {
  NiftiForms forms = alike();
  forms.unit = 2;
  for (const double factor : {0.001, 1000.0}) {
    NiftiForms other = forms;
    other.sform.steps_mm *= factor;
    other.qform.steps_mm *= factor;
    other.pixdim_mm *= factor;
    EXPECT_THAT(rejection(other), AllOf(HasSubstr("xyzt_units"), HasSubstr("in mm")));
  }
}

}  // namespace
}  // namespace spinaltap
