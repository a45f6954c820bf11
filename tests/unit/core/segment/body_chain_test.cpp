#include "core/segment/body_chain.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/ct/crop.h"
#include "core/segment/spine_bodies.h"
#include "tests/support/release_only.h"
#include "tests/support/spine_scan.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

/// How far a point lies from the plane of a true endplate, mm, along its normal.
double off_plane_mm(const Vec3& p_mm, const Vec3& endplate_mm, const Vec3& normal) {
  return std::abs((p_mm - endplate_mm).dot(normal));
}

/// All bodies of the ground truth, each between its endplates within `max_mm`. Endplates are hollow, their rims are the
/// ground truth's planes: a disc across the column sees the bone's edge up to half of the hollow, 0.5 to 1 mm, further
/// in.
void expect_true_bodies(const SpineBodies& found, const Spine& spine, double max_mm) {
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  ASSERT_EQ(found.chain.size(), ground_truth.levels.size());
  ASSERT_EQ(found.bodies.size(), ground_truth.levels.size());
  EXPECT_FALSE(found.has_sacrum);
  for (std::size_t n = 0; n < ground_truth.levels.size(); ++n) {
    const LevelGroundTruth& level = ground_truth.levels[ground_truth.levels.size() - 1 - n];
    const BodySpan& span = found.chain[n];
    const std::string name = level_name(level.level);
    EXPECT_FALSE(span.is_cut()) << name;
    EXPECT_LE(off_plane_mm(span.upper.centre_mm, level.superior_endplate_mm, level.superior_normal), max_mm) << name;
    EXPECT_LE(off_plane_mm(span.lower.centre_mm, level.inferior_endplate_mm, level.inferior_normal), max_mm) << name;
    EXPECT_GT(span.upper.edge, 0.0) << name;
    EXPECT_GT(span.lower.edge, 0.0) << name;
    EXPECT_LE((found.bodies[n].cylinder.centre_mm - level.body_centre_mm).norm(), 2.5) << name;
  }
}

/// T6 to L5, and what of it is cut off.
class SpineChain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    spine_ = new Spine(SpineOptions{});
    ct_ = new CtVolume(test::scan_spine(*spine_));
  }
  static void TearDownTestSuite() {
    delete ct_;
    delete spine_;
  }
  static const Spine* spine_;
  static const CtVolume* ct_;
};
const Spine* SpineChain::spine_ = nullptr;
const CtVolume* SpineChain::ct_ = nullptr;

SLOW_TESTS("SpineChain.*");

TEST_F(SpineChain, HasEachBodyBetweenItsEndplates) { expect_true_bodies(find_spine_bodies(*ct_), *spine_, 1.5); }

TEST_F(SpineChain, HoldsThePlacesInEachBodyAndNoneBesideThem) {
  const SpineBodies found = find_spine_bodies(*ct_);
  const std::size_t count = spine_->placed().size();
  ASSERT_EQ(found.bodies.size(), count);
  for (std::size_t n = 0; n < count; ++n) {
    const Vertebra& vertebra = test::vertebra_of(*spine_, spine_->placed()[count - 1 - n].level);
    for (std::uint64_t place = 0; place < 10; ++place) {
      EXPECT_EQ(body_at(found, test::place_in_body(vertebra, 0.85, 5, 100 * n + place)), n);
    }
    EXPECT_FALSE(body_at(found, vertebra.to_patient(Vec3(40.0, 0.0, 0.0))).has_value());
  }
}

TEST_F(SpineChain, TellsWhichBodyTheBorderCuts) {
  // Through the middles of T9 and L3.
  const SpineGroundTruth ground_truth = spine_ground_truth(*spine_);
  const auto centre_of = [&](Level level) {
    return std::find_if(ground_truth.levels.begin(), ground_truth.levels.end(),
                        [&](const auto& l) { return l.level == level; })
        ->body_centre_mm;
  };
  const Box3 all = test::box_of_vertebrae(*spine_);
  const Box3 part(Vec3(all.min().x(), all.min().y(), centre_of(Level{22}).z()),
                  Vec3(all.max().x(), all.max().y(), centre_of(Level{16}).z()));
  const SpineBodies found = find_spine_bodies(crop(*ct_, block_in_box(ct_->geometry, part)));
  ASSERT_EQ(found.chain.size(), 7U);  // L3 to T9
  for (std::size_t n = 0; n < found.chain.size(); ++n) {
    EXPECT_EQ(found.chain[n].lower.is_cut, n == 0) << "body " << n << " from below";
    EXPECT_EQ(found.chain[n].upper.is_cut, n == 6) << "body " << n << " from below";
  }
  const Level whole_levels[]{Level{21}, Level{20}, Level{19}, Level{18}, Level{17}};
  for (std::size_t n = 1; n < 6; ++n) {
    EXPECT_LE((found.bodies[n].cylinder.centre_mm - centre_of(whole_levels[n - 1])).norm(), 2.5) << "body " << n;
  }
}

TEST(SpineChainOfThinDiscs, HasEachBodyBetweenItsEndplates) {
  RELEASE_ONLY();
  SpineOptions options;
  options.first = Level{17};  // T10
  options.last = Level{22};   // L3
  options.thoracic_disc_mm = options.lumbar_disc_mm = 1.0;
  const Spine spine(options);
  // A disc as thin as the slices of the quick scan would not show.
  ScanOptions scan_options = test::coarse_scan_options();
  scan_options.slice_step_mm = scan_options.slice_width_mm = 0.75;
  expect_true_bodies(find_spine_bodies(test::scan_spine(spine, scan_options)), spine, 1.5);
}

}  // namespace
}  // namespace spinaltap
