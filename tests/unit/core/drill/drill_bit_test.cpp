#include "core/drill/drill_bit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kSeed = 20'040'901;

/// Numbers in [low, high), one after the other.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * random_uniform(seed_, next_++); }
  Vec3 direction() {
    Vec3 v;
    do {
      v = Vec3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
    } while (v.norm() > 1.0 || v.norm() < 0.1);
    return v.normalized();
  }
  Pose pose() { return {Vec3((*this)(-20, 20), (*this)(-20, 20), (*this)(-20, 20)), direction()}; }
  DrillBit bit() {
    DrillBit bit{(*this)(1, 5), (*this)(6, 50), 0.0};
    bit.tip_length_mm = (*this)(0.5, bit.length_mm);
    return bit;
  }
  /// A point around the bit: along it, somewhat beyond both ends, and up to two radii off its axis.
  Vec3 near(const DrillBit& bit, const Pose& pose) {
    const double back_mm = (*this)(-0.2, 1.2) * bit.length_mm;
    const Vec3 side = direction().cross(pose.axis).normalized();
    return pose.tip_mm - back_mm * pose.axis + (*this)(0, 2) * bit.radius_mm() * side;
  }

 private:
  std::uint64_t seed_;
  std::uint64_t next_ = 0;
};

const DrillBit kPaperBit{3.0, 50.0, 5.0};
const Pose kUpright{Vec3(0, 0, 50), Vec3::UnitZ()};

TEST(DrillBit, ContainsWhereTheDistanceIsNegative) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  int inside = 0;
  for (int n = 0; n < 20'000; ++n) {
    const DrillBit bit = draw.bit();
    const Pose pose = draw.pose();
    const Vec3 p = draw.near(bit, pose);
    const double distance_mm = bit_distance_mm(bit, pose, p);
    if (std::abs(distance_mm) < 1e-9) continue;  // rounding decides there
    ASSERT_EQ(bit_contains(bit, pose, p), distance_mm < 0.0) << n << " at " << distance_mm << " mm";
    inside += distance_mm < 0.0;
  }
  EXPECT_GT(inside, 2'000);
  EXPECT_LT(inside, 18'000);
}

TEST(DrillBit, IsAsFarAsTheNearestOfManyPointsOfItsSurface) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const DrillBit bit{3.0, 10.0, 5.0};
  Draw draw(kSeed + 1);
  const Pose pose = draw.pose();
  const Vec3 u = any_perpendicular(pose.axis);
  const Vec3 v = pose.axis.cross(u);
  std::vector<Vec3> surface_mm;
  constexpr double kStepMm = 0.02;
  constexpr int kAround = 480;  // 0.02 mm apart on the rim
  const auto add_ring = [&](double back_mm, double radius_mm) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      surface_mm.push_back(pose.tip_mm - back_mm * pose.axis + radius_mm * (std::cos(angle) * u + std::sin(angle) * v));
    }
  };
  for (int i = 0; i <= 500; ++i) add_ring(kStepMm * i, std::min(1.0, kStepMm * i / 5.0) * 1.5);
  for (int i = 0; i <= 75; ++i) add_ring(10.0, kStepMm * i);
  for (int n = 0; n < 60; ++n) {
    const Vec3 p = draw.near(bit, pose);
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (const Vec3& s : surface_mm) nearest_mm = std::min(nearest_mm, (s - p).squaredNorm());
    nearest_mm = std::sqrt(nearest_mm);
    const double exact_mm = std::abs(bit_distance_mm(bit, pose, p));
    // Samples lie on the surface, so none is nearer; every place of it has one within 0.015 mm.
    EXPECT_LE(exact_mm, nearest_mm + 1e-9);
    EXPECT_GE(exact_mm, nearest_mm - 0.015);
  }
}

TEST(DrillBit, HasADistanceOfUnitSlopeOutside) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed + 2);
  for (int n = 0; n < 5'000; ++n) {
    const DrillBit bit = draw.bit();
    const Pose pose = draw.pose();
    const Vec3 p = draw.near(bit, pose);
    constexpr double kStepMm = 1e-4;
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStepMm * Vec3::Unit(axis);
      gradient[axis] = (bit_distance_mm(bit, pose, p + step) - bit_distance_mm(bit, pose, p - step)) / (2.0 * kStepMm);
    }
    const double distance_mm = bit_distance_mm(bit, pose, p);
    if (distance_mm > 0.05) {
      // The bit is convex, so its distance has one gradient outside; the difference errs by (step / distance)².
      EXPECT_NEAR(gradient.norm(), 1.0, 1e-5) << n;
    } else {
      // Inside, the gradient jumps where two parts are equally near, and differences across that are shorter.
      EXPECT_LT(gradient.norm(), std::sqrt(3.0)) << n;
    }
  }
}

TEST(DrillBit, NeverChangesItsDistanceFasterThanThePointMoves) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed + 3);
  for (int n = 0; n < 20'000; ++n) {
    const DrillBit bit = draw.bit();
    const Pose pose = draw.pose();
    const Vec3 p = draw.near(bit, pose);
    const Vec3 q = p + draw(0.0, 1.0) * draw.direction();
    EXPECT_LE(std::abs(bit_distance_mm(bit, pose, p) - bit_distance_mm(bit, pose, q)), (p - q).norm() + 1e-12);
  }
}

TEST(DrillBit, KnowsItsDistanceAtBaseTipRimAndShoulder) {
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 50)), 0.0, 1e-15);    // tip
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 52)), 2.0, 1e-14);    // ahead of it
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, -2)), 2.0, 1e-14);    // behind the base
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(4.5, 0, -4)), 5.0, 1e-14);  // off the base's rim: 3-4-5
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 2.5, 20)), 1.0, 1e-14);  // beside the wall
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 20)), -1.5, 1e-14);   // on the axis
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 0.5)), -0.5, 1e-14);  // just within the base
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(1.5, 0, 45)), 0.0, 1e-14);  // shoulder
  // On the axis within the cone, the cone is nearest: depth times the sine of its half angle.
  const double sine = 1.5 / std::hypot(1.5, 5.0);
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 48)), -2.0 * sine, 1e-14);
}

TEST(DrillBit, CountsItsSurfaceAsInside) {
  EXPECT_TRUE(bit_contains(kPaperBit, kUpright, Vec3(0, 0, 50)));
  EXPECT_TRUE(bit_contains(kPaperBit, kUpright, Vec3(0, 0, 0)));
  EXPECT_TRUE(bit_contains(kPaperBit, kUpright, Vec3(1.5, 0, 20)));
  EXPECT_TRUE(bit_contains(kPaperBit, kUpright, Vec3(1.5, 0, 0)));
  EXPECT_FALSE(bit_contains(kPaperBit, kUpright, Vec3(1.5 + 1e-9, 0, 20)));
  EXPECT_FALSE(bit_contains(kPaperBit, kUpright, Vec3(0, 0, -1e-9)));
  EXPECT_FALSE(bit_contains(kPaperBit, kUpright, Vec3(0, 0, 50 + 1e-9)));
}

TEST(DrillBit, NarrowsFromTheFullRadiusWhereTheConeBeginsToNothingAtTheTip) {
  // The paper's printed factor, (1 - alpha) * cone / total, would allow 0.015 mm where the cone begins.
  for (int i = 1; i <= 50; ++i) {
    const double back_mm = 0.1 * i;
    const double radius_mm = 1.5 * back_mm / 5.0;
    EXPECT_TRUE(bit_contains(kPaperBit, kUpright, Vec3(radius_mm - 1e-9, 0, 50 - back_mm))) << back_mm;
    EXPECT_FALSE(bit_contains(kPaperBit, kUpright, Vec3(radius_mm + 1e-9, 0, 50 - back_mm))) << back_mm;
  }
}

TEST(DrillBit, MayBeAllCone) {
  const DrillBit cone{3.0, 5.0, 5.0};
  check_bit(cone);
  const Pose pose{Vec3(0, 0, 5), Vec3::UnitZ()};
  EXPECT_TRUE(bit_contains(cone, pose, Vec3(1.5 - 1e-9, 0, 0)));
  EXPECT_FALSE(bit_contains(cone, pose, Vec3(1.5 - 1e-9, 0, 0.1)));
  EXPECT_NEAR(bit_distance_mm(cone, pose, Vec3(0, 0, 0.25)), -0.25, 1e-14);
}

TEST(DrillBit, DoesNotCareHowPointAndPoseAreTurnedAndShiftedTogether) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed + 4);
  for (int n = 0; n < 2'000; ++n) {
    const DrillBit bit = draw.bit();
    const Pose pose = draw.pose();
    const Vec3 p = draw.near(bit, pose);
    const Mat3 turn = Eigen::AngleAxisd(draw(0.0, 6.3), draw.direction()).toRotationMatrix();
    const Vec3 shift_mm(draw(-500, 500), draw(-500, 500), draw(-500, 500));
    const Pose moved{turn * pose.tip_mm + shift_mm, turn * pose.axis};
    const double distance_mm = bit_distance_mm(bit, pose, p);
    // Positions of 500 mm carry 1e-13 mm each.
    EXPECT_NEAR(bit_distance_mm(bit, moved, turn * p + shift_mm), distance_mm, 1e-11);
    if (std::abs(distance_mm) < 1e-9) continue;
    EXPECT_EQ(bit_contains(bit, moved, turn * p + shift_mm), bit_contains(bit, pose, p));
  }
}

TEST(DrillBit, RefusesLengthsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, 0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(check_bit({bad, 50.0, 5.0}), Error) << bad;
    EXPECT_THROW(check_bit({3.0, bad, 5.0}), Error) << bad;
    EXPECT_THROW(check_bit({3.0, 50.0, bad}), Error) << bad;
  }
  EXPECT_THROW(check_bit({3.0, 5.0, 5.1}), Error);
}

}  // namespace
}  // namespace spinaltap
