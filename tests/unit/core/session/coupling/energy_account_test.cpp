#include "core/session/coupling/energy_account.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

namespace spinaltap {
namespace {

constexpr double kAccountDtS = 0.001;

/// What a force that pushes with the hand wherever it goes, 3 N, gives to a hand that goes to and fro with up to 80
/// mm/s, N·mm at most; as much of it as an account allows, or all.
double given_by_active_force(double delay_s, bool is_allowed_for) {
  DeviceLimits limits;
  limits.delay_s = delay_s;
  limits.damping_n_s_mm = 0.001;
  EnergyAccount account(limits, coupling_gains(limits, {}), kAccountDtS);
  std::deque<Vec3> under_way(static_cast<std::size_t>(std::lround(delay_s / kAccountDtS)) + 1, Vec3::Zero());
  double given_n_mm = 0.0, most_n_mm = 0.0;
  Vec3 at_mm = Vec3::Zero();
  for (int cycle = 0; cycle < 3000; ++cycle) {
    const Vec3 now_mm(8.0 * std::sin(10.0 * cycle * kAccountDtS), 0.0, 0.0);
    const Vec3 way_mm = now_mm - at_mm;
    // The device's own damping takes its part before the hand has any.
    given_n_mm += under_way.front().dot(way_mm) - limits.damping_n_s_mm * way_mm.squaredNorm() / kAccountDtS;
    most_n_mm = std::max(most_n_mm, given_n_mm);
    at_mm = now_mm;
    account.moved({way_mm, Vec3::Zero()});
    Wrench wrench{3.0 * way_mm.normalized(), Vec3::Zero()};
    if (is_allowed_for) wrench = account.allowed(wrench, {way_mm / kAccountDtS, Vec3::Zero()});
    account.given(wrench, kAccountDtS);
    under_way.pop_front();
    under_way.push_back(wrench.force_n);
  }
  return most_n_mm;
}

TEST(EnergyAccount, AllowsAnActiveForceNoEnergy) {
  for (const double delay_s : {0.0, 0.001, 0.005}) {
    EXPECT_GT(given_by_active_force(delay_s, false), 100.0) << delay_s;
    EXPECT_LT(given_by_active_force(delay_s, true), 1.0) << delay_s;
  }
}

TEST(EnergyAccount, GivesBackWhatASpringHasTaken) {
  DeviceLimits limits;
  const CouplingGains gains = coupling_gains(limits, {});
  EnergyAccount account(limits, gains, kAccountDtS);
  const double stiffness = gains.way.stiffness;
  double at_mm = 0.0, worst_n = 0.0;
  Wrench wrench;
  for (int cycle = 0; cycle < 2000; ++cycle) {
    const double now_mm = 2.0 * std::pow(std::sin(6.0 * cycle * kAccountDtS), 2);
    account.moved({Vec3(now_mm - at_mm, 0.0, 0.0), Vec3::Zero()});
    const Twist rate{Vec3((now_mm - at_mm) / kAccountDtS, 0.0, 0.0), Vec3::Zero()};
    at_mm = now_mm;
    wrench.force_n = Vec3(-stiffness * now_mm, 0.0, 0.0);
    const Wrench allowed = account.allowed(wrench, rate);
    worst_n = std::max(worst_n, (allowed.force_n - wrench.force_n).norm());
    account.given(allowed, kAccountDtS);
  }
  // At the end of a stroke the store is nearly empty, and so is the force.
  EXPECT_LT(worst_n, 0.1 * stiffness * 2.0);
}

TEST(EnergyAccount, HoldsNoMoreThanTheSpringCanStore) {
  DeviceLimits limits;
  const CouplingGains gains = coupling_gains(limits, {});
  EnergyAccount account(limits, gains, kAccountDtS);
  for (int cycle = 0; cycle < 10'000; ++cycle) {
    account.given({Vec3(-limits.max_force_n, 0.0, 0.0), Vec3::Zero()}, kAccountDtS);
    account.moved({Vec3(0.1, 0.0, 0.0), Vec3::Zero()});
  }
  const double stored_n_mm = 0.5 * limits.max_force_n * limits.max_force_n / gains.way.stiffness;
  EXPECT_LE(account.left_n_mm(), stored_n_mm + 0.21);
  EXPECT_GE(account.left_n_mm(), stored_n_mm);
}

}  // namespace
}  // namespace spinaltap
