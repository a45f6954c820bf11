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

}  // namespace
}  // namespace spinaltap
