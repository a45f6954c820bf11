#include "core/files/screw_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/with_format.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ScrewFile, ShippedHasTheSizesOfTheLumbarSpine) {
  const std::vector<PedicleScrew> screws = read_screws(data_file("screws/pedicle.json"));
  ASSERT_FALSE(screws.empty());
  for (std::size_t n = 0; n < screws.size(); ++n) {
    EXPECT_GE(screws[n].diameter_mm, 3.5);
    EXPECT_LE(screws[n].diameter_mm, 10.0);
    EXPECT_GE(screws[n].length_mm, 20.0);
    EXPECT_LE(screws[n].length_mm, 65.0);
    if (n == 0) continue;
    const PedicleScrew& last = screws[n - 1];
    EXPECT_TRUE(last.diameter_mm < screws[n].diameter_mm ||
                (last.diameter_mm == screws[n].diameter_mm && last.length_mm < screws[n].length_mm));
  }
  const auto usual = std::find_if(screws.begin(), screws.end(), [](const PedicleScrew& screw) {
    return screw.diameter_mm == 6.5 && screw.length_mm == 45.0;
  });
  ASSERT_NE(usual, screws.end());
  EXPECT_EQ(usual->name, "6.5 x 45 mm");
}

TEST(ScrewFile, ShippedThreadsAreTheUsualOnes) {
  for (const PedicleScrew& screw : read_screws(data_file("screws/pedicle.json"))) {
    ASSERT_TRUE(screw.thread) << screw.name;
    const ScrewThread usual = usual_thread(screw.diameter_mm);
    EXPECT_NEAR(screw.thread->core_diameter_mm, usual.core_diameter_mm, 0.011) << screw.name;
    EXPECT_NEAR(screw.thread->pitch_mm, usual.pitch_mm, 0.011) << screw.name;
  }
}

TEST(ScrewFile, ThreadsGoWithTheirDiametersInAnyOrderAndMayBeLeftOut) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "screws.json";
  const auto screws_of = [&](const char* text) {
    std::ofstream(path, std::ios::trunc) << test::with_format("spinaltap-screws", text);
    return read_screws(path);
  };
  const std::vector<PedicleScrew> screws =
      screws_of(R"({"diameters_mm": [6, 5], "core_diameters_mm": [4.5, 3.5], "pitches_mm": [3, 2.5],
                    "lengths_mm": [40], "tip_length_mm": 4})");
  ASSERT_EQ(screws.size(), 2u);
  EXPECT_EQ(screws[0].thread->core_diameter_mm, 3.5);
  EXPECT_EQ(screws[0].thread->pitch_mm, 2.5);
  EXPECT_EQ(screws[1].thread->core_diameter_mm, 4.5);
  EXPECT_FALSE(screws_of(R"({"diameters_mm": [6], "lengths_mm": [40], "tip_length_mm": 4})").front().thread);
}

TEST(ScrewFile, IsRejectedWithTheKeyAtFaultNamed) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "screws.json";
  const auto rejects = [&](const char* text, const char* word) {
    std::ofstream(path, std::ios::trunc) << test::with_format("spinaltap-screws", text);
    EXPECT_THAT([&] { read_screws(path); }, ThrowsMessage<Error>(AllOf(HasSubstr("screws.json"), HasSubstr(word))));
  };
  rejects(R"({"lengths_mm": [40], "tip_length_mm": 4})", "diameters_mm");
  rejects(R"({"diameters_mm": [], "lengths_mm": [40], "tip_length_mm": 4})", "diameters_mm");
  rejects(R"({"diameters_mm": [5, "six"], "lengths_mm": [40], "tip_length_mm": 4})", "diameters_mm");
  rejects(R"({"diameters_mm": [5], "lengths_mm": 40, "tip_length_mm": 4})", "lengths_mm");
  rejects(R"({"diameters_mm": [5], "lengths_mm": [40]})", "tip_length_mm");
  rejects(R"({"diameters_mm": [-5], "lengths_mm": [40], "tip_length_mm": 4})", "diameter");
  rejects(R"({"diameters_mm": [5], "lengths_mm": [3], "tip_length_mm": 4})", "tip");
  rejects(R"({"diameters_mm": [5], "core_diameters_mm": [4], "lengths_mm": [40], "tip_length_mm": 4})", "pitches_mm");
  rejects(R"({"diameters_mm": [5], "core_diameters_mm": [4, 4], "pitches_mm": [2], "lengths_mm": [40],
              "tip_length_mm": 4})",
          "core_diameters_mm");
  rejects(R"({"diameters_mm": [5], "core_diameters_mm": [6], "pitches_mm": [2], "lengths_mm": [40],
              "tip_length_mm": 4})",
          "core");
}

}  // namespace
}  // namespace spinaltap
