#include "core/files/bit_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"
#include "core/files/bit_json.h"
#include "core/files/data_files.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

TEST(BitFile, ShipsTheReportsBitAndTipsThatFitTheirAngle) {
  const std::vector<NamedBit> bits = read_bits(data_file("bits/pedicle.json"));
  const DrillBit paper;  // the default: the report's
  bool has_papers = false;
  for (const auto& [name, bit] : bits) {
    has_papers = has_papers || (bit.diameter_mm == paper.diameter_mm && bit.length_mm == paper.length_mm &&
                                bit.tip_length_mm == paper.tip_length_mm && bit.shape == paper.shape);
    if (name.find("118 degrees") != std::string::npos) {
      EXPECT_NEAR(bit.tip_length_mm, bit.radius_mm() / std::tan(59.0 * kDegree), 1e-4) << name;
    }
  }
  EXPECT_TRUE(has_papers);
}

TEST(BitFile, NamesTheBitThatIsNone) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "bits.json";
  std::ofstream(file)
      << R"({"format": "spinaltap-bits", "version": 2, "bits": [{"name": "flat", "bit": {"diameter_mm": 0, "length_mm": 50, "tip_length_mm": 5}}]})";
  EXPECT_THAT([&] { read_bits(file); }, testing::ThrowsMessage<Error>(testing::AllOf(testing::HasSubstr("flat"),
                                                                                     testing::HasSubstr("bits.json"))));
}

TEST(BitFile, KnowsPlates) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "bits.json";
  std::ofstream(file)
      << R"({"format": "spinaltap-bits", "version": 2, "bits": [{"name": "saw", "bit":)"
      << R"({"shape": "plate", "width_mm": 10, "thickness_mm": 0.6, "length_mm": 60, "stroke_mm": 4}}]})";
  const std::vector<NamedBit> bits = read_bits(file);
  ASSERT_EQ(bits.size(), 1U);
  EXPECT_EQ(bits[0].bit, plate_bit(10.0, 0.6, 60.0, 4.0));
  EXPECT_EQ(name_of(bits[0].bit.shape), "plate");
  EXPECT_EQ(bit_json(bits[0].bit)["width_mm"], 10.0);
}

TEST(BitProfileFile, ShipsTools) {
  EXPECT_THAT(bit_profiles(), testing::ElementsAre("match-head", "probe", "reamer", "tap"));
  const std::map<std::string, double> diameters_mm{{"match-head", 3.0}, {"probe", 2.0}, {"reamer", 4.5}, {"tap", 5.5}};
  for (const auto& [name, diameter_mm] : diameters_mm) {
    EXPECT_NEAR(read_bit_profile(name).bit.diameter_mm, diameter_mm, 1e-14) << name;
  }
  EXPECT_EQ(shipped_bits().size(), read_bits(data_file("bits/pedicle.json")).size() + bit_profiles().size());
}

TEST(BitProfileFile, SaysWhatIsWrongAndWhere) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "mine.json").string();
  const auto write = [&](const std::string& more, const std::string& places) {
    std::ofstream(file) << R"({"format": "spinaltap-bit-profile", "version": 2, "name": "mine", )" << more
                        << R"("outline": [)" << places << "]}";
  };
  const std::string tip = R"({"back_mm": 0, "radius_mm": 0})";
  write(R"("unit": "mm", )", tip + R"(, {"back_mm": 1, "radius_mm": 1, "arc": true}, {"back_mm": 20, "radius_mm": 1})");
  const NamedBit mine = read_bit_profile(file);
  EXPECT_EQ(mine.name, "mine");
  EXPECT_EQ(mine.bit, profile_bit({{0.0, 0.0}, {1.0, 1.0, true}, {20.0, 1.0}}));
  const auto rejects = [&](const std::string& more, const std::string& places, const char* what) {
    write(more, places);
    EXPECT_THAT([&] { read_bit_profile(file); }, testing::ThrowsMessage<Error>(testing::AllOf(
                                                     testing::HasSubstr("mine.json"), testing::HasSubstr(what))))
        << what;
  };
  rejects("", tip, "\"unit\"");
  rejects(R"("unit": "inch", )", tip, "\"unit\"");
  rejects(R"("unit": "mm", "width": 3, )", tip, "width");
  rejects(R"("unit": "mm", )", tip + ", 7", "place 2 of \"outline\"");
  rejects(R"("unit": "mm", )", tip + R"(, {"back_mm": 5})", "\"radius_mm\"");
  rejects(R"("unit": "mm", )", tip + R"(, {"back_mm": 5, "radius_mm": -1})", "place 2 of the outline");
  EXPECT_THAT([] { read_bit_profile("spoon"); }, testing::ThrowsMessage<Error>(testing::AllOf(
                                                     testing::HasSubstr("match-head"), testing::HasSubstr("spoon"))));
}

}  // namespace
}  // namespace spinaltap
