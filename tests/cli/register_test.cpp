// Where the patient is, as from a shell: marks and touched points of a phantom, in a frame that is known.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/random.h"
#include "core/files/registration_file.h"
#include "core/phantom/surface_seeds.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
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
  EXPECT_EQ(run_program("register --surface-points ct.csv -o r.json", folder_.path()).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "r.json"));
}

/// Every so many places of the phantom's surface behind its canal, touched with a noise of 0.3 mm to each side.
std::vector<Vec3> touched_phantom(std::size_t count) {
  const Vertebra phantom;
  std::vector<Vec3> behind;
  for (Vec3 p_mm : surface_seeds(phantom, 1.0)) {
    for (int round = 0; round < 3; ++round) {
      double value_mm = 0.0;
      Vec3 gradient = Vec3::Zero();
      phantom.evaluate({&p_mm, 1}, {&value_mm, 1}, {&gradient, 1});
      p_mm -= value_mm / gradient.squaredNorm() * gradient;
    }
    if (p_mm.y() > 30.0) behind.push_back(p_mm);
  }
  std::vector<Vec3> touched;
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 noise(random_normal(7, 3 * n), random_normal(7, 3 * n + 1), random_normal(7, 3 * n + 2));
    touched.push_back(behind[n * behind.size() / count] + 0.3 * noise);
  }
  return touched;
}

TEST_F(Register, FindsATouchedBoneAndTellsOfAPatchThatDoesNotHoldIt) {
  constexpr const char* kPhantom =
      "phantom l3 --pixel 1.6 --size 80 --slice-step 3.5 --slices 14 --ground-truth-voxel 0.5";
  ASSERT_EQ(run_program(kPhantom, folder_.path()).exit_code, 0);
  const RigidPose patient_from_ct =
      small_motion(Vec3(0.10, -0.08, 0.12), Vec3(6.0, -5.0, 9.0), Vec3(0.0, 30.0, 0.0)).inverse();
  std::ostringstream all, patch;
  const std::vector<Vec3> touched = touched_phantom(2000);
  for (std::size_t n = 0; n < touched.size(); ++n) {
    const Vec3 p_mm = patient_from_ct.apply(touched[n]);
    if (n % 40 == 0) all << p_mm.x() << ',' << p_mm.y() << ',' << p_mm.z() << '\n';
    if (n % 6 == 0 && (touched[n] - touched[1000]).norm() < 8.0)
      patch << p_mm.x() << ',' << p_mm.y() << ',' << p_mm.z() << '\n';
  }
  write("all.csv", all.str());
  write("patch.csv", patch.str());
  const auto run = run_program(
      "register l3/ground_truth.vdb --surface-points all.csv --noise 0.3 -o r.json --json told.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  const RigidPose found = read_registration(folder_.path() / "r.json").ct_from_patient;
  const auto told = nlohmann::json::parse(std::ifstream(folder_.path() / "told.json"));
  const VertebraGroundTruth truth = vertebra_ground_truth(Vertebra());
  for (const auto& [n, pedicle] : {std::pair{0U, truth.left}, {1U, truth.right}}) {
    const double error_mm = (found.apply(patient_from_ct.apply(pedicle.isthmus_mm)) - pedicle.isthmus_mm).norm();
    const double tre_mm = told.at("targets").at(n).at("tre_mm").get<double>();
    EXPECT_LT(tre_mm, 0.5);
    EXPECT_LT(error_mm, 3.0 * tre_mm);  // of some 0.25 mm
  }
  const auto held =
      run_program("register l3/ground_truth.vdb --surface-points patch.csv --noise 0.3 -o p.json", folder_.path());
  EXPECT_EQ(held.exit_code, 1) << held.output;
  EXPECT_NE(held.output.find("warning"), std::string::npos) << held.output;
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
