// Breaches, and stops before them, in a block of bone with a hole for a canal.

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/session/drill_session.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "tests/support/drill_block.h"
#include "tests/support/planning_bones.h"

namespace spinaltap {
namespace {

constexpr double kStopMm = 0.05;

class SessionWalls : public ::testing::Test {
 protected:
  /// From the block's back forward, with the bit's side 1 mm inside the canal where that is widest.
  static DrillPath path() {
    return {"beside", Vec3(8.5, 20.0, 0.0), Vec3(8.5, -20.0, 0.0), twist_drill(3.0, 70.0, 118.0, 0.48)};
  }
  static const WallDistance& walls() {
    static const test::Block block;
    static const WallDistance walls(block.bone(), block.landmarks());
    return walls;
  }
  static const ClearanceField& clearances() {
    static const ClearanceField field(walls(), path(), 4.0, 2.0, 6.0);
    return field;
  }

  SessionWalls() {
    volumes_.emplace_back(path(), PointVolumeOptions{.radius_mm = 2.5, .spacing_mm = 0.2, .lead_in_mm = 2.0});
    fill_volume(volumes_.front(),
                [](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
                  for (std::size_t n = 0; n < points_mm.size(); ++n) {
                    double value_mm = 0.0;
                    walls().bone().surface().evaluate({&points_mm[n], 1}, {&value_mm, 1}, {});
                    distance_mm[n] = static_cast<float>(value_mm);
                    hu[n] = 300.0F;
                  }
                });
  }

  DrillSession& session(const SessionOptions& options = {}) {
    session_ =
        std::make_unique<DrillSession>(path(), volumes_, make_ring_engine(volumes_.front(), path().bit, Material()),
                                       Material(), &clearances(), options);
    return *session_;
  }
  /// In steps of 20 µm, 2 mm/s, to a depth and, where asked, back.
  void drill(double to_mm, bool back = false) {
    std::vector<ToolInput> inputs;
    const auto at = [](double depth_mm) {
      return ToolInput{{path().entry_mm + depth_mm * path().direction(), path().direction()}, true, 0.01};
    };
    const int steps = static_cast<int>((to_mm + 1.0) / 0.02);
    for (int n = 0; n <= steps; ++n) inputs.push_back(at(-1.0 + 0.02 * n));
    for (int n = back ? steps : -1; n >= 0; --n) inputs.push_back(at(-1.0 + 0.02 * n));
    RecordedMotion tool_operator(inputs);
    run_session(*session_, tool_operator);
  }

  std::vector<PointVolume> volumes_;
  std::unique_ptr<DrillSession> session_;
};

TEST_F(SessionWalls, NotesABreachIntoTheCanalWithItsDepth) {
  const DrillSession& ran = session();
  drill(39.0);
  const auto breaches = test::events_of(ran, EventKind::canal_breach);
  ASSERT_EQ(breaches.size(), 1U);
  EXPECT_NEAR(breaches[0].value, 1.0, kStopMm);
  // The shoulder, 0.757 mm behind the tip, reaches the canal where its side at x = 7 mm does: at y = sqrt(8² - 7²).
  EXPECT_NEAR(breaches[0].depth_mm, 20.0 - std::sqrt(15.0) + path().bit.tip_length_mm, 0.15);
  EXPECT_NEAR(breaches[0].place_mm.y(), 0.0, 0.5) << "where it is deepest";
  EXPECT_TRUE(test::events_of(ran, EventKind::outer_breach).empty());
  EXPECT_FALSE(ran.is_stopped());
}

TEST_F(SessionWalls, NotesABreachThroughTheFrontAndOnceMoreAfterAWayBack) {
  session();
  drill(42.0, true);
  drill(41.0);
  const auto breaches = test::events_of(*session_, EventKind::outer_breach);
  ASSERT_EQ(breaches.size(), 2U);
  EXPECT_NEAR(breaches[0].value, 2.0, kStopMm);
  EXPECT_NEAR(breaches[0].depth_mm, 40.0, kStopMm + 0.02);
  EXPECT_NEAR(breaches[1].value, 1.0, kStopMm);
  // Its end is the volume's: no breakthrough can be told there.
  EXPECT_TRUE(test::events_of(*session_, EventKind::breakthrough).empty());
}

TEST_F(SessionWalls, StopAtAClearance) {
  SessionOptions options;
  options.stop.clearance_mm = 0.5;
  const DrillSession& ran = session(options);
  drill(39.0);
  const auto stops = test::events_of(ran, EventKind::stop_clearance);
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_LE(stops[0].value, 0.5);
  EXPECT_GT(stops[0].value, 0.5 - kStopMm);
  // x = 7 mm is half a millimetre from the canal at y = sqrt(8.5² - 7²).
  EXPECT_NEAR(stops[0].depth_mm, 20.0 - std::sqrt(8.5 * 8.5 - 49.0) + path().bit.tip_length_mm, 0.15);
  EXPECT_EQ(ran.last().depth_mm, stops[0].depth_mm);
  EXPECT_TRUE(test::events_of(ran, EventKind::canal_breach).empty()) << "in time";
}

TEST_F(SessionWalls, StopOnABreach) {
  SessionOptions options;
  options.stop.on_breach = true;
  const DrillSession& ran = session(options);
  drill(39.0);
  const auto stops = test::events_of(ran, EventKind::stop_breach);
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_GT(stops[0].value, 0.0);
  EXPECT_LT(stops[0].value, kStopMm);
  EXPECT_EQ(stops[0].cycle, test::events_of(ran, EventKind::canal_breach).at(0).cycle);
  EXPECT_TRUE(ran.is_stopped());
}

TEST_F(SessionWalls, AreNeitherBreachedNorStoppedAtByABitThatHasNotTouchedBone) {
  SessionOptions options;
  options.stop.clearance_mm = 2.0;
  options.stop.on_breach = true;
  const DrillSession& ran = session(options);
  RecordedMotion tool_operator({{{Vec3(8.5, 23.0, 21.0), path().direction()}, true, 0.01},
                                {{Vec3(8.5, 0.0, 21.0), path().direction()}, true, 0.01}});
  run_session(*session_, tool_operator);
  // Beside the points, deeper than the entry: what is there is not known, and that is said.
  ASSERT_EQ(ran.events().size(), 1U);
  EXPECT_EQ(ran.events().front().kind, EventKind::outside_volume);
}

}  // namespace
}  // namespace spinaltap
