#include "core/session/operator/straight_ways.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "core/tool/drill_path.h"

namespace spinaltap {
namespace {

/// Lines by where they pass and how they lean, in whole tolerances. A map, so that their order is the same everywhere.
using LineKey = std::array<std::int64_t, 6>;

/// Poses of one line, by the tip's place along it.
struct LineStretch {
  double from_mm = 0.0;
  double to_mm = 0.0;
  Pose from;
  Pose to;
};

/// Whether a pose further along a line always covers those behind it, but for what the bit's base has left.
bool widens_towards_base(const DrillBit& bit) {
  return bit.shape == BitShape::drill || bit.shape == BitShape::tapered_screw;
}

class Lines {
 public:
  Lines(const Pose& first, const DrillBit& bit, double tolerance_mm)
      : frame_(first.tip_mm, first.axis),
        tolerance_mm_(tolerance_mm),
        lean_tolerance_(tolerance_mm / bit.length_mm),
        bridged_mm_(widens_towards_base(bit) ? bit.length_mm : tolerance_mm) {}

  /// Gaps between poses of a line that leave nothing standing.
  double bridged_mm() const { return bridged_mm_; }

  void add(const Pose& pose) {
    const Pose local = frame_.to_path(pose);
    const double along_mm = local.tip_mm.dot(local.axis);
    // The line's point nearest the first tip.
    const Vec3 foot_mm = local.tip_mm - along_mm * local.axis;
    LineKey key{};
    for (std::size_t n = 0; n < 3; ++n) {
      const auto axis = static_cast<Eigen::Index>(n);
      key[n] = std::llround(foot_mm[axis] / tolerance_mm_);
      key[n + 3] = std::llround(local.axis[axis] / lean_tolerance_);
    }
    std::vector<LineStretch>& stretches = lines_[key];
    for (LineStretch& stretch : stretches) {
      if (along_mm < stretch.from_mm - bridged_mm_ || along_mm > stretch.to_mm + bridged_mm_) continue;
      if (along_mm < stretch.from_mm) {
        stretch.from_mm = along_mm;
        stretch.from = pose;
      }
      if (along_mm > stretch.to_mm) {
        stretch.to_mm = along_mm;
        stretch.to = pose;
      }
      return;
    }
    stretches.push_back({along_mm, along_mm, pose, pose});
  }

  std::vector<BitWay> ways() const {
    std::vector<BitWay> ways;
    for (const auto& [key, stretches] : lines_) {
      for (const LineStretch& stretch : stretches) {
        // Along the deepest pose's axis: the others lie within the tolerance.
        const double way_mm = (stretch.to.tip_mm - stretch.from.tip_mm).dot(stretch.to.axis);
        ways.push_back({{stretch.to.tip_mm - way_mm * stretch.to.axis, stretch.to.axis}, stretch.to});
      }
    }
    return ways;
  }

 private:
  PathFrame frame_;
  double tolerance_mm_;
  double lean_tolerance_;
  double bridged_mm_;
  std::map<LineKey, std::vector<LineStretch>> lines_;
};

Pose between(const Pose& from, const Pose& to, double share) {
  return {from.tip_mm + share * (to.tip_mm - from.tip_mm), (from.axis + share * (to.axis - from.axis)).normalized()};
}

}  // namespace

struct StraightWays::State {
  DrillBit bit;
  double max_jump_mm = 0.0;
  double tolerance_mm = 0.0;
  std::optional<Lines> lines = {};  ///< from the first pose that took bone on
  std::optional<Pose> before = {};  ///< that took bone, and that the next way begins at
};

StraightWays::StraightWays(const DrillBit& bit, double max_jump_mm, double tolerance_mm)
    : state_(std::make_unique<State>(State{bit, max_jump_mm, tolerance_mm})) {}
StraightWays::~StraightWays() = default;
StraightWays::StraightWays(StraightWays&&) noexcept = default;
StraightWays& StraightWays::operator=(StraightWays&&) noexcept = default;

void StraightWays::add(const ToolInput& input) {
  State& state = *state_;
  // Sessions reject others: they do nothing, and the way goes on after them.
  const std::optional<Pose> sound = sound_pose(input.pose);
  if (!sound) return;
  if (!input.spindle_on) {
    state.before.reset();
    return;
  }
  const Pose& pose = *sound;
  if (!state.lines) state.lines.emplace(pose, state.bit, state.tolerance_mm);
  if (state.before) {
    const Pose& from = *state.before;
    const Vec3 way_mm = pose.tip_mm - from.tip_mm;
    const Vec3 base_way_mm = way_mm - state.bit.length_mm * (pose.axis - from.axis);
    if (std::max(way_mm.norm(), base_way_mm.norm()) <= state.max_jump_mm) {
      // What of the way is not along the axis goes in steps of the tolerance, the rest in steps that are bridged.
      const double along_mm = way_mm.dot(pose.axis);
      const double aside_mm =
          (way_mm - along_mm * pose.axis).norm() + (pose.axis - from.axis).norm() * state.bit.length_mm;
      const double steps =
          std::ceil(std::max(aside_mm / state.tolerance_mm, std::abs(along_mm) / state.lines->bridged_mm()));
      for (double n = 1.0; n < steps; ++n) state.lines->add(between(from, pose, n / steps));
    }
  }
  state.lines->add(pose);
  state.before = pose;
}

std::vector<BitWay> StraightWays::ways() const { return state_->lines ? state_->lines->ways() : std::vector<BitWay>(); }

std::vector<BitWay> straight_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                  double tolerance_mm) {
  StraightWays ways(bit, max_jump_mm, tolerance_mm);
  for (const ToolInput& input : inputs) ways.add(input);
  return ways.ways();
}

}  // namespace spinaltap
