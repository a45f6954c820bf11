#include "apps/common/material_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/common/json_file.h"
#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::filesystem::path kShipped = std::filesystem::path(SPINALTAP_SOURCE_DIR) / "data/materials/vertebra.json";

TEST(MaterialFile, ShipsTheDefaults) {
  const Material shipped = read_material(kShipped, {});
  const Material defaults;
  EXPECT_EQ(shipped.pressure_at_1_g_cm3, defaults.pressure_at_1_g_cm3);
  EXPECT_EQ(shipped.pressure_exponent, defaults.pressure_exponent);
}

TEST(MaterialFile, ReadsEachKeyIntoItsOwnMember) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "m.json") << R"({"pressure_at_1_g_cm3_mpa": 3, "pressure_exponent": 1.5})";
  const Material material = read_material(folder.path() / "m.json", {0.1, 0.002});
  EXPECT_EQ(material.density.at_0_hu, 0.1);
  EXPECT_EQ(material.density.per_hu, 0.002);
  EXPECT_EQ(material.pressure_at_1_g_cm3, 3.0);
  EXPECT_EQ(material.pressure_exponent, 1.5);
}

TEST(MaterialFile, IsRefusedWithFileAndKeyNamed) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.json";
  for (const char* key : {"pressure_at_1_g_cm3_mpa", "pressure_exponent"}) {
    // Missing, of the wrong type, and without sense.
    for (const Json& value : {Json(), Json("1"), Json(-1e6)}) {
      Json json = read_json(kShipped);
      if (value.is_null()) {
        json.erase(key);
      } else {
        json[key] = value;
      }
      std::ofstream(path, std::ios::trunc) << json.dump();
      // Where the law itself is refused, the message says the member's name without the unit.
      const std::string stem = std::string(key).substr(0, 14);
      EXPECT_THAT([&] { read_material(path, {}); }, ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(stem))))
          << key << ": " << value;
    }
  }
  EXPECT_THAT([&] { read_material(folder.path() / "none.json", {}); }, ThrowsMessage<Error>(HasSubstr("no such file")));
}

TEST(MaterialFile, IsRefusedWhereItHoldsTheDensityToo) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "m.json")
      << R"({"density_per_hu_g_cm3": 0.002, "pressure_at_1_g_cm3_mpa": 3, "pressure_exponent": 1.5})";
  EXPECT_THAT([&] { read_material(folder.path() / "m.json", {}); },
              ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr("density_per_hu_g_cm3"))));
}

}  // namespace
}  // namespace spinaltap
