#include "core/segment/find_body_seed.h"

#include <gtest/gtest.h>

#include "core/phantom/scanner.h"
#include "tests/support/random_vertebra.h"

namespace spinaltap {
namespace {

// An old vertebra: the body's wall, 0.25 to 0.4 mm, is thinner than a voxel, its marrow as dark as soft tissue, and the
// arch behind it, with thicker walls, is nearly as large as a small body.
TEST(FindBodySeed, FindsTheBodyWhereItsWallIsThinnerThanTheArchs) {
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
    const CtVolume ct = scan(vertebra, options);
    const Vec3 seed_mm = find_body_seed(ct, choose_bone_levels(ct));
    EXPECT_LE(vertebra.to_own(seed_mm).norm(), 5.0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace spinaltap
