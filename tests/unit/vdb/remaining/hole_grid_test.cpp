#include <gtest/gtest.h>

#include <algorithm>

#include "core/tool/bit_profile.h"
#include "tests/support/drilled_ball.h"
#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap {
namespace {

using test::Dice;
using test::kDrilledBall;

/// Ways of all kinds, one after the other: along the bit's axis, by hand, turning, anew.
std::vector<Pose> next_way(Dice& dice, std::vector<Pose> way) {
  if (way.empty() || dice.below(3) == 0) {
    const Vec3 out = dice.direction();
    way = {{kDrilledBall.centre_mm + dice(0.0, 9.0) * out, dice.near(-out, 0.7)}};
  }
  way = {way.back()};
  const int kind = dice.below(3);
  for (int n = dice.below(12); n >= 0; --n) {
    Pose pose = way.back();
    pose.tip_mm += dice(-1.0, 1.2) * pose.axis;
    if (kind > 0) pose.tip_mm += dice(0.0, 0.2) * dice.direction();
    if (kind > 1) pose.axis = dice.near(pose.axis, 0.03);
    way.push_back(pose);
  }
  return way;
}

TEST(HoleGrid, HoldsTheLeastDistanceToAllThatBitsOfAllShapesSwept) {
  // Short ones, whose base gets into the bone too.
  const std::array bits{DrillBit{3.0, 5.0, 2.0}, DrillBit{4.0, 9.0, 1.0, BitShape::round_burr, 0.0, 2.0},
                        DrillBit{3.6, 7.0, 4.0, BitShape::conical_burr, 1.0, 2.0}, DrillBit{2.0, 20.0, 1.0}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    const RemainingBoneOptions options{.voxel_mm = 0.6};
    RemainingBone bone(test::ball_to_drill(), options);
    std::vector<detail::BitSweep> sweeps;
    std::vector<Pose> way;
    for (int step = 0; step < 30; ++step) {
      way = next_way(dice, way);
      const DrillBit& bit = bits[static_cast<std::size_t>(dice.below(4))];
      bone.drill(bit, way);
      const auto cut = detail::cut_into_sweeps(bit, way, options.tolerance_voxels * options.voxel_mm, 1e3);
      sweeps.insert(sweeps.end(), cut.begin(), cut.end());
    }
    const auto low = bone.first_voxel();
    const auto high = bone.last_voxel();
    const double band_mm = bone.band_mm();
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          const Vec3 p = options.voxel_mm * Vec3(x, y, z);
          if (kDrilledBall.distance_mm(p) > 0.9 * band_mm) continue;
          double min_mm = band_mm;
          for (const detail::BitSweep& sweep : sweeps) min_mm = std::min(min_mm, sweep.nearest(p).distance_mm);
          const auto hole_mm = static_cast<double>(bone.hole_mm({x, y, z}));
          // Changes below 1e-6 mm are passed over; how ways are cut moves them by less than the tolerance.
          if (min_mm > 0.0) {
            ASSERT_NEAR(hole_mm, min_mm, 1e-5) << x << " " << y << " " << z;
          } else {
            ASSERT_LE(hole_mm, std::max(min_mm, -band_mm) + 1e-5) << x << " " << y << " " << z;
            ASSERT_GE(hole_mm, -band_mm);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap
