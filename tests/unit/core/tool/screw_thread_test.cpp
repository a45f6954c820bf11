
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/base/error.h"
#include "core/tool/drill_path.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ScrewThread, AdvancesByItsPitchForEachStartAndReachesFromCoreToOuterDiameter) {
  ScrewThread thread{.core_diameter_mm = 4.25, .pitch_mm = 2.75};
  EXPECT_DOUBLE_EQ(thread.lead_mm(), 2.75);
  EXPECT_DOUBLE_EQ(thread.depth_mm(6.5), 1.125);
  thread.starts = 2;
  EXPECT_DOUBLE_EQ(thread.lead_mm(), 5.5);
}

TEST(ScrewThread, IsTheUsualOneWhereAScrewStatesNone) {
  PedicleScrew screw{"", 6.5, 45.0, 4.0};
  EXPECT_EQ(screw.thread_or_usual(), usual_thread(6.5));
  screw.thread = ScrewThread{.core_diameter_mm = 5.0, .pitch_mm = 2.0};
  EXPECT_DOUBLE_EQ(screw.thread_or_usual().core_diameter_mm, 5.0);
}

TEST(ScrewThread, UsualOnesAreAmongThoseOfScrewsInClinicalUse) {
  // Cores and pitches of twelve screws of 6 to 7.5 mm (Weidling et al. 2022): 3.65 to 5.10 mm and 2 to 4 mm.
  for (const double diameter_mm : {6.0, 6.5, 7.0, 7.5}) {
    const ScrewThread thread = usual_thread(diameter_mm);
    EXPECT_GE(thread.core_diameter_mm, 3.65);
    EXPECT_LE(thread.core_diameter_mm, 5.10);
    EXPECT_GE(thread.pitch_mm, 2.0);
    EXPECT_LE(thread.pitch_mm, 4.0);
  }
  for (double diameter_mm = 2.0; diameter_mm <= 10.0; diameter_mm += 0.5) {
    EXPECT_NO_THROW(check_thread(usual_thread(diameter_mm), diameter_mm)) << diameter_mm;
  }
}

TEST(ScrewThread, IsRejectedWhereItMakesNoSense) {
  const auto expect_rejected = [](const std::function<void(ScrewThread&)>& spoil, const char* word) {
    PedicleScrew screw{"odd", 6.5, 45.0, 4.0};
    screw.thread = usual_thread(6.5);
    EXPECT_NO_THROW(check_screw(screw));
    spoil(*screw.thread);
    EXPECT_THAT([&] { check_screw(screw); }, ThrowsMessage<Error>(HasSubstr(word)));
    EXPECT_THAT([&] { check_screw(screw); }, ThrowsMessage<Error>(HasSubstr("odd")));
  };
  expect_rejected([](ScrewThread& thread) { thread.core_diameter_mm = 6.6; }, "core");
  expect_rejected([](ScrewThread& thread) { thread.core_diameter_mm = test::kNan; }, "core");
  expect_rejected([](ScrewThread& thread) { thread.tip_core_diameter_mm = 5.0; }, "tip");
  expect_rejected([](ScrewThread& thread) { thread.pitch_mm = 0.0; }, "pitch");
  expect_rejected([](ScrewThread& thread) { thread.starts = 0; }, "side by side");
  expect_rejected([](ScrewThread& thread) { thread.crest_mm = -0.1; }, "crest");
  expect_rejected([](ScrewThread& thread) { thread.flank_deg = 61.0; }, "flank");
  expect_rejected([](ScrewThread& thread) { thread.flank_deg = 59.0; }, "root");
}

}  // namespace
}  // namespace spinaltap
