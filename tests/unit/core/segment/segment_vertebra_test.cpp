// Compiled with optimisation: long loops of its own.

#include "core/segment/segment_spine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/scanner.h"
#include "tests/support/error_of.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/random_vertebra.h"
#include "tests/support/release_only.h"
#include "tests/support/stacked_vertebrae.h"
#include "tests/support/test_kind.h"
#include "tests/support/true_mask.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

using test::error_of;

/// Three vertebrae, turned, whose facets are under 1 mm apart, less than the scan resolves.
class ThreeVertebrae : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    stack_ = new test::StackedVertebrae(3, 31.5, Vec3(10.0, 5.0, -8.0));
    ct_ = new CtVolume(scan(*stack_, {.columns = 200,
                                      .rows = 200,
                                      .slices = 125,
                                      .pixel_mm = 0.7,
                                      .slice_step_mm = 1.0,
                                      .noise_hu = 25.0,
                                      .seed = 7}));
    const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 3);
    middle_ = new Segmentation(segment_vertebra(*ct_, {.seed_mm = Vec3::Zero()}));
  }
  static void TearDownTestSuite() {
    delete middle_;
    delete ct_;
    delete stack_;
  }

  static void expect_the_middle_one(const Segmentation& found) {
    const BoneMask ground_truth = test::true_mask(*stack_, 1, ct_->geometry);
    const double dice = test::dice(found.mask, ground_truth);
    const double mean_mm = test::mean_surface_distance_mm(found.mask, ground_truth);
    std::printf("Dice %.3f, mean surface distance %.2f mm, cut over %.0f mm2\n", dice, mean_mm,
                found.report.cut_area_mm2);
    EXPECT_GE(dice, 0.95);
    EXPECT_LE(mean_mm, 0.7);  // a pixel
    EXPECT_GT(found.report.cut_area_mm2, 100.0) << "the scan was to show the facets as one";
    EXPECT_FALSE(found.report.reaches_border);
    for (const std::size_t neighbour : {std::size_t{0}, std::size_t{2}}) {
      const BoneMask other = test::true_mask(*stack_, neighbour, ct_->geometry);
      std::size_t taken = 0;
      std::size_t all = 0;
      for (std::size_t v = 0; v < other.inside.size(); ++v) {
        taken += other.inside[v] != 0 && found.mask.inside[v] != 0 ? 1U : 0U;
        all += other.inside[v];
      }
      // A layer of a tenth of a mm on the facets would be this much.
      EXPECT_LT(static_cast<double>(taken), 0.001 * static_cast<double>(all)) << "of vertebra " << neighbour;
    }
  }

  static const test::StackedVertebrae* stack_;
  static const CtVolume* ct_;
  static const Segmentation* middle_;  ///< from a seed in the middle, by three threads
};

const test::StackedVertebrae* ThreeVertebrae::stack_ = nullptr;
const CtVolume* ThreeVertebrae::ct_ = nullptr;
const Segmentation* ThreeVertebrae::middle_ = nullptr;

SLOW_TESTS("ThreeVertebrae.*");

TEST_F(ThreeVertebrae, GiveTheMiddleOneFromASeedInItsMiddle) { expect_the_middle_one(*middle_); }

TEST_F(ThreeVertebrae, GiveTheMiddleOneFromASeedNearItsWall) {
  // 4 mm below the upper endplate, 7 mm from the left wall.
  expect_the_middle_one(segment_vertebra(*ct_, {.seed_mm = (*stack_)[1].to_patient(Vec3(14.0, -5.0, 8.0))}));
}

TEST_F(ThreeVertebrae, GiveTheSameAtAnyNumberOfThreads) {
  const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(segment_vertebra(*ct_, {.seed_mm = Vec3::Zero()}).mask.inside, middle_->mask.inside);
}

TEST_F(ThreeVertebrae, RejectASeedBesideABody) {
  // In the muscle beside the middle one.
  const Vec3 beside_mm = (*stack_)[1].to_patient(Vec3(48.0, -10.0, 0.0));
  EXPECT_THAT(error_of([&] { segment_vertebra(*ct_, {.seed_mm = beside_mm}); }), HasSubstr("no body's wall around"));
}

TEST_F(ThreeVertebrae, RejectASeedOutsideTheCt) {
  EXPECT_THAT(error_of([&] { segment_vertebra(*ct_, {.seed_mm = Vec3(0.0, 0.0, 400.0)}); }),
              HasSubstr("expected a point in the CT"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { segment_vertebra(*ct_, {.seed_mm = Vec3(0.0, nan, 0.0)}); }), HasSubstr("not a number"));
}

TEST(SegmentVertebra, FindsAVertebraWithoutASeed) {
  RELEASE_ONLY();
  const Vertebra vertebra;
  const CtVolume ct =
      scan(vertebra, {.columns = 170, .rows = 170, .slices = 70, .pixel_mm = 0.7, .slice_step_mm = 1.0});
  const Segmentation found = segment_vertebra(ct);
  EXPECT_LT((found.report.body_centre_mm - vertebra.to_patient(Vec3::Zero())).norm(), 3.0);
  BoneMask ground_truth{ct.geometry, std::vector<std::uint8_t>(ct.geometry.voxel_count(), 0)};
  for (int k = 0; k < ct.geometry.size[2]; ++k) {
    for (int j = 0; j < ct.geometry.size[1]; ++j) {
      for (int i = 0; i < ct.geometry.size[0]; ++i) {
        const Vec3 p_mm = ct.geometry.to_patient(Vec3(i, j, k));
        double value_mm = 0.0;
        vertebra.evaluate({&p_mm, 1}, {&value_mm, 1}, {});
        if (value_mm < 0.0) ground_truth.inside[ct.geometry.offset(i, j, k)] = 1;
      }
    }
  }
  EXPECT_GE(test::dice(found.mask, ground_truth), 0.95);
  EXPECT_EQ(found.report.cut_area_mm2, 0.0);  // it stands alone
}

// An old vertebra: the body's wall, 0.25 to 0.4 mm, is thinner than a voxel, its cancellous bone as dark as soft
// tissue, and the arch behind it, with thicker walls, is nearly as large as a small body.
TEST(SegmentVertebra, FindsTheBodyWhereItsWallIsThinnerThanTheArchs) {
  RELEASE_ONLY();
  for (const std::uint64_t seed : {29U, 37U}) {
    const Vertebra vertebra(test::random_anatomy(seed));
    ScanOptions options;
    options.seed = seed;
    options.pixel_mm = 0.7;  // coarser than the scanner's usual
    options.slice_step_mm = 1.0;
    const Vec3 size_mm = vertebra.bounds_mm().sizes() + Vec3(16.0, 16.0, 8.0);
    options.columns = static_cast<int>(size_mm.x() / options.pixel_mm);
    options.rows = static_cast<int>(size_mm.y() / options.pixel_mm);
    options.slices = static_cast<int>(size_mm.z() / options.slice_step_mm);
    const Segmentation found = segment_vertebra(scan(vertebra, options));
    EXPECT_LE(vertebra.to_own(found.report.body_centre_mm).norm(), 5.0) << "seed " << seed;
  }
}

TEST(SegmentVertebra, RejectsASeedInAir) {
  GridGeometry geometry;
  geometry.size = {20, 20, 20};
  std::vector<std::int16_t> hu(geometry.voxel_count(), -1000);
  for (std::size_t v = 0; v < 400; ++v) hu[v] = 500;
  const CtVolume ct = make_ct_volume(geometry, std::move(hu));
  EXPECT_THAT(error_of([&] { segment_vertebra(ct, {.seed_mm = Vec3(10.0, 10.0, 10.0)}); }),
              HasSubstr("found air (-1000 HU)"));
}

TEST(SegmentVertebra, SaysWhatTheCtHoldsWhenNothingIsOverTheThreshold) {
  GridGeometry geometry;
  geometry.size = {8, 8, 8};
  std::vector<std::int16_t> hu(geometry.voxel_count(), 140);
  hu[3] = -90;
  const CtVolume ct = make_ct_volume(geometry, std::move(hu));
  EXPECT_THAT(error_of([&] { segment_vertebra(ct, {.threshold_hu = 250.0}); }),
              testing::AllOf(HasSubstr("250 HU"), HasSubstr("-90 to 140 HU")));
}

}  // namespace
}  // namespace spinaltap
