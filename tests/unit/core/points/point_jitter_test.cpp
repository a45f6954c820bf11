#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/every_engine.h"

namespace spinaltap {
namespace {

PointVolume volume_with(const PointVolumeOptions& options) { return {test::askew_path(4.0), options}; }

/// Calls visit(disc, index) for all points.
template <class Visit>
void for_all(const PointVolume& volume, const Visit& visit) {
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) visit(disc, i);
  }
}

TEST(PointJitter, IsTheSameForASeedAndAnotherForAnother) {
  const PointVolume one = volume_with({.jitter = 0.3, .jitter_seed = 7});
  const PointVolume same = volume_with({.jitter = 0.3, .jitter_seed = 7});
  const PointVolume other = volume_with({.jitter = 0.3, .jitter_seed = 8});
  std::size_t equal = 0;
  for_all(one, [&](int disc, std::size_t i) {
    ASSERT_EQ(one.point_in_path_mm(disc, i), same.point_in_path_mm(disc, i));
    equal += one.point_in_path_mm(disc, i) == other.point_in_path_mm(disc, i);
  });
  EXPECT_EQ(equal, 0U);
}

TEST(PointJitter, StaysWithinItsShareOfTheSpacingAndWithinTheBounds) {
  for (const DiscSubdivision subdivision : {DiscSubdivision::rings, DiscSubdivision::hexagons}) {
    for (const double jitter : {0.0, 0.1, 0.5}) {
      const PointVolume moved = volume_with({.subdivision = subdivision, .jitter = jitter});
      const PointVolume still = volume_with({.subdivision = subdivision});
      const PointVolume even = volume_with({});
      EXPECT_EQ(moved.out_of_plane_mm(), 0.1 * jitter);
      double max_mm = 0.0;
      for_all(moved, [&](int disc, std::size_t i) {
        const Vec3 move = moved.point_in_path_mm(disc, i) - still.point_in_path_mm(disc, i);
        max_mm = std::max(max_mm, move.cwiseAbs().maxCoeff());
        ASSERT_LE(move.cwiseAbs().maxCoeff(), 0.1 * jitter + 1e-13);
        ASSERT_LE(std::abs(moved.point_in_path_mm(disc, i).z() - moved.disc_depth_mm(disc)),
                  moved.out_of_plane_mm() + 1e-13);
        const Vec3 off = moved.point_in_path_mm(disc, i) - even.point_in_path_mm(disc, i);
        ASSERT_LE(off.head<2>().norm(), moved.deviation_mm(DiscPattern::ring_of(i)) + 1e-13);
      });
      EXPECT_GE(max_mm, 0.0999 * jitter);
    }
  }
}

TEST(PointJitter, IsEvenlySpreadAndWithoutPattern) {
  const PointVolume moved = volume_with({.jitter = 0.5});
  const PointVolume still = volume_with({});
  constexpr std::size_t kBins = 20;
  std::array<std::array<double, kBins>, 3> counts{};
  Vec3 sum = Vec3::Zero();
  Mat3 products = Mat3::Zero();
  double beside = 0.0;
  Vec3 last = Vec3::Zero();
  for_all(moved, [&](int disc, std::size_t i) {
    const Vec3 move = (moved.point_in_path_mm(disc, i) - still.point_in_path_mm(disc, i)) / 0.05;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double place = std::floor((move[static_cast<Eigen::Index>(axis)] + 1.0) * 0.5 * kBins);
      counts[axis][static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))] += 1.0;
    }
    sum += move;
    products += move * move.transpose();
    beside += move.dot(last);
    last = move;
  });
  const auto points = static_cast<double>(moved.point_count());
  ASSERT_GT(points, 1e5);
  // A uniform number in [-1, 1] has mean 0 and variance 1/3; five deviations are allowed of each sum.
  const double deviation = 5.0 / std::sqrt(points);
  EXPECT_LT((sum / points).cwiseAbs().maxCoeff(), deviation * std::sqrt(1.0 / 3.0));
  EXPECT_LT((products / points - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(), deviation / 3.0);
  EXPECT_LT(std::abs(beside / points), deviation * std::sqrt(3.0) / 3.0);
  for (const auto& axis : counts) {
    double chi_squared = 0.0;
    for (const double count : axis) chi_squared += std::pow(count - points / kBins, 2) / (points / kBins);
    // 19 degrees of freedom: above 50 once in 10,000.
    EXPECT_LT(chi_squared, 50.0);
  }
}

TEST(PointJitter, RejectsMoreThanHalfASpacing) {
  for (const double bad : {std::nan(""), -0.1, 0.51, HUGE_VAL})
    EXPECT_THROW(volume_with({.jitter = bad}), Error) << bad;
}

TEST(PointHu, IsKeptToEightUnitsByEightBitsAndToHalfAUnitBySixteen) {
  PointVolume eight = volume_with({.hu_bits = HuBits::eight});
  PointVolume sixteen = volume_with({});
  EXPECT_EQ(eight.hu(3, 100), 0);
  EXPECT_EQ(sixteen.hu(3, 100), 0);
  for (double hu = -1032.0; hu <= 3064.0; hu += 0.37) {
    eight.set_hu(3, 100, hu);
    sixteen.set_hu(3, 100, hu);
    ASSERT_LE(std::abs(eight.hu(3, 100) - hu), 8.0) << hu;
    ASSERT_LE(std::abs(sixteen.hu(3, 100) - hu), 0.5) << hu;
  }
  // Neighbours keep theirs.
  EXPECT_EQ(eight.hu(3, 99), 0);
  EXPECT_EQ(eight.hu(3, 101), 0);
  // Beyond, the nearest that there is.
  eight.set_hu(3, 100, -1e6);
  EXPECT_EQ(eight.hu(3, 100), -1024);
  EXPECT_EQ(eight.hu_range(), (std::pair<std::int16_t, std::int16_t>(-1024, 0)));
  eight.set_hu(3, 100, 1e6);
  EXPECT_EQ(eight.hu(3, 100), 3056);
  EXPECT_EQ(eight.hu_range(), (std::pair<std::int16_t, std::int16_t>(0, 3056)));
}

TEST(PointHu, HasTheRangeOfWhatIsStored) {
  PointVolume volume = volume_with({});
  EXPECT_EQ(volume.hu_range(), (std::pair<std::int16_t, std::int16_t>(0, 0)));
  volume.set_hu(39, 2610, 1234.0);
  volume.set_hu(0, 0, -56.0);
  EXPECT_EQ(volume.hu_range(), (std::pair<std::int16_t, std::int16_t>(-56, 1234)));
}

TEST(PointHu, HasTheRangeOfWhatIsStoredNowInCopiesToo) {
  using Range = std::pair<std::int16_t, std::int16_t>;
  for (const HuBits bits : {HuBits::eight, HuBits::sixteen}) {
    PointVolume volume = volume_with({.hu_bits = bits});
    volume.set_hu(3, 100, 320.0);
    EXPECT_EQ(volume.hu_range(), Range(0, 320));
    PointVolume copy = volume;
    EXPECT_EQ(copy.hu_range(), Range(0, 320));
    copy.set_hu(3, 100, 160.0);
    EXPECT_EQ(copy.hu_range(), Range(0, 160)) << "what was the highest is none any more";
    EXPECT_EQ(volume.hu_range(), Range(0, 320));
    copy.set_hu(2, 7, -64.0);
    volume = copy;
    EXPECT_EQ(volume.hu_range(), Range(-64, 160));
    volume.set_hu(2, 7, 0.0);
    EXPECT_EQ(PointVolume(std::move(volume)).hu_range(), Range(0, 160));
    EXPECT_EQ(copy.hu_range(), Range(-64, 160));
  }
}

TEST(PointHu, HasTheRangeOfWhatManyThreadsStored) {
  PointVolume volume = volume_with({});
  const auto fill = [&volume](double lowest_hu) {
    fill_volume(volume, [&](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
      for (std::size_t n = 0; n < points_mm.size(); ++n) {
        distance_mm[n] = -1.0F;
        hu[n] = static_cast<float>(lowest_hu + std::floor(std::abs(points_mm[n].z())));
      }
    });
    std::int16_t lowest = 32767, highest = -32768;
    for_all(volume, [&](int disc, std::size_t i) {
      lowest = std::min(lowest, volume.hu(disc, i));
      highest = std::max(highest, volume.hu(disc, i));
    });
    EXPECT_EQ(volume.hu_range(), std::pair(lowest, highest));
    EXPECT_GE(lowest, lowest_hu);
  };
  fill(500.0);
  fill(900.0);
  fill(100.0);
}

TEST(PointMemory, IsAFewBytesAPointWithTheEnginesOwn) {
  for (const auto& [bits, max_bytes] : {std::pair(HuBits::eight, 1.4), std::pair(HuBits::sixteen, 2.4)}) {
    PointVolume volume(test::askew_path(37.8), {.radius_mm = 3.0, .spacing_mm = 0.1, .hu_bits = bits});
    ASSERT_EQ(volume.point_count(), 986'958U);
    // Numbers of bone, so that the engines' tables span their range.
    volume.set_hu(0, 0, -1024.0);
    volume.set_hu(0, 1, 3056.0);
    for (const test::NamedEngine& kind : test::every_engine()) {
      const auto engine = kind.make(volume, {}, {});
      const auto bytes = static_cast<double>(volume.memory_bytes() + engine->memory_bytes());
      EXPECT_LE(bytes / static_cast<double>(volume.point_count()), max_bytes) << kind.name;
      // Nothing is forgotten: a bit and a number for each point are the least.
      EXPECT_GE(bytes / static_cast<double>(volume.point_count()), max_bytes - 0.3) << kind.name;
    }
  }
}

TEST(PointBits, AreSetOneByOneAndEndWithTheLastPoint) {
  PointVolume volume = volume_with({.radius_mm = 0.5});
  const std::size_t points = volume.pattern().point_count();
  ASSERT_EQ(points, 61U);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    ASSERT_EQ(std::as_const(volume).occupancy_words(disc).size(), 1U);
    ASSERT_EQ(std::as_const(volume).occupancy_words(disc)[0], (std::uint64_t{1} << 61) - 1);
  }
  volume.set_occupied(2, 60, false);
  volume.set_occupied(2, 60, false);
  EXPECT_FALSE(volume.is_occupied(2, 60));
  EXPECT_TRUE(volume.is_occupied(2, 59));
  EXPECT_TRUE(volume.is_occupied(3, 0));
  EXPECT_EQ(volume.occupied_count(), volume.point_count() - 1);
  volume.set_occupied(2, 60, true);
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
}

}  // namespace
}  // namespace spinaltap
