#include "core/files/strokes.h"

#include <gtest/gtest.h>

#include "core/base/staged_output.h"
#include "core/ct/label_volume.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

GridGeometry made_grid(const std::array<int, 3>& size, double step_mm, const Vec3& origin_mm) {
  GridGeometry grid;
  grid.size = size;
  grid.spacing_mm = Vec3::Constant(step_mm);
  grid.origin_mm = origin_mm;
  return grid;
}

std::vector<Correction> strokes_of(const LabelVolume& painted, const GridGeometry& ct) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "strokes.seg.nrrd";
  write_whole_file(file, encode_label_volume(painted, file));
  return read_strokes(file, ct);
}

/// A line of 11 mm along x of each of two segments, on a small grid of its own.
LabelVolume two_lines(const LabelName& first, const LabelName& second) {
  LabelVolume painted{made_grid({11, 5, 1}, 1.0, Vec3(4.0, 6.0, 8.0)), std::vector<std::uint8_t>(55, 0), {}};
  for (std::size_t i = 0; i < 11; ++i) {
    painted.labels[i] = 1;
    painted.labels[44 + i] = 2;
  }
  painted.names = {{1, first}, {2, second}};
  return painted;
}

TEST(Strokes, BelongToTheLevelThatTheirSegmentIsNamedBy) {
  const GridGeometry ct = made_grid({40, 40, 20}, 0.5, Vec3::Zero());
  const std::vector<Correction> corrections =
      strokes_of(two_lines({"T12", Level::kT12}, {"exclude", Level::kNone}), ct);
  std::size_t of_t12 = 0;
  for (const Correction& one : corrections) {
    // Each point lies under its own line, half a voxel of the strokes wide.
    EXPECT_NEAR(one.p_mm.y(), one.level == Level::kT12 ? 6.0 : 10.0, 0.5);
    EXPECT_NEAR(one.p_mm.z(), 8.0, 0.5);
    if (one.level == Level::kT12) ++of_t12;
  }
  // The line is 11 mm long, so that points of 1.5 mm apart and at most 3 mm apart are 4 to 9 along it, in two rows.
  EXPECT_GE(of_t12, 4U);
  EXPECT_LE(of_t12, 18U);
  EXPECT_GT(corrections.size(), of_t12);
  for (std::size_t a = 0; a < corrections.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (corrections[a].level == corrections[b].level) {
        EXPECT_GE((corrections[a].p_mm - corrections[b].p_mm).norm(), 1.5 - 1e-9);
      }
    }
  }
}

TEST(Strokes, ThatNameNoVertebraOnlyTakeAway) {
  // Numbers mean nothing here: 1 and 2 are no C1 and C2.
  const GridGeometry ct = made_grid({20, 20, 10}, 1.0, Vec3::Zero());
  const std::vector<Correction> corrections =
      strokes_of(two_lines({"exclude", Level::kNone}, {"Segment_2", Level::kNone}), ct);
  ASSERT_FALSE(corrections.empty());
  for (const Correction& one : corrections) EXPECT_EQ(one.level, Level::kNone);
}

}  // namespace
}  // namespace spinaltap
