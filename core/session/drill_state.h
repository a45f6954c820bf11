#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

namespace spinaltap {

/// The five states of drilling a pedicle (Hu et al. 2013), by what the chisel edge meets.
enum class DrillState : std::uint8_t {
  initial,         ///< not yet in bone
  outer_cortical,  ///< in the cortex at the entry
  cancellous,
  transitional,   ///< bone is getting denser: the far cortex is near
  inner_cortical  ///< in the far cortex, or through it
};
/// "initial", "outer cortical", "cancellous", "transitional", "inner cortical".
std::string_view name_of(DrillState state);

/// How states are told apart.
struct StateRules {
  double contact_g_cm3 = 0.1;    ///< densities at the chisel edge: above, it is in bone
  double cortical_g_cm3 = 0.65;  ///< above, it is in cortex
  double rising_g_cm3 = 0.45;    ///< above, after cancellous bone, the far cortex is near
  double hold_mm = 0.1;          ///< a state begins when the tip has gone so far in it
  double no_cortex_mm = 0.5;     ///< bone that has not been dense as cortex for so long has none at the entry
};
/// Rejects values that are not finite or below 0, and thresholds that do not rise from contact to cortex.
void check_state_rules(const StateRules& rules);

/// Recognises the states from the density at the chisel edge, which the thrust of a robot's drill shows as well. Goes
/// forward only, but for transitional to cancellous, where the density was a strut. A state's depth is where it began,
/// not where it was certain.
class StateRecogniser {
 public:
  /// Throws Error as check_state_rules() does.
  explicit StateRecogniser(const StateRules& rules = {});

  /// After a cycle: the tip's depth along the path (mm) and the density just ahead of it. Only cycles that take the tip
  /// deeper than ever count; each brings the next state at most.
  DrillState update(double depth_mm, double tip_density_g_cm3) noexcept;

  DrillState state() const { return state_; }
  /// Depth at which the present state began, mm.
  double begin_mm() const { return begin_mm_; }

 private:
  /// Since what depth the density has been at or above a threshold, or below it.
  struct Level {
    bool is_above = false;
    double since_mm = 0.0;

    void update(double depth_mm, bool is_above_now) noexcept {
      if (is_above_now != is_above) since_mm = depth_mm;
      is_above = is_above_now;
    }
  };
  /// Goes on to `next`, where that has held from `since_mm` for so long.
  bool enter(DrillState next, double since_mm, double hold_mm) noexcept;

  StateRules rules_;
  DrillState state_ = DrillState::initial;
  double begin_mm_ = 0.0;
  double deepest_mm_ = -std::numeric_limits<double>::infinity();
  Level contact_, rising_, cortical_;
  bool has_met_cortex_ = false;
};

}  // namespace spinaltap
