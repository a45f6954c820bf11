#include "core/ct/made_up_slices.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

TEST(MadeUpSlices, ComeBackOutOfMetadata) {
  std::map<std::string, std::string> metadata;
  add_made_up({}, metadata);
  EXPECT_TRUE(metadata.empty());
  EXPECT_FALSE(made_up_in(metadata));
  const Vec3 normal(0.6, 0.0, 0.8);
  add_made_up({normal, {{-638.25, -637.25}, {12.5, 14.125}}}, metadata);
  const MadeUpSlices back = made_up_in(metadata).value();
  EXPECT_EQ(back.normal, normal);
  ASSERT_EQ(back.slabs_mm.size(), 2U);
  EXPECT_EQ(back.slabs_mm[0].low, -638.25);
  EXPECT_EQ(back.slabs_mm[1].high, 14.125);
  EXPECT_TRUE(back.holds(13.0 * normal));
  EXPECT_FALSE(back.holds(15.0 * normal));
  EXPECT_FALSE(back.holds(Vec3::Zero()));
}

TEST(MadeUpSlices, AreNoneWhereTheMetadataAreNoSlabs) {
  for (const char* text : {"", "0 0 1", "0 0 1 2", "0 0 1 2 x", "0 0 1 2 3 4"}) {
    EXPECT_FALSE(made_up_in({{"made_up_slices_mm", text}})) << text;
  }
}

}  // namespace
}  // namespace spinaltap
