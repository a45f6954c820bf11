#pragma once

#include <cstdint>

#include "core/session/operator/operator.h"
#include "core/session/operator/path_motion.h"

namespace spinaltap {

/// How an operator pushes. Where no source is named, values are estimates.
struct ForceControlOptions {
  GuideLine line = {};
  double rate_hz = 1000.0;     ///< poses a second
  Spindle spindle = {};        ///< as the session has it
  double push_n = 40.0;        ///< along the line
  double ramp_s = 0.5;         ///< from contact until all of it is there
  double approach_mm_s = 5.0;  ///< feed until contact
  /// Of hand, forearm and drill, as they resist along the line: an arm that holds a handle has 0.55 kg (a trial of van
  /// Beek et al., Sci Rep 2015), a surgical drill about 1 kg.
  double mass_kg = 1.5;
  /// N·s/mm: alone it holds the free bit to push over damping. It stands for the arm's stiffness and its owner's care
  /// as well, and is such that a push of 40 N plunges some 5 mm, as surgeons with sharp bits do: 5.1 mm the
  /// experienced, 7.6 mm the others (Alajmo et al., J Orthop Trauma 2012).
  double damping_n_s_mm = 2.0;
  double reaction_s = 0.2;     ///< from what is felt or heard to letting go
  double noticed_share = 0.2;  ///< a counterforce that drops below so much of what it was is noticed; 0: never
  /// Where the bit stands or crawls the push is raised, to this at most: what a person who leans on a drill with both
  /// arms comes to. Where it is less than push_n, not at all.
  double max_push_n = 200.0;
  double raise_n_s = 30.0;  ///< how fast
  double rock_deg = 1.0;    ///< the handle is rocked by so much about the entry meanwhile
  /// Feed to which it holds back once it has let go of a push and a probe has felt bone still: it is through the
  /// entry's cortex, and knows how soft what follows is.
  double careful_mm_s = 2.0;
  double stands_s = 5.0;     ///< gives up where the bit stands for so long under all of its push
  double tremor_mm = 0.0;    ///< Tremor's amplitude
  std::uint64_t seed = 1;    ///< of the tremor
  double longest_s = 120.0;  ///< gives up then
};

/// An operator that pushes along a line, so that feed follows from the bone: m dv/dt = F - T(v) - c v, with the thrust
/// T that the bone asks of a feed (CuttingResistance), by the implicit Euler method. It approaches until it feels bone,
/// and pushes; where the bit stands or crawls it rocks the handle and pushes harder. It lets go at the target, when the
/// session asks to stop, and when the bone gives way: the latter two after its reaction time, in which the bit plunges.
/// Once it stands it probes the hole: with bone at its end it goes on, carefully; without, it was the far side.
/// docs/sessions.md has the rules.
class ForceControlled final : public Operator {
 public:
  /// Throws Error on values that are not numbers or out of range.
  ForceControlled(const DrillPath& path, const ForceControlOptions& options);

  std::optional<ToolInput> next(const ToolFeedback& feedback) override;
  OperatorEnd end() const override { return end_; }

  /// Along the line, but for the tremor: depth beyond the entry (mm), and feed (mm/s).
  double depth_mm() const { return depth_mm_; }
  double feed_mm_s() const { return feed_mm_s_; }
  /// What it pushes with, N.
  double push_n() const { return push_n_; }

 private:
  enum class Phase : std::uint8_t { approach, push, let_go };

  void feel(const ToolFeedback& feedback) noexcept;
  bool gives_way() noexcept;
  void lean() noexcept;
  void move(const CuttingResistance& bone) noexcept;
  bool is_over(const ToolFeedback& feedback) noexcept;
  Pose pose(double time_s) const;

  GuidedBit bit_;
  Tremor tremor_;
  ForceControlOptions options_;
  double dt_s_;
  Phase phase_ = Phase::approach;
  OperatorEnd end_ = OperatorEnd::as_planned;
  std::uint64_t cycle_ = 0;
  double depth_mm_;
  double feed_mm_s_ = 0.0;
  double push_n_;  ///< but for the ramp
  bool is_careful_ = false;
  double pushed_s_ = 0.0;        ///< since contact
  double counterforce_n_ = 0.0;  ///< of the last cycle
  double felt_n_ = 0.0;          ///< the largest counterforce of a while, which fades
  double loose_s_ = 0.0;         ///< for so long it has been small
  double stop_s_ = 0.0;          ///< for so long the session has asked to stop
  double still_s_ = 0.0;         ///< since it stands, having let go
  double slow_s_ = 0.0;          ///< since it goes slower than it would
  double stands_s_ = 0.0;        ///< since the bone holds all of its push
  double rock_ = 0.0;            ///< share of rock_deg
  double rocked_s_ = 0.0;
  bool has_noticed_ = false;  ///< that the bone gave way
};

}  // namespace spinaltap
