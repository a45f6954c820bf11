#include "core/files/material_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/json_file.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::filesystem::path kShipped = std::filesystem::path(SPINALTAP_SOURCE_DIR) / "data/densities/vertebra.json";

class DensityFile : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    const std::filesystem::path path = folder_.path() / "d.json";
    std::ofstream(path, std::ios::trunc) << text;
    return path;
  }
  void expect_refused(const std::string& text, const char* with) const {
    EXPECT_THAT([&] { read_density_law(file(text)); },
                ThrowsMessage<Error>(AllOf(HasSubstr("d.json"), HasSubstr(with))))
        << text;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(DensityFile, ShipsTheDefaultsWithTheirSources) {
  const DensityCalibration shipped = read_density_law(kShipped);
  EXPECT_EQ(shipped.law.at_0_hu, DensityLaw().at_0_hu);
  EXPECT_EQ(shipped.law.per_hu, DensityLaw().per_hu);
  EXPECT_EQ(shipped.rms_residual_g_cm3, 0.0);
  EXPECT_FALSE(read_json(kShipped).at("sources").empty());
}

TEST_F(DensityFile, ReadsALine) {
  const DensityLaw law = read_density_law(file(R"({"density_at_0_hu_g_cm3": 0.1, "density_per_hu_g_cm3": 0.002})")).law;
  EXPECT_EQ(law.at_0_hu, 0.1);
  EXPECT_EQ(law.per_hu, 0.002);
}

TEST_F(DensityFile, LaysALineThroughACalibration) {
  const DensityCalibration read = read_density_law(file(R"({"calibration": [[0, 0.1], [1000, 1.4], [2000, 2.1]]})"));
  EXPECT_NEAR(read.law.at_0_hu, 0.2, 1e-14);
  EXPECT_NEAR(read.law.per_hu, 0.001, 1e-16);
  EXPECT_NEAR(read.most_residual_g_cm3, 0.2, 1e-14);
}

TEST_F(DensityFile, IsRefusedWithFileAndFaultNamed) {
  expect_refused("[]", "object");
  expect_refused("{}", "density_at_0_hu_g_cm3");
  expect_refused(R"({"density_at_0_hu_g_cm3": 0.1})", "density_per_hu_g_cm3");
  expect_refused(R"({"density_at_0_hu_g_cm3": "a", "density_per_hu_g_cm3": 0.002})", "number");
  expect_refused(R"({"density_at_0_hu_g_cm3": 0.1, "density_per_hu_g_cm3": -0.002})", "density_per_hu");
  expect_refused(R"({"density_at_0_hu_g_cm3": 0.1, "calibration": [[0, 0.1], [100, 0.2]]})", "both");
  expect_refused(R"({"calibration": 3})", "list");
  expect_refused(R"({"calibration": [[0, 0.1], [100]]})", "pairs");
  expect_refused(R"({"calibration": [[0, 0.1], [100, "b"]]})", "pairs");
  expect_refused(R"({"calibration": [[0, 0.1]]})", "two pairs");
  expect_refused(R"({"calibration": [[0, 0.2], [100, 0.1]]})", "rise");
}

}  // namespace
}  // namespace spinaltap
