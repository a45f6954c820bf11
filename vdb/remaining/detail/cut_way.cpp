#include <algorithm>
#include <cmath>

#include "core/tool/plate.h"
#include "core/tool/swept_bit.h"
#include "vdb/remaining/detail/bit_sweep.h"

namespace spinaltap::detail {
namespace {

/// How far from the tip a tool reaches: what turns of its axis and of its side move.
struct ToolReach {
  double along_mm = 0.0;
  double aside_mm = 0.0;  ///< 0: the same whichever way it is turned
};

/// What tools differ in.
class RevolvedTool {
 public:
  explicit RevolvedTool(const DrillBit& bit) : profile_(bit), outlines_(profile_) {}

  ToolReach reach() const { return {profile_.length_mm() + profile_.radius_mm()}; }
  BitMotion motion(const Pose& from, const Pose& to) const { return {outlines_, from, to}; }
  BitOutline outline() const { return BitOutline(profile_); }
  bool may_be_lengthened() const { return profile_.widens_to_one_place(); }
  BitOutline lengthened(double way_mm) const { return BitOutline(profile_.lengthened(way_mm)); }

 private:
  BitProfile profile_;
  SweepProfile outlines_;
};

class PlateTool {
 public:
  explicit PlateTool(const DrillBit& plate) : sweep_(plate) {}

  ToolReach reach() const {
    const Vec3& corner = sweep_.box.high_mm();
    return {corner.z() + corner.y(), corner.x() + corner.y()};
  }
  PlateMotion motion(const Pose& from, const Pose& to) const { return {sweep_, from, to}; }
  BitOutline outline() const { return BitOutline(sweep_.box); }
  bool may_be_lengthened() const { return true; }
  BitOutline lengthened(double way_mm) const { return BitOutline(sweep_.box.lengthened(way_mm)); }

 private:
  PlateSweep sweep_;
};

/// How far, at most, the bit at `pose` lies from where it comes on its way from `from` to `to`.
double off_way_mm(const Pose& from, const Pose& to, const Pose& pose, const ToolReach& reach) {
  const Vec3 way = to.tip_mm - from.tip_mm;
  const Vec3 turn = to.axis - from.axis;
  double squared = way.squaredNorm() + reach.along_mm * reach.along_mm * turn.squaredNorm();
  double along =
      (pose.tip_mm - from.tip_mm).dot(way) + reach.along_mm * reach.along_mm * (pose.axis - from.axis).dot(turn);
  if (reach.aside_mm > 0.0) {
    const Vec3 side_turn = to.side - from.side;
    squared += reach.aside_mm * reach.aside_mm * side_turn.squaredNorm();
    along += reach.aside_mm * reach.aside_mm * (pose.side - from.side).dot(side_turn);
  }
  const double t = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  double off_mm =
      (pose.tip_mm - from.tip_mm - t * way).norm() + reach.along_mm * (pose.axis - from.axis - t * turn).norm();
  if (reach.aside_mm > 0.0) off_mm += reach.aside_mm * (pose.side - from.side - t * (to.side - from.side)).norm();
  return off_mm;
}

/// Poses that are needed, of those given: each time the furthest that can be reached in one.
std::vector<Pose> fewer_poses(std::span<const Pose> poses, const ToolReach& reach, double tolerance_mm) {
  constexpr std::size_t kMaxInOne = 64;
  std::vector<Pose> kept{poses[0]};
  std::size_t at = 0;
  while (at + 1 < poses.size()) {
    std::size_t next = at + 1;
    for (std::size_t candidate = at + 2; candidate < std::min(poses.size(), at + kMaxInOne); ++candidate) {
      bool all = true;
      for (std::size_t n = at + 1; n < candidate && all; ++n) {
        all = off_way_mm(poses[at], poses[candidate], poses[n], reach) <= tolerance_mm;
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
  // Bodies of revolution have no side.
  return (from.axis - to.axis).norm() < kSame && (from.side - to.side).norm() < kSame &&
         (way - way.dot(to.axis) * to.axis).norm() < kSame;
}

template <class Tool>
std::vector<BitSweep> cut_way(const Tool& tool, std::span<const Pose> poses, double tolerance_mm, double longest_mm) {
  const auto outline = std::make_shared<const BitOutline>(tool.outline());
  const ToolReach reach = tool.reach();
  const std::vector<Pose> needed = fewer_poses(poses, reach, tolerance_mm);
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
    if (tool.may_be_lengthened() && is_along_axis(from, to)) {
      finish();
      const double along_mm = (to.tip_mm - from.tip_mm).dot(to.axis);
      const Pose& foremost = along_mm >= 0.0 ? to : from;
      sweeps.emplace_back(std::make_shared<const BitOutline>(tool.lengthened(std::abs(along_mm))),
                          std::span(&foremost, 1), std::abs(along_mm));
      way = {to};
      continue;
    }
    const double length_mm = (to.tip_mm - from.tip_mm).norm() + reach.along_mm * (to.axis - from.axis).norm() +
                             reach.aside_mm * (to.side - from.side).norm();
    const auto motion = tool.motion(from, to);
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

}  // namespace

std::vector<BitSweep> cut_into_sweeps(const DrillBit& bit, std::span<const Pose> poses, double tolerance_mm,
                                      double longest_mm) {
  if (bit.is_plate()) return cut_way(PlateTool(bit), poses, tolerance_mm, longest_mm);
  return cut_way(RevolvedTool(bit), poses, tolerance_mm, longest_mm);
}

}  // namespace spinaltap::detail
