#include "core/files/thermal_bone_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/data_files.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// What the reader says of the shipped file with the first `old_text` changed.
std::string complaint_of_thermal_bone(const std::string& old_text, const std::string& new_text) {
  const test::TemporaryFolder folder;
  std::string text = read_whole_file(data_file("thermal/bone.json"));
  const std::size_t at = text.find(old_text);
  if (at == std::string::npos) return "the shipped file has no " + old_text;
  text.replace(at, old_text.size(), new_text);
  const auto path = folder.path() / "bone.json";
  std::ofstream(path) << text;
  try {
    read_thermal_bone(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ThermalBoneFile, NamesFileAndKeyAtFault) {
  EXPECT_EQ(complaint_of_thermal_bone("\"temperature_c\": 37.0", "\"temperature_c\": 20.0"), "");
  EXPECT_THAT(complaint_of_thermal_bone("cortical_conductivity", "cortical_conductance"),
              AllOf(HasSubstr("bone.json"), HasSubstr("cortical_conductance")));
  EXPECT_THAT(complaint_of_thermal_bone("\"temperature_c\": 37.0", "\"temperature_c\": \"warm\""),
              AllOf(HasSubstr("bone.json"), HasSubstr("temperature_c")));
  EXPECT_THAT(complaint_of_thermal_bone("\"cortical_density_g_cm3\": 1.81", "\"cortical_density_g_cm3\": 0.1"),
              AllOf(HasSubstr("bone.json"), HasSubstr("denser")));
  EXPECT_THAT(complaint_of_thermal_bone("\"shear_angle_deg\": 45.0", "\"shear_angle_deg\": 0"),
              HasSubstr("shear angle"));
  EXPECT_THAT(complaint_of_thermal_bone("spinaltap-thermal-bone", "spinaltap-bits"), HasSubstr("bone.json"));
}

}  // namespace
}  // namespace spinaltap
