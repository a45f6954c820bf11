#include "core/files/registration_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/files/measured_points_file.h"
#include "core/registration/register_fiducials.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

class RegistrationFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  test::TemporaryFolder folder_;
};

TEST_F(RegistrationFile, ComesBackToTheLastBit) {
  const std::vector<Vec3> marks{{0, 0, 0}, {60, 5, 0}, {10, 50, 8}, {-30, 20, 40}};
  const std::vector<Vec3> measured{{0.1, 0, 0}, {60, 5, 0.3}, {10, 50.2, 8}, {-30, 20, 40}};
  Registration known = register_fiducials(marks, measured);
  known.warnings = {"said"};
  known.rejected = {3};
  const std::filesystem::path file = folder_.path() / "registration.json";
  write_registration(known, file);
  const Registration found = read_registration(file);
  EXPECT_TRUE(found.ct_from_patient.rotation.isApprox(known.ct_from_patient.rotation, 1e-15));
  EXPECT_EQ(found.ct_from_patient.translation_mm, known.ct_from_patient.translation_mm);
  EXPECT_EQ(found.covariance.turn_rad2, known.covariance.turn_rad2);
  EXPECT_EQ(found.covariance.shift_mm2, known.covariance.shift_mm2);
  EXPECT_EQ(found.residuals_mm, known.residuals_mm);
  EXPECT_EQ(found.rejected, known.rejected);
  EXPECT_EQ(found.warnings, known.warnings);
}

TEST_F(RegistrationFile, RejectsAPoseThatIsNoRotation) {
  const std::vector<Vec3> marks{{0, 0, 0}, {60, 5, 0}, {10, 50, 8}, {-30, 20, 40}};
  Registration known = register_fiducials(marks, marks);
  known.ct_from_patient.rotation(0, 0) = -3.0;
  write_registration(known, folder_.path() / "bad.json");
  EXPECT_THROW(read_registration(folder_.path() / "bad.json"), Error);
  EXPECT_THROW(read_registration(write("other.json", "{\"format\": \"spinaltap-plan\", \"version\": 2}")), Error);
}

TEST_F(RegistrationFile, PointsOfSlicerAndOfTablesAreLps) {
  const auto only = [](const std::vector<MeasuredPoint>& points) { return points.at(0).p_mm; };
  const Vec3 lps(1.0, 2.0, 3.0);
  EXPECT_EQ(only(read_measured_points(write("a.csv", "1,2,3\n"))), lps);
  EXPECT_EQ(only(read_measured_points(write("b.csv", "label,z_mm,y_mm,x_mm\nA,3,2,1\n"))), lps);
  EXPECT_EQ(only(read_measured_points(write("c.csv", "-1,-2,3\n"), MeasuredFrame::ras)), lps);
  const std::string row = ",0,0,0,1,1,1,0,F-1,,\n";
  EXPECT_EQ(only(read_measured_points(write("d.fcsv", "# CoordinateSystem = LPS\nid,1,2,3" + row))), lps);
  EXPECT_EQ(only(read_measured_points(write("e.fcsv", "# CoordinateSystem = RAS\nid,-1,-2,3" + row))), lps);
  EXPECT_EQ(only(read_measured_points(write("f.fcsv", "# CoordinateSystem = 0\nid,-1,-2,3" + row))), lps);
  const auto markups = [](const std::string& frame, const std::string& position) {
    return R"({"markups": [{"type": "Fiducial", "coordinateSystem": ")" + frame +
           R"(", "controlPoints": [{"label": "A", "position": )" + position + "}]}]}";
  };
  EXPECT_EQ(only(read_measured_points(write("g.mrk.json", markups("LPS", "[1, 2, 3]")))), lps);
  EXPECT_EQ(only(read_measured_points(write("h.mrk.json", markups("RAS", "[-1, -2, 3]")))), lps);
  EXPECT_THROW(read_measured_points(write("i.csv", "x_mm,y_mm,z_mm\n1,2,nan\n")), Error);
  EXPECT_THROW(read_measured_points(write("j.csv", "1,2\n")), Error);
  EXPECT_THROW(read_measured_points(write("k.csv", "")), Error);
}

TEST_F(RegistrationFile, PairsByLabelWhereAllHaveOne) {
  const std::vector<MeasuredPoint> a{{"A", Vec3(1, 0, 0)}, {"B", Vec3(2, 0, 0)}};
  const std::vector<MeasuredPoint> b{{"B", Vec3(20, 0, 0)}, {"A", Vec3(10, 0, 0)}};
  const PairedPoints pairs = pair_points(a, b);
  EXPECT_EQ(pairs.second_mm[0].x(), 10.0);
  EXPECT_EQ(pair_points(a, {{"", Vec3(20, 0, 0)}, {"", Vec3(10, 0, 0)}}).second_mm[0].x(), 20.0);
  EXPECT_THROW(pair_points(a, {{"C", Vec3(20, 0, 0)}, {"A", Vec3(10, 0, 0)}}), Error);
}

TEST_F(RegistrationFile, PosesOfQuaternionsAndOfMatricesAreTheSame) {
  const std::vector<RigidPose> a =
      read_tool_poses(write("q.csv", "x_mm,y_mm,z_mm,qw,qx,qy,qz\n5,6,7,0.7071067811865476,0,0,0.7071067811865476\n"));
  const std::vector<RigidPose> b = read_tool_poses(write("m.csv", "0,-1,0,5,1,0,0,6,0,0,1,7\n"));
  EXPECT_TRUE(a[0].rotation.isApprox(b[0].rotation, 1e-12));
  EXPECT_EQ(a[0].translation_mm, b[0].translation_mm);
  EXPECT_THROW(read_tool_poses(write("n.csv", "1,2,3\n")), Error);
  EXPECT_THROW(read_tool_poses(write("o.csv", "5,6,7,2,0,0,0\n")), Error);
}

}  // namespace
}  // namespace spinaltap
