#include "core/session/operator/recorded_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kHead = "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n";

class PoseCsv : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    std::ofstream(folder_.path() / "poses.csv", std::ios::binary) << text;
    return folder_.path() / "poses.csv";
  }
  std::string rejection(const std::string& text) const {
    try {
      read_pose_csv(file(text));
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was rejected";
  }

  test::TemporaryFolder folder_;
};

TEST_F(PoseCsv, IsReadByTheNamesOfItsColumns) {
  const auto inputs =
      read_pose_csv(file("\xEF\xBB\xBFoperator,Z_mm,y_mm,x_mm,\"time_s\",axis_x,axis_y,axis_z,spindle_on\r\n"
                         "a,3,2,1,10.0,0,0,-2,1\r\n\r\nb,3.5,2,1,10.002,0,0,-1,0\r\nc,4,2,1,10.003,0,3,4,1\r\n"));
  ASSERT_EQ(inputs.size(), 3U);
  EXPECT_EQ(inputs[0].pose.tip_mm, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(inputs[0].pose.axis, Vec3(0.0, 0.0, -1.0));
  EXPECT_NEAR((inputs[2].pose.axis - Vec3(0.0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_TRUE(inputs[0].spindle_on);
  EXPECT_FALSE(inputs[1].spindle_on);
  EXPECT_NEAR(inputs[1].dt_s, 0.002, 1e-12);
  EXPECT_NEAR(inputs[2].dt_s, 0.001, 1e-12);
  EXPECT_EQ(inputs[0].dt_s, inputs[1].dt_s) << "the first has no time before it";
}

TEST_F(PoseCsv, SaysWhichWayAPlateIsTurned) {
  const auto inputs =
      read_pose_csv(file("time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,side_z,side_x,side_y\n"
                         "0,1,2,3,0,0,1,0,2,0\n0.1,1,2,3,0,0,1,0,0,0\n0.2,1,2,3,0,0,1,,,\r\n0.3,1,2,3,0,0,1,0,3,-4\n"));
  ASSERT_EQ(inputs.size(), 4U);
  EXPECT_EQ(inputs[0].pose.side, Vec3(1.0, 0.0, 0.0));
  EXPECT_EQ(inputs[1].pose.side, Vec3::Zero());
  EXPECT_EQ(inputs[2].pose.side, Vec3::Zero());
  EXPECT_NEAR((inputs[3].pose.side - Vec3(0.6, -0.8, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(read_pose_csv(file(kHead + "0,1,2,3,0,0,1\n"))[0].pose.side, Vec3::Zero());

  const std::string head = kHead.substr(0, kHead.size() - 1) + ",side_x,side_y,side_z\n";
  EXPECT_THAT(rejection(kHead.substr(0, kHead.size() - 1) + ",side_x,side_z\n0,1,2,3,0,0,1,1,0\n"),
              AllOf(HasSubstr("side_x, side_y and side_z"), HasSubstr("line 1")));
  EXPECT_THAT(rejection(head + "0,1,2,3,0,0,1,left,0,0\n"), AllOf(HasSubstr("side_x"), HasSubstr("left")));
  EXPECT_THAT(rejection(head + "0,1,2,3,0,0,1,1,0,0\n1,1,2,3,0,0,1,1,0,0.02\n"),
              AllOf(HasSubstr("across the axis"), HasSubstr("line 3")));
  EXPECT_THAT(rejection(head + "0,1,2,3,0,0,1,nan,0,0\n"), HasSubstr("across the axis"));
  EXPECT_EQ(read_pose_csv(file(head + "0,1,2,3,0,0,1,0,0,5\n"), {.lets_bad_poses_pass = true})[0].pose.side,
            Vec3(0.0, 0.0, 5.0))
      << "for the session to reject";
}

TEST_F(PoseCsv, SaysWhereItIsNoGood) {
  EXPECT_THAT(rejection(""), HasSubstr("poses.csv"));
  EXPECT_THAT(rejection(kHead), AllOf(HasSubstr("a pose at least"), HasSubstr("poses.csv")));
  EXPECT_THAT(rejection("x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n0,0,0,0,0,1\n"),
              AllOf(HasSubstr("time_s"), HasSubstr("line 1")));
  EXPECT_THAT(rejection("time_s,time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n"), HasSubstr("found two"));
  EXPECT_THAT(rejection(kHead + "0,1,2,3,0,0,1\n0.1,1,2,three,0,0,1\n"),
              AllOf(HasSubstr("z_mm"), HasSubstr("three"), HasSubstr("line 3")));
  EXPECT_THAT(rejection(kHead + "0,1,2,3,0,0,1\n\n0.1,1,2,3,0,0\n"),
              AllOf(HasSubstr("7 columns"), HasSubstr("line 4")));
  EXPECT_THAT(rejection(kHead + "0,1,2,3,0,0,1\n0,1,2,3,0,0,1\n"), AllOf(HasSubstr("rise"), HasSubstr("line 3")));
  EXPECT_THAT(rejection(kHead + "nan,1,2,3,0,0,1\n"), AllOf(HasSubstr("rise"), HasSubstr("line 2")));
  EXPECT_THAT(rejection(kHead + "0,1,nan,3,0,0,1\n"), AllOf(HasSubstr("finite"), HasSubstr("line 2")));
  EXPECT_THAT(rejection(kHead + "0,1,2,3,0,0,0\n"), AllOf(HasSubstr("not zero"), HasSubstr("line 2")));
  EXPECT_THAT(rejection("time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,spindle_on\n0,1,2,3,0,0,1,0.5\n"),
              AllOf(HasSubstr("spindle_on"), HasSubstr("line 2")));
  EXPECT_THROW(read_pose_csv(folder_.path() / "none.csv"), Error);
}

TEST_F(PoseCsv, LetsBadPosesPassOnRequest) {
  const auto inputs =
      read_pose_csv(file(kHead + "0,1,nan,3,0,0,1\n0.1,1,2,3,0,0,0\n0.2,1,2,3,0,0,1\n"), {.lets_bad_poses_pass = true});
  ASSERT_EQ(inputs.size(), 3U);
  EXPECT_TRUE(std::isnan(inputs[0].pose.tip_mm.y()));
  EXPECT_EQ(inputs[1].pose.axis, Vec3::Zero());
}

TEST(RecordedMotion, GivesItsPosesAndEndsWhenAskedToStop) {
  const std::vector<ToolInput> inputs(3);
  RecordedMotion tool_operator(inputs);
  EXPECT_EQ(tool_operator.count(), 3U);
  EXPECT_TRUE(tool_operator.next({}).has_value());
  EXPECT_FALSE(tool_operator.next({.stop = true}).has_value());
  EXPECT_TRUE(tool_operator.next({}).has_value());
  EXPECT_TRUE(tool_operator.next({}).has_value());
  EXPECT_FALSE(tool_operator.next({}).has_value());
  RecordedMotion deaf(inputs, false);
  EXPECT_TRUE(deaf.next({.stop = true}).has_value());
}

}  // namespace
}  // namespace spinaltap
