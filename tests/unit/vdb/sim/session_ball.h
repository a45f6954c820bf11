#pragma once

#include <vector>

#include "tests/support/analytic_bodies.h"
#include "vdb/sim/session.h"

/// A ball of bone and a path into it, for tests of sessions.
namespace spinaltap::test::session_ball {

inline const Ball kSessionBall{Vec3(3.0, -4.0, 5.0), 9.0};

inline const Bone& ball() {
  static const Bone bone(bake_ball(kSessionBall, 0.3));
  return bone;
}

inline DrillPath path() {
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry_mm = kSessionBall.centre_mm - kSessionBall.radius_mm * axis;
  return {"slanting", entry_mm, entry_mm + 8.0 * axis, {2.0, 30.0, 2.0}};
}

/// The ball is no vertebra.
inline SessionSetup setup() {
  SessionSetup setup;
  setup.has_clearances = false;
  setup.volume = {.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 1.0};
  return setup;
}

/// Straight in, `count` cycles of 0.02 mm from 1 mm before the entry on.
inline std::vector<ToolInput> straight_in(int count, double aside_mm = 0.0) {
  const DrillPath line = path();
  const Vec3 aside = line.direction().cross(Vec3::UnitX()).normalized();
  std::vector<ToolInput> inputs;
  for (int n = 0; n < count; ++n) {
    inputs.push_back(
        {{line.entry_mm + (0.02 * n - 1.0) * line.direction() + aside_mm * aside, line.direction()}, true, 0.001});
  }
  return inputs;
}

inline DrillBit round_burr(double diameter_mm) {
  return {diameter_mm, 40.0, 0.5 * diameter_mm, BitShape::round_burr, 0.0, 0.5 * diameter_mm};
}

}  // namespace spinaltap::test::session_ball
