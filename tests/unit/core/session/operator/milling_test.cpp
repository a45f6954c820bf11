// Compiled with optimisation: long loops of its own.

#include "core/session/operator/milling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/error.h"
#include "core/files/milling_file.h"
#include "tests/support/nan.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// A solid below a height over the plane z = 0: a distance along z, which is all that a milling asks for.
class Hills final : public ScalarField {
 public:
  explicit Hills(std::function<double(double x, double y)> height_mm) : height_mm_(std::move(height_mm)) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> /*gradients*/) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = points_mm[n].z() - height_mm_(points_mm[n].x(), points_mm[n].y());
    }
  }
  double height_mm(double x, double y) const { return height_mm_(x, y); }

 private:
  std::function<double(double, double)> height_mm_;
};

constexpr double kNoBone = -1000.0;
const DrillBit kBurr{4.0, 60.0, 1.0, BitShape::round_burr, 0.0, 2.0};

/// A patch of 12 by 8 mm, milled from above.
Milling patch() {
  Milling milling;
  milling.name = "patch";
  milling.outline_mm = {{-6.0, -4.0, 0.0}, {6.0, -4.0, 0.0}, {6.0, 4.0, 0.0}, {-6.0, 4.0, 0.0}};
  milling.into = -Vec3::UnitZ();
  milling.depth_mm = 2.0;
  return milling;
}

std::vector<Vec3> tips(const MillingMotion& motion) {
  std::vector<Vec3> all;
  for (std::size_t n = 0; n < motion.count(); ++n) all.push_back(motion.pose(n).tip_mm);
  return all;
}

/// Whether the burr's ball at one of the tips holds p.
bool is_taken(const std::vector<Vec3>& tips, const Vec3& p) {
  for (const Vec3& tip : tips) {
    if ((p - tip - kBurr.radius_mm() * Vec3::UnitZ()).norm() <= kBurr.radius_mm()) return true;
  }
  return false;
}

TEST(Milling, FollowsTheSurfaceToItsDepthAndLeavesNoMoreThanItsRidges) {
  // A slope, and waves of 1 mm.
  const Hills bone([](double x, double y) { return 0.1 * x + std::sin(0.5 * y); });
  const Milling milling = patch();
  const MillingMotion motion(milling, kBurr, bone, {.rate_hz = 200.0});
  const std::vector<Vec3> way = tips(motion);
  for (const Vec3& tip : way) {
    // From line to line, 1 mm, the tool goes straight: an eighth of the waves' curvature below them.
    ASSERT_GE(tip.z(), bone.height_mm(tip.x(), tip.y()) - milling.depth_mm - 0.25 / 8.0 - 0.002);
    ASSERT_LE(std::abs(tip.x()), 6.0 + 1e-9);
    ASSERT_LE(std::abs(tip.y()), 4.0 + 1e-9);
  }
  // Between lines 1 mm apart a ball of 2 mm leaves ridges of 0.064 mm; half a step on either side, and slopes, more.
  constexpr double kRidgeMm = 0.15;
  for (double x = -5.5; x <= 5.5; x += 0.37) {
    for (double y = -3.4; y <= 3.4; y += 0.23) {
      for (double below_mm = 0.05; below_mm < milling.depth_mm - kRidgeMm; below_mm += 0.2) {
        const Vec3 p(x, y, bone.height_mm(x, y) - below_mm);
        ASSERT_TRUE(is_taken(way, p)) << p.transpose();
      }
    }
  }
  // No deeper than the burr's ball at its depth: 3 mm down, all is left.
  for (double x = -5.5; x <= 5.5; x += 0.37) {
    ASSERT_FALSE(is_taken(way, {x, 0.0, bone.height_mm(x, 0.0) - milling.depth_mm - 0.5}));
  }
}

TEST(Milling, GoesDownToAFloorWhateverStandsOnIt) {
  // A tower of 10 mm, as a spinous process is, on a plain at 1 mm.
  const Hills bone([](double x, double y) { return std::hypot(x, y) < 2.0 ? 10.0 : 1.0; });
  Milling milling = patch();
  milling.depth = Milling::Depth::floor;
  milling.depth_mm = 0.5;
  const MillingMotion motion(milling, kBurr, bone, {.rate_hz = 200.0});
  const std::vector<Vec3> way = tips(motion);
  double lowest = 1e9;
  for (const Vec3& tip : way) lowest = std::min(lowest, tip.z());
  EXPECT_NEAR(lowest, -0.5, 1e-9);
  EXPECT_NEAR(way.front().z(), 10.0 + milling.lift_mm, 0.01);
  EXPECT_NEAR(way.back().z(), 10.0 + milling.lift_mm, 0.05);
  for (double x = -5.5; x <= 5.5; x += 0.31) {
    for (double y = -3.4; y <= 3.4; y += 0.29) {
      for (double z = -0.3; z < bone.height_mm(x, y); z += 0.4) ASSERT_TRUE(is_taken(way, {x, y, z})) << x << " " << y;
      ASSERT_FALSE(is_taken(way, {x, y, -0.6}));
    }
  }
  // Where there is no bone as high it goes up, down or over, and does not mill: the plain has its own layers alone.
  for (std::size_t n = 1; n < way.size(); ++n) {
    // It comes down to a lift above the layer, and goes on with care.
    const double high_mm = 1.0 + milling.layer_mm + milling.lift_mm;
    if (way[n].z() < high_mm || way[n].z() > 9.0 || std::hypot(way[n].x(), way[n].y()) < 3.5) continue;
    ASSERT_GT((way[n] - way[n - 1]).norm(), 1.5 * milling.feed_mm_s / motion.rate_hz()) << way[n].transpose();
  }
}

TEST(Milling, StaysWithinAnOutlineThatIsNotConvexAndOverGapsInTheBone) {
  const Hills bone([](double x, double /*y*/) { return std::abs(x - 3.0) < 1.0 ? kNoBone : 0.0; });
  Milling milling = patch();
  // An L.
  milling.outline_mm = {{-6, -6, 0}, {6, -6, 0}, {6, -1, 0}, {-1, -1, 0}, {-1, 6, 0}, {-6, 6, 0}};
  const MillingMotion motion(milling, kBurr, bone, {.rate_hz = 200.0});
  std::size_t in_bone = 0;
  for (const Vec3& tip : tips(motion)) {
    if (tip.z() > 1e-9) continue;
    ++in_bone;
    // A step's rounding of corners is the only way out.
    const bool is_within = (tip.x() < -1.0 + 0.06 || tip.y() < -1.0 + 0.06) && std::abs(tip.x()) < 6.0 + 1e-9;
    ASSERT_TRUE(is_within) << tip.transpose();
    ASSERT_FALSE(std::abs(tip.x() - 3.0) < 0.6) << tip.transpose();
  }
  EXPECT_GT(in_bone, 500U);
}

TEST(Milling, GoesAlongAnOutline) {
  const Hills bone([](double, double) { return 0.0; });
  Milling milling = patch();
  milling.way = Milling::Way::contour;
  const MillingMotion motion(milling, kBurr, bone, {.rate_hz = 200.0});
  bool is_deep = false;
  for (const Vec3& tip : tips(motion)) {
    const double off_mm = std::max(std::abs(tip.x()) - 6.0, std::abs(tip.y()) - 4.0);
    ASSERT_NEAR(off_mm, 0.0, 0.06) << tip.transpose();  // a step cuts a corner
    is_deep |= std::abs(tip.z() + 2.0) < 1e-9;
  }
  EXPECT_TRUE(is_deep);
  // Two layers of 40 mm, and down.
  EXPECT_NEAR(motion.length_mm(), 2.0 * 40.0, 5.0);
}

TEST(Milling, MovesAsFastAsItIsToldAndTrembles) {
  const Hills bone([](double, double) { return 0.0; });
  const Milling milling = patch();
  const MillingMotion motion(milling, kBurr, bone);
  const std::vector<Vec3> way = tips(motion);
  const double in_bone_mm = milling.feed_mm_s / motion.rate_hz(), travel_mm = milling.travel_mm_s / motion.rate_hz();
  for (std::size_t n = 1; n < way.size(); ++n) {
    const double step_mm = (way[n] - way[n - 1]).norm();
    ASSERT_LE(step_mm, travel_mm * (1.0 + 1e-9));
    const bool is_lifted = way[n].z() > way[n - 1].z() + 1e-9;  // out of what is milled
    if (!is_lifted && std::max(way[n].z(), way[n - 1].z()) < 0.0) {
      ASSERT_LE(step_mm, in_bone_mm * (1.0 + 1e-9)) << way[n].transpose();
    }
  }
  const MillingMotion hand(milling, kBurr, bone, {.tremor_mm = 0.1, .seed = 7});
  ASSERT_EQ(hand.count(), motion.count());
  double sum = 0.0;
  for (std::size_t n = 0; n < way.size(); ++n) sum += (hand.pose(n).tip_mm - way[n]).squaredNorm();
  // Three axes, each with the rms of a sinusoid of 0.1 mm.
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(way.size())), 0.1 * std::sqrt(1.5), 0.01);
}

TEST(Milling, EndsAtItsEndOrWhereItIsAskedTo) {
  const Hills bone([](double, double) { return 0.0; });
  MillingMotion motion(patch(), kBurr, bone);
  std::size_t count = 0;
  while (const auto input = motion.next({})) {
    EXPECT_EQ(input->pose.axis, Vec3(-Vec3::UnitZ()));
    ++count;
  }
  EXPECT_EQ(count, motion.count());
  MillingMotion asked(patch(), kBurr, bone);
  EXPECT_TRUE(asked.next({}));
  EXPECT_FALSE(asked.next({.stop = true}));
}

TEST(Milling, RejectsWhatItCannotDo) {
  const Hills bone([](double, double) { return 0.0; });
  const auto rejects = [&](const std::function<void(Milling&)>& change) {
    Milling milling = patch();
    change(milling);
    EXPECT_THROW(MillingMotion(milling, kBurr, bone), Error);
  };
  rejects([](Milling& m) { m.outline_mm.resize(2); });
  rejects([](Milling& m) { m.outline_mm[1].x() = test::kNan; });
  rejects([](Milling& m) { m.outline_mm[1].x() = 1e3; });
  rejects([](Milling& m) { m.into = Vec3::Zero(); });
  rejects([](Milling& m) { m.depth_mm = 0.0; });
  rejects([](Milling& m) { m.depth_mm = test::kNan; });
  rejects([](Milling& m) { m.layer_mm = 4.5; });
  rejects([](Milling& m) { m.apart_mm = 0.0; });
  rejects([](Milling& m) { m.feed_mm_s = 0.0; });
  rejects([](Milling& m) { m.lift_mm = -1.0; });
  // A floor above all bone.
  rejects([](Milling& m) {
    m.depth = Milling::Depth::floor;
    m.depth_mm = -1.0;
  });
  EXPECT_THROW(MillingMotion(patch(), kBurr, Hills([](double, double) { return kNoBone; })), Error);
  EXPECT_THROW(MillingMotion(patch(), kBurr, bone, {.rate_hz = 0.0}), Error);
  EXPECT_THAT([&] { MillingMotion(patch(), plate_bit(4.0, 1.0, 40.0), bone); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("a milling, found a plate")));
}

TEST(Milling, FileKeepsAll) {
  const test::TemporaryFolder folder;
  Milling milling = patch();
  milling.way = Milling::Way::contour;
  milling.depth = Milling::Depth::floor;
  milling.depth_mm = 1.0 / 3.0;
  milling.into = Vec3(1.0, 2.0, -2.0).normalized();
  write_milling(milling, folder.path() / "milling.json");
  const Milling read = read_milling(folder.path() / "milling.json");
  EXPECT_EQ(read.name, milling.name);
  EXPECT_EQ(read.outline_mm, milling.outline_mm);
  EXPECT_LT((read.into - milling.into).norm(), 1e-15);
  EXPECT_EQ(read.way, milling.way);
  EXPECT_EQ(read.depth, milling.depth);
  EXPECT_EQ(read.depth_mm, milling.depth_mm);
  EXPECT_EQ(read.layer_mm, milling.layer_mm);
  EXPECT_EQ(read.travel_mm_s, milling.travel_mm_s);
  EXPECT_EQ(milling_text(milling_of_text(milling_text(read), "a text")), milling_text(read));
  // Names are repeated in terminals and reports.
  milling.name = "steers\x1b[2Ja terminal";
  write_milling(milling, folder.path() / "milling.json");
  EXPECT_THROW(read_milling(folder.path() / "milling.json"), Error);
}

}  // namespace
}  // namespace spinaltap
