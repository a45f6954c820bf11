#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/tool/bit_profile.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

TEST(LengthenedProfile, HoldsWhatTheBitSweepsForwardAndNothingElse) {
  constexpr double kWayMm = 3.7;
  constexpr int kPoses = 3701;  // every micrometre
  for (const test::Tool& tool : test::every_tool()) {
    const BitProfile profile(tool.bit);
    EXPECT_EQ(profile.widens_to_one_place(), tool.name != "match-head");
    if (!profile.widens_to_one_place()) continue;
    const BitProfile longer = profile.lengthened(kWayMm);
    EXPECT_DOUBLE_EQ(longer.length_mm(), profile.length_mm() + kWayMm) << tool.name;
    for (std::uint64_t n = 0; n < 300; ++n) {
      const double back_mm = -0.5 + (longer.length_mm() + 1.0) * random_uniform(1, n);
      const double off_axis_mm = 1.3 * profile.radius_mm() * random_uniform(2, n);
      bool is_swept = false;
      for (int pose = 0; pose < kPoses && !is_swept; ++pose) {
        is_swept = profile.contains(back_mm - kWayMm * pose / (kPoses - 1), off_axis_mm * off_axis_mm);
      }
      // Poses half a micrometre away miss what lies as near to the surface.
      if (std::abs(longer.distance_mm(back_mm, off_axis_mm)) < 1e-3) continue;
      EXPECT_EQ(longer.contains(back_mm, off_axis_mm * off_axis_mm), is_swept)
          << tool.name << " at " << back_mm << ", " << off_axis_mm;
    }
  }
}

}  // namespace
}  // namespace spinaltap
