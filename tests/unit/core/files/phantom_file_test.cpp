#include "core/files/phantom_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/phantom/vertebra.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "tests/support/with_format.h"

namespace spinaltap {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kShipped = std::filesystem::path(test::kSourceFolder) / "data/phantom/l3.json";

json shipped() { return json::parse(std::ifstream(kShipped)); }

class PhantomFile : public testing::Test {
 protected:
  VertebraAnatomy read_text(const std::string& text) {
    std::ofstream(path()) << test::with_format("spinaltap-anatomy", text);
    return read_anatomy(path());
  }
  std::string message(const std::string& text) {
    try {
      read_text(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  std::filesystem::path path() const { return folder_.path() / "bone.json"; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(PhantomFile, ShipsTheDefaults) {
  const Vertebra from_file(read_anatomy(kShipped)), from_code;
  EXPECT_EQ(from_file.bounds_mm().min(), from_code.bounds_mm().min());
  EXPECT_EQ(from_file.bounds_mm().max(), from_code.bounds_mm().max());
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p(-40.0 + n % 17 * 5.0, -20.0 + n / 17 % 16 * 5.0, -28.0 + n / 272 * 6.0);
    double a = 0.0, b = 0.0;
    from_file.evaluate({&p, 1}, {&a, 1}, {});
    from_code.evaluate({&p, 1}, {&b, 1}, {});
    ASSERT_EQ(a, b) << p.transpose();
    ASSERT_EQ(from_file.hu(p, -0.4, 0.2), from_code.hu(p, -0.4, 0.2));
    ASSERT_EQ(from_file.hu(p, -5.0, 0.2), from_code.hu(p, -5.0, 0.2));
  }
}

TEST_F(PhantomFile, HasASourceForEveryGroup) {
  const json whole = shipped();
  for (const auto& [key, group] : whole.items()) {
    EXPECT_TRUE(!group.is_object() || group.contains("source")) << key;
  }
}

TEST_F(PhantomFile, ReadsEveryShippedValueIntoItsOwnMember) {
  // Each number made absurd alone must be rejected under its own name, so it went into its own member.
  const json whole = shipped();
  for (const auto& [name, group] : whole.items()) {
    if (!group.is_object()) continue;
    for (const auto& [key, value] : group.items()) {
      if (!value.is_number_float()) continue;
      json changed = whole;
      changed[name][key] = 1e9;
      EXPECT_THAT(message(changed.dump()), AllOf(HasSubstr(name + "." + key), HasSubstr("bone.json")));
    }
  }
}

TEST_F(PhantomFile, TakesTheDefaultForMissingKeys) {
  const VertebraAnatomy anatomy = read_text(R"({"body": {"width_mm": 46}})");
  EXPECT_EQ(anatomy.body.width_mm, 46.0);
  EXPECT_EQ(anatomy.body.depth_mm, VertebraAnatomy().body.depth_mm);
  EXPECT_EQ(anatomy.pedicle.width_mm, VertebraAnatomy().pedicle.width_mm);
}

TEST_F(PhantomFile, TakesTheLeftPediclesValuesForMissingOnesOfTheRight) {
  const VertebraAnatomy plain = read_text(R"({"pedicle": {"width_mm": 8}})");
  EXPECT_FALSE(plain.right_pedicle.has_value());
  const VertebraAnatomy anatomy =
      read_text(R"({"right_pedicle": {"height_mm": 13, "source": "made up"}, "pedicle": {"width_mm": 8}})");
  ASSERT_TRUE(anatomy.right_pedicle.has_value());
  EXPECT_EQ(anatomy.right_pedicle->width_mm, 8.0);
  EXPECT_EQ(anatomy.right_pedicle->height_mm, 13.0);
  EXPECT_EQ(anatomy.pedicle.height_mm, VertebraAnatomy().pedicle.height_mm);
}

TEST_F(PhantomFile, NamesFileAndKeyOfWhatItRejects) {
  const auto names = [](const char* key) { return AllOf(HasSubstr("bone.json"), HasSubstr(key)); };
  EXPECT_THAT(message(R"({"body": {"width": 44}})"), names("unknown key body.width"));
  EXPECT_THAT(message(R"({"right_pedicle": {"girth_mm": 4}})"), names("unknown key right_pedicle.girth_mm"));
  EXPECT_THAT(message(R"({"right_pedicle": {"width_mm": 99}})"), names("right_pedicle.width_mm"));
  EXPECT_THAT(message(R"({"head": {}})"), names("unknown key head"));
  EXPECT_THAT(message(R"({"body": 3})"), names("body"));
  EXPECT_THAT(message(R"({"body": {"width_mm": "44"}})"), names("body.width_mm"));
  EXPECT_THAT(message(R"({"body": {"width_mm": null}})"), names("body.width_mm"));
  EXPECT_THAT(message(R"({"body": {"width_mm": -44}})"), names("body.width_mm"));
  EXPECT_THAT(message(R"({"body": {"width_mm": 1e999}})"), HasSubstr("bone.json"));
  EXPECT_THAT(message(R"({"pedicle": {"isthmus_mm": [1, 2]}})"), names("pedicle.isthmus_mm"));
  EXPECT_THAT(message(R"({"spinous": {"outline_mm": [[1, 2]]}})"), names("spinous.outline_mm"));
  EXPECT_THAT(message(R"({"cancellous": {"texture_seed": -1}})"), names("cancellous.texture_seed"));
  EXPECT_THAT(message(R"({"body": {"source": 3}})"), names("body.source"));
  EXPECT_THAT(message("{"), names("as JSON"));
  EXPECT_THAT(message("[]"), HasSubstr("bone.json"));
  EXPECT_THROW(read_anatomy(path().parent_path() / "missing.json"), Error);
}

}  // namespace
}  // namespace spinaltap
