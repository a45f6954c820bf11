#include "core/tool/tool_speed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ToolSpeed, SaysNothingOfSpeedsInUse) {
  EXPECT_THAT(speed_warnings({}, {0.17, 1.0, 4.0, 10.0, 20.0}, 1250.0), IsEmpty());
  EXPECT_THAT(speed_warnings({}, {}, 0.0), IsEmpty());  // off
  EXPECT_THAT(speed_warnings({4.0, 20.0, 2.0, BitShape::round_burr}, {40.0, 100.0}, 80'000.0), IsEmpty());
  EXPECT_THAT(speed_warnings({6.5, 45.0, 4.0, BitShape::tapered_screw}, {1.0}, 20.0), IsEmpty());
  EXPECT_THAT(speed_warnings(plate_bit(10.0, 1.0, 40.0), {1.0}, 1.0), IsEmpty());  // it does not turn
}

TEST(ToolSpeed, NamesTheUnitThatWasLikelyMeant) {
  EXPECT_THAT(speed_warnings({}, {1000.0}, {}),
              ElementsAre(AllOf(HasSubstr("1000 mm/s"), HasSubstr("mm/min"), HasSubstr("16.6667 mm/s"))));
  EXPECT_THAT(speed_warnings({}, {0.002}, {}), ElementsAre(HasSubstr("0.002 m/s are 2 mm/s")));
  EXPECT_THAT(speed_warnings({}, {}, 20.0), ElementsAre(HasSubstr("1200 rpm")));
  EXPECT_THAT(speed_warnings({}, {}, 250'000.0), ElementsAre(HasSubstr("100000 rpm")));
  EXPECT_THAT(speed_warnings({}, {-1.0, 1e9}, {}).size(), 2U);
}

}  // namespace
}  // namespace spinaltap
