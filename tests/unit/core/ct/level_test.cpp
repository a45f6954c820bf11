#include "core/ct/level.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

TEST(Level, NamesAndNumbersAreThoseOfVerse) {
  EXPECT_EQ(level_name(Level::kC1), "C1");
  EXPECT_EQ(level_name(Level::kC7), "C7");
  EXPECT_EQ(level_name(Level::kT1), "T1");
  EXPECT_EQ(level_name(Level::kT12), "T12");
  EXPECT_EQ(level_name(Level::kL1), "L1");
  EXPECT_EQ(level_name(Level::kL6), "L6");
  EXPECT_EQ(level_name(Level::kSacrum), "sacrum");
  EXPECT_EQ(level_name(Level::kT13), "T13");
  EXPECT_EQ(level_name(Level::kNone), "");
  EXPECT_EQ(level_from_number(22), level_from_name("L3"));
  EXPECT_EQ(level_from_number(18), level_from_name("T11"));
}

TEST(Level, EveryNameIsReadBack) {
  for (int number = 1; number <= 28; ++number) {
    const std::optional<Level> level = level_from_number(number);
    if (number == 27) {  // the coccyx
      EXPECT_FALSE(level);
      continue;
    }
    ASSERT_TRUE(level) << number;
    EXPECT_EQ(level_from_name(level_name(*level)), level);
  }
}

TEST(Level, TakesTheSpellingsThatPeopleUse) {
  EXPECT_EQ(level_from_name("t11"), level_from_name("T11"));
  EXPECT_EQ(level_from_name("Th11"), level_from_name("T11"));
  EXPECT_EQ(level_from_name("S1"), Level::kSacrum);
  for (const char* name : {"", "T", "T0", "T14", "L7", "C8", "T011", "T1x", "rib", "T-1", "L 3"}) {
    EXPECT_FALSE(level_from_name(name)) << name;
  }
}

TEST(Level, GoesDownAndUpTheSpine) {
  EXPECT_EQ(level_below(Level::kT12), Level::kL1);
  EXPECT_EQ(level_below(Level::kC7), Level::kT1);
  EXPECT_EQ(level_below(Level::kL5), Level::kSacrum);
  EXPECT_EQ(level_below(Level::kSacrum), Level::kNone);
  EXPECT_EQ(level_below(Level::kT13), Level::kL1);
  EXPECT_EQ(level_above(Level::kL1), Level::kT12);
  EXPECT_EQ(level_above(Level::kSacrum), Level::kL5);
  EXPECT_EQ(level_above(Level::kC1), Level::kNone);
  EXPECT_LT(level_rank(Level::kT12), level_rank(Level::kT13));
  EXPECT_LT(level_rank(Level::kT13), level_rank(Level::kL1));
}

}  // namespace
}  // namespace spinaltap
