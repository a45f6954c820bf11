#include "core/segment/doubt_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(LevelDoubts, AreTheWarningsInWordsAndOneWhereTheNameIsAHint) {
  LevelReport report;
  report.doubt = 0.25;
  report.warnings = {{"it ends early", 0.25}};
  EXPECT_THAT(doubts_of(report).warnings, ElementsAre("it ends early"));
  EXPECT_EQ(doubts_of(report).doubt, 0.25);
  report.name_source = NameSource::hint;
  EXPECT_THAT(doubts_of(report).warnings, ElementsAre("it ends early", HasSubstr("hint")));
}

TEST(LevelDoubts, ComeBackOutOfABonesFacts) {
  std::map<std::string, std::string> facts{{"mask", "threshold 150 HU"}};
  EXPECT_FALSE(doubts_in(facts).has_value());
  add_doubts({{}, 0.0}, facts);
  EXPECT_EQ(doubts_in(facts), (LevelDoubts{{}, 0.0}));
  EXPECT_FALSE(facts.contains("warnings"));
  add_doubts({{"one thing", "another"}, 0.5}, facts);
  EXPECT_EQ(doubts_in(facts), (LevelDoubts{{"one thing", "another"}, 0.5}));
  EXPECT_TRUE(doubts_in(facts)->is_doubtful());
  facts["doubt"] = "much";
  EXPECT_THROW(doubts_in(facts), Error);
}

}  // namespace
}  // namespace spinaltap
