#include "core/drill/corridor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// A vertebra of boxes on voxels of 1 mm, centred on x = 0: body in front (y < 0), lamina behind, and between them two
/// pedicles of 9 x 9 mm around the lines x = +-12, z = 0.
BoneMask box_vertebra(bool with_pedicles, bool with_wide_arch = false) {
  BoneMask mask;
  mask.geometry.size = {61, 71, 41};
  mask.geometry.origin_mm = Vec3(-30.0, -40.0, -20.0);
  mask.inside.resize(mask.geometry.voxel_count());
  for (int k = 0; k < 41; ++k) {
    for (int j = 0; j < 71; ++j) {
      for (int i = 0; i < 61; ++i) {
        const Vec3 p = mask.geometry.to_patient(Vec3(i, j, k));
        const bool body = std::abs(p.x()) <= 20.0 && p.y() >= -24.0 && p.y() <= 0.0 && std::abs(p.z()) <= 13.0;
        const bool pedicle =
            std::abs(std::abs(p.x()) - 12.0) <= 4.0 && p.y() > 0.0 && p.y() < 14.0 && std::abs(p.z()) <= 4.0;
        const bool lamina =
            p.y() >= 14.0 && p.y() <= 20.0 && (with_wide_arch || (std::abs(p.x()) <= 18.0 && std::abs(p.z()) <= 8.0));
        mask.inside[mask.geometry.offset(i, j, k)] = body || lamina || (with_pedicles && pedicle) ? 1 : 0;
      }
    }
  }
  return mask;
}

/// Fewer directions than by default: none of them finds 30 mm in the body alone, and the search is quick.
const CorridorOptions kNarrow{.most_convergence_deg = 15.0, .most_inclination_deg = 5.0};

TEST(WidestCorridor, RunsThroughTheMiddleOfAPedicle) {
  const DrillPath path = widest_corridor(box_vertebra(true), {}, kNarrow);
  EXPECT_LT(path.direction().y(), -0.8);
  for (const double y_mm : {2.0, 7.0, 11.0}) {
    const double t = (y_mm - path.entry_mm.y()) / (path.target_mm.y() - path.entry_mm.y());
    ASSERT_GT(t, 0.0);
    ASSERT_LT(t, 1.0);
    const Vec3 p = path.entry_mm + t * (path.target_mm - path.entry_mm);
    EXPECT_NEAR(std::abs(p.x()), 12.0, 1.0) << y_mm;
    EXPECT_NEAR(p.z(), 0.0, 1.0) << y_mm;
  }
}

TEST(WidestCorridor, StartsAtTheBackAndEndsDeepInTheBody) {
  const BoneMask mask = box_vertebra(true);
  const CorridorOptions& options = kNarrow;
  const DrillPath path = widest_corridor(mask, {}, options);
  // The lamina's back face lies at 20.5 mm, between two voxels; the search walks in steps of 0.5 mm.
  EXPECT_NEAR(path.entry_mm.y(), 20.5, 1.0);
  EXPECT_LE(path.target_mm.y(), 0.5 - options.front_clearance_mm);
  // Steps of 0.5 mm and voxels of 1 mm: the bone left in front may be 1 mm less than asked for.
  EXPECT_GE(path.target_mm.y(), -24.5 + options.front_clearance_mm - 1.0);
  EXPECT_GE(path.length_mm(), options.least_length_mm - 0.5);
}

TEST(WidestCorridor, DoesNotEnterTheBodyThroughTheCanal) {
  // Ways of 15 mm and more lie in the body alone, and are wider than a pedicle. The arch behind them is in the way.
  const CorridorOptions options{.least_length_mm = 15.0, .most_convergence_deg = 0.0, .most_inclination_deg = 0.0};
  const DrillPath path = widest_corridor(box_vertebra(true, true), {}, options);
  EXPECT_GT(path.entry_mm.y(), 19.0);
  EXPECT_THROW(widest_corridor(box_vertebra(false, true), {}, options), Error);
}

TEST(WidestCorridor, GivesTheSameAtAnyNumberOfThreads) {
  const BoneMask mask = box_vertebra(true);
  DrillPath one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = widest_corridor(mask, {}, kNarrow);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  const DrillPath two = widest_corridor(mask, {}, kNarrow);
  EXPECT_EQ(one.entry_mm, two.entry_mm);
  EXPECT_EQ(one.target_mm, two.target_mm);
}

TEST(WidestCorridor, FindsNoneWithoutPedicles) {
  EXPECT_THROW(widest_corridor(box_vertebra(false), {}, kNarrow), Error);
  BoneMask empty = box_vertebra(false);
  std::fill(empty.inside.begin(), empty.inside.end(), std::uint8_t{0});
  EXPECT_THROW(widest_corridor(empty, {}), Error);
}

TEST(WidestCorridor, FindsNoneThatIsLongerThanTheBone) {
  EXPECT_THROW(widest_corridor(box_vertebra(true), {},
                               {.least_length_mm = 60.0, .most_convergence_deg = 15.0, .most_inclination_deg = 5.0}),
               Error);
}

TEST(WidestCorridor, RefusesABitThatIsNone) {
  EXPECT_THROW(widest_corridor(box_vertebra(true), {.diameter_mm = std::numeric_limits<double>::quiet_NaN()}), Error);
}

}  // namespace
}  // namespace spinaltap
