#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <string>

#include "core/base/error.h"
#include "core/files/json_file.h"
#include "core/files/material_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "tests/support/with_format.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::filesystem::path kShippedDensity =
    std::filesystem::path(test::kSourceFolder) / "data/densities/vertebra.json";

class DensityFile : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    const std::filesystem::path path = folder_.path() / "d.json";
    std::ofstream(path, std::ios::trunc) << test::with_format("spinaltap-density-calibration", text);
    return path;
  }
  void expect_rejected(const std::string& text, const char* with) const {
    EXPECT_THAT([&] { read_density_calibration(file(text)); },
                ThrowsMessage<Error>(AllOf(HasSubstr("d.json"), HasSubstr(with))))
        << text;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(DensityFile, ShipsTheDefaultsWithTheirSources) {
  const DensityCalibration shipped = read_density_calibration(kShippedDensity);
  EXPECT_EQ(shipped.line.at_0_hu, HuToDensity().at_0_hu);
  EXPECT_EQ(shipped.line.per_hu, HuToDensity().per_hu);
  EXPECT_EQ(shipped.rms_residual_g_cm3, 0.0);
  EXPECT_FALSE(read_json(kShippedDensity).at("sources").empty());
}

TEST_F(DensityFile, ReadsALine) {
  const HuToDensity line =
      read_density_calibration(file(R"({"density_at_0_hu_g_cm3": 0.1, "density_per_hu_g_cm3": 0.002})")).line;
  EXPECT_EQ(line.at_0_hu, 0.1);
  EXPECT_EQ(line.per_hu, 0.002);
}

TEST_F(DensityFile, LaysALineThroughACalibration) {
  const DensityCalibration read =
      read_density_calibration(file(R"({"calibration": [[0, 0.1], [1000, 1.4], [2000, 2.1]]})"));
  EXPECT_NEAR(read.line.at_0_hu, 0.2, 1e-14);
  EXPECT_NEAR(read.line.per_hu, 0.001, 1e-16);
  EXPECT_NEAR(read.max_residual_g_cm3, 0.2, 1e-14);
}

TEST_F(DensityFile, IsRejectedWithFileAndFaultNamed) {
  expect_rejected("[]", "object");
  expect_rejected("{}", "density_at_0_hu_g_cm3");
  expect_rejected(R"({"density_at_0_hu_g_cm3": 0.1})", "density_per_hu_g_cm3");
  expect_rejected(R"({"density_at_0_hu_g_cm3": "a", "density_per_hu_g_cm3": 0.002})", "number");
  expect_rejected(R"({"density_at_0_hu_g_cm3": 0.1, "density_per_hu_g_cm3": -0.002})", "density_per_hu");
  expect_rejected(R"({"density_at_0_hu_g_cm3": 0.1, "calibration": [[0, 0.1], [100, 0.2]]})", "both");
  expect_rejected(R"({"calibration": 3})", "list");
  expect_rejected(R"({"calibration": [[0, 0.1], [100]]})", "pairs");
  expect_rejected(R"({"calibration": [[0, 0.1], [100, "b"]]})", "pairs");
  expect_rejected(R"({"calibration": [[0, 0.1]]})", "two pairs");
  expect_rejected(R"({"calibration": [[0, 0.2], [100, 0.1]]})", "rise");
}

const std::filesystem::path kShippedMaterial =
    std::filesystem::path(test::kSourceFolder) / "data/materials/vertebra.json";

/// Every key, and the member that it is for.
const std::map<std::string, double Material::*> kMembers{
    {"specific_cutting_energy_mpa", &Material::specific_cutting_energy_mpa},
    {"cutting_exponent", &Material::cutting_exponent},
    {"reference_feed_mm", &Material::reference_feed_mm},
    {"feed_exponent", &Material::feed_exponent},
    {"lip_thrust_share", &Material::lip_thrust_share},
    {"chisel_mpa", &Material::chisel_mpa},
    {"chisel_exponent", &Material::chisel_exponent},
    {"chisel_share", &Material::chisel_share},
    {"contact_n_mm", &Material::contact_n_mm},
    {"contact_exponent", &Material::contact_exponent}};

TEST(MaterialFile, ShipsTheDefaults) {
  const Material shipped = read_material(kShippedMaterial, {});
  for (const auto& [key, member] : kMembers) EXPECT_EQ(shipped.*member, Material().*member) << key;
}

TEST(MaterialFile, ReadsEachKeyIntoItsOwnMember) {
  const test::TemporaryFolder folder;
  Json json{{"format", "spinaltap-cutting-model"}, {"version", 2}};
  double value = 0.01;
  for (const auto& [key, member] : kMembers) json[key] = value += 0.01;
  std::ofstream(folder.path() / "m.json") << json.dump();
  const Material material = read_material(folder.path() / "m.json", {0.1, 0.002});
  EXPECT_EQ(material.density.at_0_hu, 0.1);
  EXPECT_EQ(material.density.per_hu, 0.002);
  value = 0.01;
  for (const auto& [key, member] : kMembers) EXPECT_EQ(material.*member, value += 0.01) << key;
}

TEST(MaterialFile, IsRejectedWithFileAndKeyNamed) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.json";
  for (const auto& [key, member] : kMembers) {
    // Missing, of the wrong type, and without sense.
    for (const Json& value : {Json(), Json("1"), Json(-1e6)}) {
      Json json = read_json(kShippedMaterial);
      if (value.is_null()) {
        json.erase(key);
      } else {
        json[key] = value;
      }
      std::ofstream(path, std::ios::trunc) << json.dump();
      EXPECT_THAT([&] { read_material(path, {}); }, ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(key))))
          << key << ": " << value;
    }
  }
  EXPECT_THAT([&] { read_material(folder.path() / "none.json", {}); }, ThrowsMessage<Error>(HasSubstr("no such file")));
}

TEST(MaterialFile, ShipsTheDefaultSpreadsAndTheMechanisticLaw) {
  const Material shipped = read_material(kShippedMaterial, {});
  EXPECT_EQ(shipped.law, CuttingLaw::power);
  EXPECT_EQ(shipped.thrust_spread, Material().thrust_spread);
  EXPECT_EQ(shipped.torque_spread, Material().torque_spread);
  const Material mechanistic = read_material(kShippedMaterial.parent_path() / "mechanistic.json", {});
  EXPECT_EQ(mechanistic.law, CuttingLaw::mechanistic);
  EXPECT_EQ(mechanistic.lips.friction_deg, 29.39);
  EXPECT_GT(mechanistic.thrust_spread.log_scale, 0.0);
}

TEST(MaterialFile, OfBeforeIsThePowerLawWithoutABand) {
  const test::TemporaryFolder folder;
  Json json = read_json(kShippedMaterial);
  for (const char* key : {"law", "thrust_spread", "torque_spread"}) json.erase(key);
  std::ofstream(folder.path() / "m.json") << json.dump();
  const Material material = read_material(folder.path() / "m.json", {});
  EXPECT_EQ(material.law, CuttingLaw::power);
  EXPECT_EQ(material.thrust_spread, ForceSpread{});
  EXPECT_EQ(material.torque_spread, ForceSpread{});
}

TEST(MaterialFile, RejectsLawsAndSpreadsThatMakeNoSense) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.json";
  const auto rejects = [&](const char* key, const Json& value, const char* with) {
    Json json = read_json(kShippedMaterial.parent_path() / "mechanistic.json");
    if (value.is_null()) {
      json.erase(key);
    } else {
      json[key] = value;
    }
    std::ofstream(path, std::ios::trunc) << json.dump();
    EXPECT_THAT([&] { read_material(path, {}); }, ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(with))))
        << value;
  };
  rejects("law", "linear", "power or mechanistic");
  rejects("lips", nullptr, "lips");
  rejects("lips", Json::object(), "friction_deg");
  Json lips = read_json(kShippedMaterial.parent_path() / "mechanistic.json").at("lips");
  lips["friction_deg"] = 60.0;
  rejects("lips", lips, "friction_deg");
  rejects("thrust_spread", {{"median", 1.0}, {"log_scale", -0.5}, {"degrees_of_freedom", 4}}, "log_scale");
  rejects("torque_spread", {{"median", 1.0}, {"log_scale", 0.5}, {"degrees_of_freedom", 4.5}}, "degrees_of_freedom");
  rejects("thrust_spread", {{"median", 1.0}}, "log_scale");
}

TEST(MaterialFile, IsRejectedWhereItHoldsWhatIsReadElsewhere) {
  const test::TemporaryFolder folder;
  for (const char* key : {"density_at_0_hu_g_cm3", "density_per_hu_g_cm3"}) {
    Json json = read_json(kShippedMaterial);
    json[key] = 0.002;
    std::ofstream(folder.path() / "m.json", std::ios::trunc) << json.dump();
    EXPECT_THAT([&] { read_material(folder.path() / "m.json", {}); },
                ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(key))));
  }
}

TEST(MaterialFile, OfVersionOneIsRejectedByName) {
  const test::TemporaryFolder folder;
  Json json = read_json(kShippedMaterial);
  json["version"] = 1;
  std::ofstream(folder.path() / "m.json") << json.dump();
  EXPECT_THAT([&] { read_material(folder.path() / "m.json", {}); },
              ThrowsMessage<Error>(HasSubstr("this is a version 1 cutting model; version 2 is expected")));
  // Those that were before versions had neither key.
  json.erase("format");
  json.erase("version");
  std::ofstream(folder.path() / "m.json", std::ios::trunc) << json.dump();
  EXPECT_THAT([&] { read_material(folder.path() / "m.json", {}); },
              ThrowsMessage<Error>(HasSubstr("this is a version 1 cutting model, or none")));
}

}  // namespace

}  // namespace spinaltap
