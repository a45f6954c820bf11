#include "core/segment/warning_metadata.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(LevelWarnings, AreTheWarningsInWordsAndOneWhereTheNameIsAHint) {
  LevelReport report;
  report.severity = 0.25;
  report.warnings = {{"it ends early", 0.25}};
  EXPECT_THAT(warnings_of(report).warnings, ElementsAre("it ends early"));
  EXPECT_EQ(warnings_of(report).severity, 0.25);
  report.name_source = NameSource::hint;
  EXPECT_THAT(warnings_of(report).warnings, ElementsAre("it ends early", HasSubstr("hint")));
}

TEST(LevelWarnings, ComeBackOutOfABonesMetadata) {
  std::map<std::string, std::string> metadata{{"mask", "threshold 150 HU"}};
  EXPECT_FALSE(warnings_in(metadata).has_value());
  add_warnings({{}, 0.0}, metadata);
  EXPECT_EQ(warnings_in(metadata), (LevelWarnings{{}, 0.0}));
  EXPECT_FALSE(metadata.contains("warnings"));
  add_warnings({{"one thing", "another"}, 0.5}, metadata);
  EXPECT_EQ(warnings_in(metadata), (LevelWarnings{{"one thing", "another"}, 0.5}));
  EXPECT_TRUE(warnings_in(metadata)->is_suspect());
  metadata["severity"] = "much";
  EXPECT_THROW(warnings_in(metadata), Error);
}

TEST(LevelWarnings, KeepFewOfThePlacesOfWhichTheWalkerIsUnsure) {
  LevelReport report;
  report.figures.unsure_mm = {Vec3(1.0, 1.0, 1.0), Vec3(1.8, 1.0, 1.0), Vec3(-0.26, 1.0, 1.0), Vec3(1.0, 1.0, -639.04)};
  std::map<std::string, std::string> metadata;
  add_warnings(warnings_of(report), metadata);
  // One of each cell of 2 mm, to 0.1 mm.
  EXPECT_EQ(warnings_in(metadata)->unsure_mm,
            (std::vector<Vec3>{Vec3(1.0, 1.0, 1.0), Vec3(-0.3, 1.0, 1.0), Vec3(1.0, 1.0, -639.0)}));
  metadata["unsure_mm"] = "1 2";
  EXPECT_THROW(warnings_in(metadata), Error);
}

TEST(InputWarnings, ComeBackOutOfABonesMetadataEachOnce) {
  std::map<std::string, std::string> metadata;
  add_input_warnings({}, metadata);
  EXPECT_TRUE(metadata.empty());
  EXPECT_TRUE(input_warnings_in(metadata).empty());
  const std::vector<std::string> of_ct{"one thing", "another"}, of_labels{"another", "a third"};
  add_input_warnings(of_ct, metadata);
  add_input_warnings(of_labels, metadata);
  EXPECT_EQ(metadata.at("input_warnings"), "one thing\nanother\na third");
  EXPECT_EQ(input_warnings_in(metadata), (std::vector<std::string>{"one thing", "another", "a third"}));
  EXPECT_FALSE(warnings_in(metadata));  // those are of the vertebra
  EXPECT_THROW(add_input_warnings(std::vector<std::string>{"two\nlines"}, metadata), Error);
}

}  // namespace
}  // namespace spinaltap
