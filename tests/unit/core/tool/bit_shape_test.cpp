#include "core/tool/bit_shape.h"

#include <gtest/gtest.h>

#include <set>

#include "core/files/bit_file.h"

namespace spinaltap {
namespace {

TEST(BitShapes, HaveTraitsEachAndNamesOfTheirOwn) {
  std::set<std::string> names;
  // `plate` is the last.
  for (int n = 0; n <= static_cast<int>(BitShape::plate); ++n) {
    const BitShapeTraits& traits = traits_of(static_cast<BitShape>(n));
    EXPECT_EQ(traits.shape, static_cast<BitShape>(n));
    EXPECT_TRUE(names.insert(traits.name).second) << traits.name;
    EXPECT_GE(traits.edges, 1);
    EXPECT_LT(traits.speeds.min_feed_mm_s, traits.speeds.max_feed_mm_s);
    EXPECT_LT(traits.speeds.min_rpm, traits.speeds.max_rpm);
  }
  EXPECT_EQ(bit_shape_traits().size(), names.size());
}

TEST(BitShapes, AreGivenBySizesButProfiles) {
  EXPECT_EQ(bit_shapes().size() + 1, bit_shape_traits().size());
  EXPECT_EQ(bit_shapes().at("round-burr"), BitShape::round_burr);
  EXPECT_EQ(bit_shapes().count("profile"), 0U);
}

TEST(DrillBit, HasItsHeadUpToWhereItIsWidest) {
  EXPECT_EQ((DrillBit{3.0, 50.0, 5.0}.head_mm()), 5.0);
  EXPECT_EQ((DrillBit{4.0, 50.0, 5.0, BitShape::round_burr, 0.0, 2.0}.head_mm()), 2.0);
}

}  // namespace
}  // namespace spinaltap
