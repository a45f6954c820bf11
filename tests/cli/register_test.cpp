// Where the patient is, as from a shell: marks and touched points of a phantom, in a frame that is known.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/files/registration_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::run_program;

class Register : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
  test::TemporaryFolder folder_;
};

TEST_F(Register, FindsMarksAndEndsWith0) {
  // Turned by a quarter about z and shifted by (5, 6, 7), label by label in another order.
  write("ct.csv", "label,x_mm,y_mm,z_mm\nA,0,0,0\nB,60,5,0\nC,10,50,8\nD,-30,20,40\n");
  write("patient.csv", "label,x_mm,y_mm,z_mm\nD,14,35,33\nC,44,-5,1\nB,-1,-55,-7\nA,-6,5,-7\n");
  const auto run = run_program("register --fiducials ct.csv --patient patient.csv --fle 0.5 -o r.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  const Registration found = read_registration(folder_.path() / "r.json");
  EXPECT_LT((found.ct_from_patient.apply(Vec3(-6, 5, -7)) - Vec3(0, 0, 0)).norm(), 1e-9);
  EXPECT_LT((found.ct_from_patient.apply(Vec3(14, 35, 33)) - Vec3(-30, 20, 40)).norm(), 1e-9);
}

TEST_F(Register, EndsWith1WhereAMarkMoved) {
  write("ct.csv", "0,0,0\n60,5,0\n10,50,8\n-30,20,40\n25,-30,30\n");
  write("patient.csv", "0,0,0\n60,5,0\n10,50,8\n-30,20,52\n25,-30,30\n");
  const auto run = run_program("register --fiducials ct.csv --patient patient.csv --fle 0.5 -o r.json", folder_.path());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.output.find("fiducial 4 does not fit"), std::string::npos) << run.output;
  EXPECT_FALSE(read_registration(folder_.path() / "r.json").warnings.empty());
}

TEST_F(Register, EndsWith2WithoutEnoughToGoBy) {
  EXPECT_EQ(run_program("register -o r.json", folder_.path()).exit_code, 2);
  write("ct.csv", "0,0,0\n60,5,0\n");
  EXPECT_EQ(run_program("register --fiducials ct.csv --patient ct.csv -o r.json", folder_.path()).exit_code, 2);
  EXPECT_EQ(run_program("register --fiducials ct.csv -o r.json", folder_.path()).exit_code, 2);
  EXPECT_EQ(run_program("register --touched ct.csv -o r.json", folder_.path()).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "r.json"));
}

TEST_F(Register, PivotFindsATipAndRefusesAToolThatHardlyTurned) {
  const Vec3 tip(3, -2, 140), dimple(-80, 40, -1200);
  for (const auto& [name, lean_deg] : {std::pair{"wide.csv", 30.0}, {"narrow.csv", 4.0}}) {
    std::ofstream file(folder_.path() / name);
    file.precision(12);
    for (int n = 0; n < 40; ++n) {
      const Mat3 turn =
          (Eigen::AngleAxisd(0.5 * n, Vec3::UnitZ()) * Eigen::AngleAxisd(lean_deg * kDegree, Vec3::UnitX()) *
           Eigen::AngleAxisd(0.9 * n, Vec3::UnitZ()))
              .toRotationMatrix();
      const Vec3 at = dimple - turn * tip;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) file << turn(row, column) << ',';
        file << at[row] << (row < 2 ? "," : "\n");
      }
    }
  }
  const auto run = run_program("pivot wide.csv -o pivot.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  const auto json = nlohmann::json::parse(std::ifstream(folder_.path() / "pivot.json"));
  EXPECT_NEAR(json.at("tip_mm").at(2).get<double>(), 140.0, 1e-6);
  const auto refused = run_program("pivot narrow.csv -o other.json", folder_.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("turn it further"), std::string::npos) << refused.errors;
}

}  // namespace
}  // namespace spinaltap
