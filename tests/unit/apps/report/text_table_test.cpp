#include "apps/report/text_table.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TextTable small_table() {
  TextTable table({{"engine", "", false}, {"rate", "cycles/s"}, {"p50", "µs"}});
  table.add_row({"ring", "1,000,000", "0.5"});
  table.add_row({"reference", "400", "2,500"});
  return table;
}

TEST(TextTable, AlignsTextLeftAndNumbersRight) {
  EXPECT_EQ(small_table().aligned(),
            "  engine          rate    p50\n"
            "              cycles/s     µs\n"
            "  ring       1,000,000    0.5\n"
            "  reference        400  2,500\n");
}

TEST(TextTable, IsMarkdownWhereAskedFor) {
  EXPECT_EQ(small_table().markdown(),
            "| engine | rate, cycles/s | p50, µs |\n"
            "|---|--:|--:|\n"
            "| ring | 1,000,000 | 0.5 |\n"
            "| reference | 400 | 2,500 |\n");
}

TEST(TextTable, RejectsRowsOfAnotherLength) {
  TextTable table({{"engine", "", false}});
  EXPECT_THROW(table.add_row({"ring", "1"}), Error);
}

}  // namespace
}  // namespace spinaltap
