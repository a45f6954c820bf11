#include <algorithm>
#include <cmath>

#include "core/tool/swept_bit.h"
#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap::detail {
namespace {

/// How far, at most, the bit at `pose` lies from where it comes on its way from `from` to `to`.
double off_way_mm(const Pose& from, const Pose& to, const Pose& pose, double reach_mm) {
  const Vec3 way = to.tip_mm - from.tip_mm;
  const Vec3 turn = to.axis - from.axis;
  const double squared = way.squaredNorm() + reach_mm * reach_mm * turn.squaredNorm();
  double t = 0.0;
  if (squared > 0.0) {
    t = (pose.tip_mm - from.tip_mm).dot(way) + reach_mm * reach_mm * (pose.axis - from.axis).dot(turn);
    t = std::clamp(t / squared, 0.0, 1.0);
  }
  return (pose.tip_mm - from.tip_mm - t * way).norm() + reach_mm * (pose.axis - from.axis - t * turn).norm();
}

/// Poses that are needed, of those given: each time the furthest that can be reached in one.
std::vector<Pose> fewer_poses(std::span<const Pose> poses, double reach_mm, double tolerance_mm) {
  constexpr std::size_t kMaxInOne = 64;
  std::vector<Pose> kept{poses[0]};
  std::size_t at = 0;
  while (at + 1 < poses.size()) {
    std::size_t next = at + 1;
    for (std::size_t candidate = at + 2; candidate < std::min(poses.size(), at + kMaxInOne); ++candidate) {
      bool all = true;
      for (std::size_t n = at + 1; n < candidate && all; ++n) {
        all = off_way_mm(poses[at], poses[candidate], poses[n], reach_mm) <= tolerance_mm;
      }
      if (!all) break;
      next = candidate;
    }
    kept.push_back(poses[next]);
    at = next;
  }
  return kept;
}

bool is_along_axis(const Pose& from, const Pose& to) {
  constexpr double kSame = 1e-9;
  const Vec3 way = to.tip_mm - from.tip_mm;
  return (from.axis - to.axis).norm() < kSame && (way - way.dot(to.axis) * to.axis).norm() < kSame;
}

}  // namespace

std::vector<BitSweep> cut_into_sweeps(const BitProfile& profile, std::span<const Pose> poses, double tolerance_mm,
                                      double longest_mm) {
  const auto outline = std::make_shared<const BitOutline>(profile);
  const SweepProfile outlines(profile);
  const double reach_mm = profile.length_mm() + profile.radius_mm();
  const std::vector<Pose> needed = fewer_poses(poses, reach_mm, tolerance_mm);
  std::vector<BitSweep> sweeps;
  std::vector<Pose> way{needed[0]};
  double way_mm = 0.0;
  const auto finish = [&] {
    if (way.size() > 1) sweeps.emplace_back(outline, way);
    way.erase(way.begin(), way.end() - 1);
    way_mm = 0.0;
  };
  for (std::size_t n = 0; n + 1 < needed.size(); ++n) {
    const Pose& from = needed[n];
    const Pose& to = needed[n + 1];
    if (profile.widens_to_one_place() && is_along_axis(from, to)) {
      finish();
      const double along_mm = (to.tip_mm - from.tip_mm).dot(to.axis);
      const Pose& foremost = along_mm >= 0.0 ? to : from;
      sweeps.emplace_back(std::make_shared<const BitOutline>(profile.lengthened(std::abs(along_mm))),
                          std::span(&foremost, 1), std::abs(along_mm));
      way = {to};
      continue;
    }
    const double length_mm = (to.tip_mm - from.tip_mm).norm() + reach_mm * (to.axis - from.axis).norm();
    const BitMotion motion(outlines, from, to);
    const double wanted = std::max(std::sqrt(motion.bend_mm() / tolerance_mm), length_mm / longest_mm);
    const auto pieces = static_cast<std::size_t>(std::clamp(std::ceil(wanted), 1.0, 1e6));
    for (std::size_t piece = 1; piece <= pieces; ++piece) {
      way.push_back(piece == pieces ? to : motion.pose_at(static_cast<double>(piece) / static_cast<double>(pieces)));
      way_mm += length_mm / static_cast<double>(pieces);
      if (way_mm >= longest_mm) finish();
    }
  }
  finish();
  if (sweeps.empty()) sweeps.emplace_back(outline, std::span(way.data(), 1));
  return sweeps;
}

}  // namespace spinaltap::detail
