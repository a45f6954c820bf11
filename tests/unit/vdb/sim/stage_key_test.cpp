#include "vdb/sim/detail/stage_key.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/code_fingerprint.h"

namespace spinaltap {
namespace {

TEST(StageKey, IsAnotherForOtherCodeAnotherCtAndOtherOptions) {
  const BoneMask mask{{{2, 1, 1}}, {0, 1}};
  SegmentOptions seeded;
  seeded.seed_mm = Vec3(1.0, 2.0, 3.0);
  SurfaceFitOptions smoothed;
  smoothed.smoothing_mm += 1e-9;
  const std::set<std::string> masks{detail::mask_key("a", "ct", {}), detail::mask_key("b", "ct", {}),
                                    detail::mask_key("a", "other", {}), detail::mask_key("a", "ct", seeded)};
  EXPECT_EQ(masks.size(), 4U);
  const std::set<std::string> fits{detail::fit_key("a", "ct", mask, {}, {}), detail::fit_key("b", "ct", mask, {}, {}),
                                   detail::fit_key("a", "other", mask, {}, {}),
                                   detail::fit_key("a", "ct", mask, {}, smoothed),
                                   detail::fit_key("a", "ct", {{{2, 1, 1}}, {1, 1}}, {}, {})};
  EXPECT_EQ(fits.size(), 5U);
  EXPECT_EQ(detail::mask_key("a", "ct", seeded), detail::mask_key("a", "ct", seeded));
}

TEST(CodeFingerprint, IsOfEachStageItsOwn) {
  std::set<std::string> all;
  for (const CodeStage stage : {CodeStage::mask, CodeStage::fit, CodeStage::drilling}) {
    const std::string fingerprint = code_fingerprint(stage);
    EXPECT_EQ(fingerprint.size(), 16U);
    EXPECT_EQ(fingerprint.find_first_not_of("0123456789abcdef"), std::string::npos);
    all.insert(fingerprint);
  }
  EXPECT_EQ(all.size(), 3U);
}

}  // namespace
}  // namespace spinaltap
