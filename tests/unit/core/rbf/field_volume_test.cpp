#include "core/rbf/field_volume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/base/staged_output.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

/// x + 100 y + 10000 z, so that each voxel tells where it is; whole numbers up to 2^24 are exact in float.
class Plane final : public ScalarField {
 public:
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    for (std::size_t i = 0; i < points_mm.size(); ++i) values_mm[i] = points_mm[i].dot(Vec3(1.0, 100.0, 10000.0));
  }
};

TEST(FieldVolume, LiesAroundThePointsWithTheirCentre) {
  const std::vector<Vec3> points_mm{{-1.0, 10.0, 5.0}, {3.0, 10.5, 5.0}};
  const GridGeometry lattice = lattice_over(points_mm, 1.5);
  EXPECT_EQ(lattice.size, (std::array<int, 3>{4, 2, 1}));  // 4 mm need 3 steps, 0.5 mm one, 0 none
  EXPECT_LT((lattice.origin_mm - Vec3(1.0 - 2.25, 10.25 - 0.75, 5.0)).norm(), 1e-12);
}

TEST(FieldVolume, RejectsLatticesThatCannotBe) {
  const std::vector<Vec3> points_mm{{0.0, 0.0, 0.0}, {1e3, 1e3, 1e3}};
  EXPECT_THAT(error_of([] { lattice_over({}, 1.0); }), HasSubstr("expected points"));
  EXPECT_THAT(error_of([&] { lattice_over(points_mm, 0.0); }), HasSubstr("expected a step above 0 mm, found 0"));
  EXPECT_THAT(error_of([&] { lattice_over(points_mm, std::nan("")); }), HasSubstr("found nan"));
  EXPECT_THAT(error_of([&] { lattice_over(points_mm, 0.1); }), HasSubstr("at most 2^31 voxels"));
  EXPECT_THAT(error_of([&] { lattice_over(points_mm, 1e-320); }), HasSubstr("at most 2^31 voxels"));
}

TEST(FieldVolume, HoldsTheValueOfEachVoxelAcrossPieces) {
  const test::TemporaryFolder folder;
  GridGeometry lattice;
  lattice.size = {99, 89, 121};  // over a million
  const ValueRange range = write_field_volume(Plane(), lattice, folder.path() / "a.nrrd");
  EXPECT_EQ(range.min_mm, 0.0);
  EXPECT_EQ(range.largest_mm, 98.0 + 8800.0 + 1200000.0);
  const std::string bytes = read_whole_file(folder.path() / "a.nrrd");
  const std::size_t head = bytes.find("\n\n") + 2;
  EXPECT_THAT(bytes.substr(0, head), HasSubstr("sizes: 99 89 121\n"));
  ASSERT_EQ(bytes.size() - head, lattice.voxel_count() * sizeof(float));
  for (int k = 0; k < 121; ++k) {
    for (int j = 0; j < 89; ++j) {
      for (int i = 0; i < 99; ++i) {
        float value = 0.0F;
        std::memcpy(&value, bytes.data() + head + lattice.offset(i, j, k) * sizeof value, sizeof value);
        ASSERT_EQ(value, static_cast<float>(i + 100 * j + 10000 * k));
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap
