#include "core/rbf/rbf_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

RbfModel good_model() {
  RbfModel model;
  model.centres_mm = {Vec3(1, 0, 0), Vec3(0, 3, 0)};
  model.weights = {2.0, -0.5};
  model.polynomial = {1.0, 0.1, 0.2, 0.3};
  return model;
}

std::string model_error(const RbfModel& model) {
  return test::error_of([&] { check_model(model); });
}

TEST(RbfModel, IsTakenWhenItIsRight) {
  EXPECT_EQ(model_error(good_model()), "");
  RbfModel model = good_model();
  model.kernel = RadialKernel::triharmonic;
  model.polynomial.resize(10);
  model.low_pass_mm = 0.5;
  EXPECT_EQ(model_error(model), "");
  model.centres_mm.clear();
  model.weights.clear();
  EXPECT_EQ(model_error(model), "");  // a polynomial alone
}

TEST(RbfModel, IsRejectedWhenSizesDoNotFit) {
  RbfModel model = good_model();
  model.weights.push_back(1.0);
  EXPECT_THAT(model_error(model), HasSubstr("each of 2 centres, found 3"));
  model = good_model();
  model.polynomial.pop_back();
  EXPECT_THAT(model_error(model), HasSubstr("4 polynomial coefficients, found 3"));
  model = good_model();
  model.kernel = RadialKernel::triharmonic;
  EXPECT_THAT(model_error(model), HasSubstr("10 polynomial coefficients, found 4"));
}

TEST(RbfModel, IsRejectedWhenANumberIsNone) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    RbfModel model = good_model();
    model.weights[1] = bad;
    EXPECT_THAT(model_error(model), HasSubstr("weight is not a number"));
    model = good_model();
    model.polynomial[3] = bad;
    EXPECT_THAT(model_error(model), HasSubstr("weight is not a number"));
    model = good_model();
    model.origin_mm.y() = bad;
    EXPECT_THAT(model_error(model), HasSubstr("not a number"));
    model = good_model();
    model.centres_mm[0].z() = bad;
    EXPECT_THAT(model_error(model), HasSubstr("centre is not a number"));
    model = good_model();
    model.low_pass_mm = bad;
    EXPECT_THAT(model_error(model), HasSubstr("low-pass width"));
  }
  RbfModel model = good_model();
  model.low_pass_mm = -0.1;
  EXPECT_THAT(model_error(model), HasSubstr("0 mm or more, found -0.1"));
}

}  // namespace
}  // namespace spinaltap
