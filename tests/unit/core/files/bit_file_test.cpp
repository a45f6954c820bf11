#include "core/files/bit_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "core/base/error.h"
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

}  // namespace
}  // namespace spinaltap
