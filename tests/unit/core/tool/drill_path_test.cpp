#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/tool/drill_path.h"

namespace spinaltap {
namespace {

TEST(DrillPath, KnowsItsLengthAndDirection) {
  const DrillPath path{"test", Vec3(1, 1, 1), Vec3(1, 4, 5), {}};
  EXPECT_DOUBLE_EQ(path.length_mm(), 5.0);
  EXPECT_LT((path.direction() - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
}

TEST(DrillPath, RejectsEndsThatMakeNoPath) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto check_to = [](const Vec3& target_mm) { check_path({"test", Vec3::Zero(), target_mm, {}}); };
  check_to(Vec3(0, 0, 0.1));
  check_to(Vec3(0, 0, 500));
  EXPECT_THROW(check_to(Vec3(0, 0, 0.09)), Error);
  EXPECT_THROW(check_to(Vec3(0, 0, 500.1)), Error);
  EXPECT_THROW(check_to(Vec3(nan, 0, 1)), Error);
  EXPECT_THROW(check_to(Vec3(std::numeric_limits<double>::infinity(), 0, 1)), Error);
  EXPECT_THROW(check_path({"test", Vec3::Zero(), Vec3(0, 0, 10), {-3.0, 50.0, 5.0}}), Error);
}

TEST(DrillPath, NamesTheUnitThatItsLengthSpeaksFor) {
  const auto error_to = [](const Vec3& target_mm) -> std::string {
    try {
      check_path({"", Vec3::Zero(), target_mm, {}});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(error_to(Vec3(0.0, 0.0, 0.045)).find("in m?"), std::string::npos);
  EXPECT_NE(error_to(Vec3(0.0, 0.0, 45'000.0)).find("in µm?"), std::string::npos);
  EXPECT_EQ(error_to(Vec3(0.0, 0.0, 1e-6)).find("in m?"), std::string::npos);
}

TEST(PathFrame, IsRigidAndRightHandedForEveryDirection) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (std::uint64_t n = 0; n < 200; ++n) {
    Vec3 direction(random_normal(kSeed, 3 * n), random_normal(kSeed, 3 * n + 1), random_normal(kSeed, 3 * n + 2));
    if (n < 6) direction = (n % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(static_cast<Eigen::Index>(n / 2));
    const Vec3 origin_mm(900.0, -1200.0, 300.0);
    const PathFrame frame(origin_mm, direction);
    const Vec3 x = frame.to_patient(Pose{Vec3::Zero(), Vec3::UnitX()}).axis;
    const Vec3 y = frame.to_patient(Pose{Vec3::Zero(), Vec3::UnitY()}).axis;
    const Vec3 z = frame.to_patient(Pose{Vec3::Zero(), Vec3::UnitZ()}).axis;
    EXPECT_LT((z - direction.normalized()).norm(), 1e-14);
    EXPECT_LT((x.cross(y) - z).norm(), 1e-14);
    EXPECT_NEAR(x.norm(), 1.0, 1e-14);
    EXPECT_NEAR(y.norm(), 1.0, 1e-14);
    const Vec3 p_patient = origin_mm + Vec3(1.0, 2.0, 3.0);
    // A double holds 1,200 mm to 2e-13 mm.
    EXPECT_LT((frame.to_patient(frame.to_path(p_patient)) - p_patient).norm(), 1e-12);
  }
}

TEST(PathFrame, RejectsDirectionsAndOriginsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PathFrame(Vec3::Zero(), Vec3::Zero()), Error);
  EXPECT_THROW(PathFrame(Vec3::Zero(), Vec3(nan, 0, 1)), Error);
  EXPECT_THROW(PathFrame(Vec3(nan, 0, 0), Vec3::UnitZ()), Error);
}

}  // namespace

}  // namespace spinaltap
