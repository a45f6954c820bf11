#include "core/phantom/surface_seeds.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/phantom/vertebra.h"

namespace spinaltap {
namespace {

TEST(SurfaceSeeds, LieWithinTheSpacingOfTheSurface) {
  const Vertebra vertebra;
  const std::vector<Vec3> seeds = surface_seeds(vertebra, 0.5);
  std::vector<double> values(seeds.size());
  vertebra.evaluate(seeds, values, {});
  ASSERT_GT(seeds.size(), 50000U);
  for (const double value : values) ASSERT_LE(std::fabs(value), 0.5);
}

TEST(SurfaceSeeds, LeaveNoPieceOfTheSurfaceOut) {
  const Vertebra vertebra;
  const std::vector<Vec3> seeds = surface_seeds(vertebra, 1.0);
  // Random points pulled onto the surface along the gradient; a seed must be near.
  int found = 0;
  for (std::uint64_t n = 0; found < 200; ++n) {
    const Box3 box = vertebra.bounds_mm();
    Vec3 p = box.min() + box.sizes().cwiseProduct(Vec3(random_uniform(9, 4 * n), random_uniform(9, 4 * n + 1),
                                                       random_uniform(9, 4 * n + 2)));
    double value = 0.0;
    Vec3 gradient;
    for (int step = 0; step < 30; ++step) {
      vertebra.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
      p -= value * gradient / std::max(gradient.squaredNorm(), 0.2);
    }
    if (std::fabs(value) > 1e-6) continue;
    ++found;
    double nearest = std::numeric_limits<double>::max();
    for (const Vec3& seed : seeds) nearest = std::min(nearest, (seed - p).squaredNorm());
    ASSERT_LE(std::sqrt(nearest), 1.0) << p.transpose();
  }
}

TEST(SurfaceSeeds, ComeInOneOrderAtAnyNumberOfThreads) {
  const Vertebra vertebra;
  const std::vector<Vec3> many = surface_seeds(vertebra, 1.0);
  const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(surface_seeds(vertebra, 1.0), many);
}

TEST(SurfaceSeeds, RejectASpacingThatIsNotAboveZero) {
  const Vertebra vertebra;
  EXPECT_THROW(surface_seeds(vertebra, 0.0), Error);
  EXPECT_THROW(surface_seeds(vertebra, std::nan("")), Error);
}

}  // namespace
}  // namespace spinaltap
