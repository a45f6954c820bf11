// Compiled with optimisation: long loops of its own.

#include "core/segment/masked_ct.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "core/segment/segment_spine.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/spine_scan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

/// T12 to L2, of which tests keep some by their true labels.
class MaskedSpine : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SpineOptions options;
    options.first = Level::kT12;
    options.last = Level{21};
    const Spine spine(options);
    ct_ = new CtVolume(test::scan_spine(spine));
    truth_ = new LabelVolume(true_labels(spine, ct_->geometry));
  }
  static void TearDownTestSuite() {
    delete truth_;
    delete ct_;
  }

  /// The CT with `hu` outside of the levels.
  static CtVolume keep(const std::vector<Level>& levels, std::int16_t hu) {
    std::vector<std::int16_t> values(ct_->hu.size(), hu);
    for (const Level level : levels) {
      const BoneMask mask = mask_of(*truth_, level);
      for (std::size_t v = 0; v < values.size(); ++v) {
        // A value that is the set one by chance is another case.
        if (mask.inside[v] != 0) values[v] = ct_->hu[v] == hu ? static_cast<std::int16_t>(hu + 1) : ct_->hu[v];
      }
    }
    return make_ct_volume(ct_->geometry, std::move(values));
  }
  static CtVolume tight(const CtVolume& ct, Level level) {
    return crop(ct, block_around(mask_of(*truth_, level), 0.0));
  }
  static BoneMask true_mask(const CtVolume& of, Level level) {
    const BoneMask mask = mask_of(*truth_, level);
    return of.geometry.size == ct_->geometry.size ? mask : crop(mask, block_around(mask, 0.0));
  }

  static const CtVolume* ct_;
  static const LabelVolume* truth_;
};
const CtVolume* MaskedSpine::ct_ = nullptr;
const LabelVolume* MaskedSpine::truth_ = nullptr;

SLOW_TESTS("MaskedSpine.OfOneVertebraIsItsMask", "MaskedSpine.OfSeveralIsPartedAsAnyOther");

TEST_F(MaskedSpine, IsNoneWhereAirOrSoftTissueAreOfOneValue) {
  EXPECT_FALSE(as_masked(*ct_).has_value());
  const auto changed = [](const std::function<std::int16_t(std::int16_t)>& change) {
    std::vector<std::int16_t> hu(ct_->hu.size());
    std::transform(ct_->hu.begin(), ct_->hu.end(), hu.begin(), change);
    return as_masked(make_ct_volume(ct_->geometry, std::move(hu))).has_value();
  };
  EXPECT_FALSE(changed([](std::int16_t hu) { return hu < 150 ? std::int16_t{40} : hu; }));  // made without noise
  EXPECT_FALSE(changed([](std::int16_t) { return std::int16_t{0}; }));
  // Air around a body, cut off at one value, beside lungs.
  std::size_t n = 0;
  EXPECT_FALSE(changed([&](std::int16_t hu) {
    ++n;
    return n % 5 != 0 ? std::int16_t{-1024} : n % 10 == 0 ? std::int16_t{-800} : hu;
  }));
}

TEST_F(MaskedSpine, KeepsWhatIsNotTheSetValueAndIsLookedForInWater) {
  for (const std::int16_t hu : {std::int16_t{0}, std::int16_t{-1024}, std::int16_t{-3024}}) {
    const CtVolume ct = keep({Level::kL1}, hu);
    const BoneMask truth = mask_of(*truth_, Level::kL1);
    const auto inside = static_cast<std::size_t>(std::find(truth.inside.begin(), truth.inside.end(), std::uint8_t{1}) -
                                                 truth.inside.begin());
    const std::optional<MaskedCt> masked = as_masked(ct);
    ASSERT_TRUE(masked.has_value()) << hu;
    EXPECT_TRUE(masked->is_one);
    EXPECT_GT(test::dice(masked->kept, truth), 0.999);
    const CtVolume back = crop(masked->ct, masked->original);
    EXPECT_EQ(back.geometry.size, ct.geometry.size);
    EXPECT_LT((back.geometry.origin_mm - ct.geometry.origin_mm).norm(), 1e-9);
    EXPECT_EQ(back.hu[inside], ct.hu[inside]);
    EXPECT_EQ(masked->ct.hu.front(), 0);
  }
  EXPECT_FALSE(as_masked(keep({Level::kT12, Level::kL1, Level{21}}, 0))->is_one);  // too high for one
}

TEST_F(MaskedSpine, OfOneVertebraIsItsMask) {
  for (const std::int16_t hu : {std::int16_t{0}, std::int16_t{-1024}}) {
    for (const bool is_tight : {false, true}) {
      const CtVolume whole = keep({Level::kL1}, hu);
      const CtVolume ct = is_tight ? tight(whole, Level::kL1) : whole;
      const Segmentation found = segment_vertebra(ct);
      EXPECT_GT(test::dice(found.mask, true_mask(ct, Level::kL1)), 0.999) << hu << " " << is_tight;
      EXPECT_FALSE(found.report.warnings.empty());
      const SpineSegmentation all = segment_spine(ct);
      ASSERT_EQ(all.levels.size(), 1U);
      EXPECT_EQ(all.levels[0].severity, found.report.severity);
      EXPECT_NEAR(all.levels[0].volume_mm3, found.report.volume_mm3, 1e-6);
      EXPECT_EQ(std::count(all.labels.labels.begin(), all.labels.labels.end(), all.levels[0].label),
                std::count(found.mask.inside.begin(), found.mask.inside.end(), 1));
    }
  }
}

TEST_F(MaskedSpine, OfABoneThatShowsNoVertebraIsSuspect) {
  GridGeometry geometry;
  geometry.size = {60, 60, 40};
  BoneMask plate{geometry, {}};
  std::vector<std::int16_t> hu;
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 60; ++j) {
      for (int i = 0; i < 60; ++i) {
        const bool is_inside = std::abs(i - 30) < 25 && std::abs(j - 28) < 20 && std::abs(k - 21) < 4;
        plate.inside.push_back(is_inside ? 1 : 0);
        hu.push_back(is_inside ? 400 : -1024);
      }
    }
  }
  const Segmentation found = segment_vertebra(make_ct_volume(geometry, hu));
  EXPECT_TRUE(found.report.is_suspect());
  ASSERT_EQ(found.report.warnings.size(), 1U);
  EXPECT_THAT(found.report.warnings[0].text, HasSubstr("no body and canal were seen"));
  EXPECT_EQ(found.mask.inside, plate.inside);
  EXPECT_LT((found.report.body_centre_mm - Vec3(30.0, 28.0, 21.0)).norm(), 0.1);
}

TEST_F(MaskedSpine, OfSeveralIsPartedAsAnyOther) {
  for (const std::int16_t hu : {std::int16_t{0}, std::int16_t{-1024}}) {
    const SpineSegmentation found = segment_spine(keep({Level::kT12, Level::kL1, Level{21}}, hu));
    ASSERT_EQ(found.levels.size(), 3U) << hu;
    EXPECT_EQ(found.labels.geometry.size, ct_->geometry.size);
    const BoneMask l1 = mask_of(*truth_, Level::kL1);
    BoneMask middle{ct_->geometry, std::vector<std::uint8_t>(ct_->hu.size())};
    for (std::size_t v = 0; v < middle.inside.size(); ++v) {
      middle.inside[v] = found.labels.labels[v] == found.levels[1].label ? 1 : 0;
    }
    EXPECT_GT(test::dice(middle, l1), 0.9) << hu;
  }
}

// Water beyond would make an endplate of the cut.
TEST_F(MaskedSpine, ThatTheCtCutsIsToldToBeCut) {
  for (const std::int16_t hu : {std::int16_t{0}, std::int16_t{-1024}}) {
    const CtVolume whole = keep({Level::kT12, Level::kL1, Level{21}}, hu);
    const BoneMask lowest = mask_of(*truth_, Level{21});
    const VoxelBlock box = block_around(lowest, 0.0);
    VoxelBlock part{{0, 0, 0}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) part.last[axis] = whole.geometry.size[axis] - 1;
    // Through the middle of the upper half of L2: its body is there.
    part.first[2] = box.first[2] + (box.last[2] - box.first[2]) * 5 / 8;
    const CtVolume ct = crop(whole, part);
    EXPECT_EQ(as_masked(ct)->original.first[2], 0);
    EXPECT_GT(as_masked(ct)->original.first[0], 0);
    const SpineSegmentation found = segment_spine(ct);
    ASSERT_FALSE(found.levels.empty());
    EXPECT_TRUE(found.levels.back().is_cut) << hu;
    EXPECT_FALSE(found.levels.back().warnings.empty());
  }
}

}  // namespace
}  // namespace spinaltap
