#include "core/session/drill_state.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

std::string_view name_of(DrillState state) {
  switch (state) {
    case DrillState::initial:
      return "initial";
    case DrillState::outer_cortical:
      return "outer cortical";
    case DrillState::cancellous:
      return "cancellous";
    case DrillState::transitional:
      return "transitional";
    case DrillState::inner_cortical:
      return "inner cortical";
  }
  return "";
}

void check_state_rules(const StateRules& rules) {
  constexpr double kDensestGCm3 = 3.0;  // teeth
  if (!(rules.contact_g_cm3 > 0.0 && rules.contact_g_cm3 < rules.rising_g_cm3 &&
        rules.rising_g_cm3 <= rules.cortical_g_cm3 && rules.cortical_g_cm3 <= kDensestGCm3)) {
    fail("states: expected densities of contact, rising and cortical bone that rise between 0 and ", kDensestGCm3,
         " g/cm3, found ", rules.contact_g_cm3, ", ", rules.rising_g_cm3, " and ", rules.cortical_g_cm3);
  }
  constexpr double kLongestMm = 10.0;
  if (!(rules.hold_mm >= 0.0 && rules.hold_mm <= kLongestMm) ||
      !(rules.no_cortex_mm >= 0.0 && rules.no_cortex_mm <= kLongestMm)) {
    fail("states: expected ways from 0 to ", kLongestMm, " mm until a state is certain, found ", rules.hold_mm,
         " mm and, without cortex, ", rules.no_cortex_mm, " mm");
  }
}

StateRecogniser::StateRecogniser(const StateRules& rules) : rules_(rules) { check_state_rules(rules); }

bool StateRecogniser::enter(DrillState next, double since_mm, double hold_mm) noexcept {
  // A billionth forgives the rounding of depths, so that a hold of ten steps is one of ten steps.
  if (!(deepest_mm_ - since_mm >= hold_mm - 1e-9)) return false;
  state_ = next;
  begin_mm_ = since_mm;
  return true;
}

DrillState StateRecogniser::update(double depth_mm, double tip_density_g_cm3) noexcept {
  // The hole behind the deepest tip tells nothing any more. A density that is not a number is none.
  if (!(depth_mm > deepest_mm_) || !std::isfinite(depth_mm)) return state_;
  deepest_mm_ = depth_mm;
  contact_.update(depth_mm, tip_density_g_cm3 >= rules_.contact_g_cm3);
  rising_.update(depth_mm, tip_density_g_cm3 >= rules_.rising_g_cm3);
  cortical_.update(depth_mm, tip_density_g_cm3 >= rules_.cortical_g_cm3);
  switch (state_) {
    case DrillState::initial:
      if (contact_.is_above) enter(DrillState::outer_cortical, contact_.since_mm, rules_.hold_mm);
      break;
    case DrillState::outer_cortical: {
      has_met_cortex_ = has_met_cortex_ || cortical_.is_above;
      // At the surface CT numbers rise over the width of the CT's blur: bone does not begin as cortex at once.
      const double since_mm = std::max(cortical_.since_mm, begin_mm_);
      if (!cortical_.is_above) {
        enter(DrillState::cancellous, since_mm, has_met_cortex_ ? rules_.hold_mm : rules_.no_cortex_mm);
      }
      break;
    }
    case DrillState::cancellous:
      if (cortical_.is_above && enter(DrillState::inner_cortical, cortical_.since_mm, rules_.hold_mm)) break;
      // What is left of the cortex's edge is dense as well, but not rising.
      if (rising_.is_above && rising_.since_mm > begin_mm_) {
        enter(DrillState::transitional, rising_.since_mm, rules_.hold_mm);
      }
      break;
    case DrillState::transitional:
      if (cortical_.is_above && enter(DrillState::inner_cortical, cortical_.since_mm, rules_.hold_mm)) break;
      if (!rising_.is_above) enter(DrillState::cancellous, rising_.since_mm, rules_.hold_mm);
      break;
    case DrillState::inner_cortical:
      break;
  }
  return state_;
}

}  // namespace spinaltap
