#include "core/session/choose_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ChosenEngine, IsTheSetupsOwnWhereItNamesOne) {
  for (const auto& [name, kind] : engine_kinds()) {
    if (kind == EngineKind::automatic) continue;
    SessionSetup setup;
    setup.engine = kind;
    EXPECT_EQ(chosen_engine(setup, {.max_tilt_deg = 80.0, .keeps_to_path = false}), kind) << name;
  }
}

TEST(ChosenEngine, IsOneOfPointsUnlessPointsCannotServe) {
  SessionSetup setup;
  EXPECT_EQ(setup.engine, EngineKind::automatic);
  EXPECT_EQ(chosen_engine(setup), EngineKind::ring);
  EXPECT_EQ(chosen_engine(setup, {.max_tilt_deg = 3.0}), EngineKind::ring);
  EXPECT_EQ(chosen_engine(setup, {.max_tilt_deg = 45.0}), EngineKind::leaf);
  EXPECT_EQ(chosen_engine(setup, {.max_tilt_deg = -45.0}), EngineKind::leaf);
  for (const BitShape shape :
       {BitShape::drill, BitShape::conical_burr, BitShape::tapered_screw, BitShape::round_burr}) {
    SessionSetup other;
    other.path.bit.shape = shape;
    EXPECT_EQ(chosen_engine(other), shape == BitShape::round_burr ? EngineKind::leaf : EngineKind::ring);
    EXPECT_EQ(chosen_engine(other, {.trembles = false}), EngineKind::ring);
  }
  EXPECT_EQ(chosen_engine(setup, {.keeps_to_path = false}), EngineKind::voxel);
  SessionSetup at_device;
  at_device.options.has_device = true;
  EXPECT_EQ(chosen_engine(at_device), EngineKind::voxel);
  setup.region_mm = Box3(Vec3::Zero(), Vec3::Ones());
  EXPECT_EQ(chosen_engine(setup), EngineKind::voxel);
}

TEST(ChosenEngine, OfAWayThatLeavesThePathGoesWithASessionThatTellsNothingOfIt) {
  const SessionSetup milling = setup_for({}, {.keeps_to_path = false});
  EXPECT_EQ(milling.engine, EngineKind::voxel);
  EXPECT_FALSE(milling.options.follows_path);
  const SessionSetup drilling = setup_for({}, {.trembles = false});
  EXPECT_EQ(drilling.engine, EngineKind::ring);
  EXPECT_TRUE(drilling.options.follows_path);
  SessionSetup own;
  own.options.follows_path = false;
  EXPECT_EQ(chosen_engine(own), EngineKind::voxel);
  EXPECT_FALSE(setup_for(own, {}).options.follows_path);
  own.engine = EngineKind::leaf;
  EXPECT_EQ(setup_for(own, {.keeps_to_path = false}).engine, EngineKind::leaf);
}

TEST(Region, AroundAPathHoldsAllThatIsSoNear) {
  const DrillPath path{"p", Vec3(1.0, 2.0, 3.0), Vec3(1.0, 2.0, 13.0), {}};
  const Box3 box = region_around(path, 4.0, 2.5);
  EXPECT_EQ(box.min(), Vec3(-1.5, -0.5, -3.5));
  EXPECT_EQ(box.max(), Vec3(3.5, 4.5, 15.5));
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_THAT([&] { region_around(path, 4.0, bad); }, ThrowsMessage<Error>(HasSubstr("expected a distance")));
  }
}

TEST(Region, IsABoxWithRoomInIt) {
  EXPECT_NO_THROW(check_region({Vec3::Zero(), Vec3::Ones()}));
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& high : {Vec3(1.0, 0.0, 1.0), Vec3(1.0, 1.0, -1.0), Vec3(nan, 1.0, 1.0), Vec3(1.0, infinity, 1.0)}) {
    EXPECT_THAT([&] { check_region({Vec3::Zero(), high}); }, ThrowsMessage<Error>(HasSubstr("second corner")));
  }
  EXPECT_THROW(check_region(Box3()), Error);
}

}  // namespace
}  // namespace spinaltap
