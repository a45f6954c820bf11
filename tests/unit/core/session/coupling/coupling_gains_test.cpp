#include "core/session/coupling/coupling_gains.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

/// A spring whose other end does not move: a damper holds the tool.
CouplingGain held_spring(double stiffness, double damping = 0.0) { return {stiffness, damping, 0.0, 1e9}; }

TEST(CouplingGains, ASampledWallNeedsHalfAPeriodOfItsStiffnessAsDamping) {
  // Colgate & Schenkel 1997: b > K T / 2 + |B|.
  EXPECT_NEAR(needed_damping(held_spring(2.0), 0.001, 0.0), 2.0 * 0.0005, 1e-6);
  EXPECT_NEAR(needed_damping(held_spring(2.0), 0.0005, 0.0), 2.0 * 0.00025, 1e-6);
  EXPECT_NEAR(needed_damping(held_spring(2.0, 0.003), 0.001, 0.0), 2.0 * 0.0005 + 0.003, 1e-6);
}

TEST(CouplingGains, ADelayNeedsItsTimeTheStiffnessMore) {
  for (const double delay_s : {0.001, 0.002, 0.005}) {
    EXPECT_NEAR(needed_damping(held_spring(0.5), 0.001, delay_s), 0.5 * (0.0005 + delay_s), 1e-6) << delay_s;
  }
}

TEST(CouplingGains, ToolInAirNeedsLessThanAHeldOne) {
  CouplingGain free{1.0, 0.0, 2e-5, 0.004};
  // With the bone there too, it is the same whatever the tool is: at its resonance with the spring it asks for more.
  EXPECT_GE(needed_damping(free, 0.001, 0.0), 1.0 * 0.0005 * 0.99);
  EXPECT_LT(needed_damping(free, 0.001, 0.0), 1.0 * 0.0005 * 1.5);
}

TEST(CouplingGains, AreWithinWhatTheDeviceBears) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    auto uniform = [&, n = std::uint64_t{0}](double from, double to) mutable {
      return from + (to - from) * random_uniform(seed, n++);
    };
    DeviceLimits limits;
    limits.rate_hz = uniform(500.0, 5000.0);
    limits.delay_s = uniform(0.0, 0.005);
    limits.max_stiffness_n_mm = uniform(0.1, 20.0);
    limits.mass_kg = uniform(0.05, 2.0);
    limits.damping_n_s_mm = uniform(0.0002, 0.01);
    limits.friction_n = uniform(0.0, 0.3);
    limits.position_step_mm = uniform(0.001, 0.1);
    CouplingOptions options;
    options.stiffness_n_mm = uniform(0.0, 1.0) < 0.5 ? 0.0 : uniform(0.01, 5.0);
    const CouplingGain gain = coupling_gains(limits, options).way;
    EXPECT_GT(gain.stiffness, 0.0) << seed;
    EXPECT_LE(gain.stiffness, limits.max_stiffness_n_mm) << seed;
    if (options.stiffness_n_mm > 0.0) {
      EXPECT_LE(gain.stiffness, options.stiffness_n_mm) << seed;
    }
    EXPECT_LE(gain.stiffness * limits.position_step_mm, 0.0451) << seed;
    EXPECT_LE(needed_damping(gain, 1.0 / limits.rate_hz, limits.delay_s), limits.damping_n_s_mm) << seed;
  }
}

TEST(CouplingGains, RejectDevicesAndOptionsThatMakeNoSense) {
  const auto rejects = [](const auto& spoil) {
    DeviceLimits limits;
    CouplingOptions options;
    spoil(limits, options);
    EXPECT_THROW(coupling_gains(limits, options), Error);
  };
  rejects([](DeviceLimits& of, CouplingOptions&) { of.rate_hz = 10.0; });
  rejects([](DeviceLimits& of, CouplingOptions&) { of.damping_n_s_mm = 0.0; });
  rejects([](DeviceLimits& of, CouplingOptions&) { of.mass_kg = test::kNan; });
  rejects([](DeviceLimits& of, CouplingOptions&) { of.delay_s = 1.0; });
  rejects([](DeviceLimits& of, CouplingOptions&) { of.gives_torque = true; });
  rejects([](DeviceLimits&, CouplingOptions& of) { of.force_scale = 0.0; });
  rejects([](DeviceLimits&, CouplingOptions& of) { of.lost_s = test::kNan; });
  rejects([](DeviceLimits&, CouplingOptions& of) { of.spindle_button = 33; });
}

}  // namespace
}  // namespace spinaltap
