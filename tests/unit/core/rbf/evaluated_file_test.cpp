#include "core/rbf/evaluated_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/staged_output.h"
#include "core/rbf/value_file.h"
#include "tests/support/error_of.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

class EvaluatedFile : public testing::Test {
 protected:
  std::string written(const EvaluatedPoints& points, const std::string& name) {
    write_evaluated(points, folder_.path() / name);
    return read_whole_file(folder_.path() / name);
  }

  test::TemporaryFolder folder_;
  std::vector<Vec3> points_mm_{{0.1, 1.0 / 3.0, -1e-300}, {1e17, 5e-324, -0.0}};
  std::vector<double> values_mm_{0.1 + 0.2, std::numeric_limits<double>::max()};
  std::vector<Vec3> gradients_{{0.6, 0.8, 0.0}, {-2.0 / 3.0, 1.0, 1e-9}};
};

TEST_F(EvaluatedFile, OfTextHasAHeaderAndTheShortestExactDigits) {
  EXPECT_EQ(written({points_mm_, values_mm_, {}}, "a.csv"),
            "x,y,z,value\n0.1,0.3333333333333333,-1e-300,0.30000000000000004\n"
            "1e+17,5e-324,-0,1.7976931348623157e+308\n");
  EXPECT_EQ(written({points_mm_, values_mm_, gradients_}, "a.csv"),
            "x,y,z,value,gx,gy,gz\n0.1,0.3333333333333333,-1e-300,0.30000000000000004,0.6,0.8,0\n"
            "1e+17,5e-324,-0,1.7976931348623157e+308,-0.6666666666666666,1,1e-09\n");
}

TEST_F(EvaluatedFile, GivesEveryNumberBackThroughTheReader) {
  for (const char* name : {"a.csv", "a.ply"}) {
    for (const bool has_gradients : {false, true}) {
      written({points_mm_, values_mm_, has_gradients ? gradients_ : std::vector<Vec3>()}, name);
      const RbfValues read = read_values(folder_.path() / name);
      EXPECT_EQ(read.points_mm, points_mm_);
      EXPECT_EQ(read.values_mm, values_mm_);
    }
  }
}

TEST_F(EvaluatedFile, OfPlyCallsTheGradientANormal) {
  const std::string bytes = written({points_mm_, values_mm_, gradients_}, "a.ply");
  EXPECT_THAT(bytes, HasSubstr("element vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
                               "property double value\nproperty double nx\nproperty double ny\nproperty double nz\n"
                               "end_header\n"));
  EXPECT_EQ(bytes.size() - bytes.find("end_header\n") - 11, 2U * 7U * 8U);
}

TEST_F(EvaluatedFile, IsRejectedOfAnotherKindOrSizeAndOnAFullDisk) {
  EXPECT_THAT(error_of([&] { written({points_mm_, values_mm_, {}}, "a.xyz"); }), HasSubstr("ends in .csv or .ply"));
  values_mm_.pop_back();
  EXPECT_THAT(error_of([&] { written({points_mm_, values_mm_, {}}, "a.csv"); }), HasSubstr("each of 2 points"));
  const std::vector<Vec3> many(1000, Vec3::Ones());
  const std::vector<double> values(1000, 0.5);
  const test::FullDisk full(4096);
  for (const char* name : {"b.csv", "b.ply"}) {
    EXPECT_THAT(error_of([&] { written({many, values, {}}, name); }), HasSubstr("cannot write")) << name;
  }
}

}  // namespace
}  // namespace spinaltap
