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
  if (!(rules.contact_g_cm3 > 0.0 && rules.contact_g_cm3 <= rules.cancellous_g_cm3 &&
        rules.cancellous_g_cm3 <= rules.cortical_g_cm3 && rules.cortical_g_cm3 <= kDensestGCm3)) {
    fail("states: expected densities of contact, cancellous and cortical bone that rise between 0 and ", kDensestGCm3,
         " g/cm3, found ", rules.contact_g_cm3, ", ", rules.cancellous_g_cm3, " and ", rules.cortical_g_cm3);
  }
  constexpr double kLongestMm = 10.0;
  for (const double way_mm : {rules.hold_mm, rules.no_cortex_mm, rules.near_mm}) {
    if (!(way_mm >= 0.0 && way_mm <= kLongestMm)) {
      fail("states: expected ways from 0 to ", kLongestMm, " mm until a state is certain, found ", rules.hold_mm,
           " mm and, without cortex, ", rules.no_cortex_mm, " mm, the far side near from ", rules.near_mm, " mm");
    }
  }
  constexpr double kSteepest = 10.0;
  if (!(rules.rise >= 1.0 && rules.rise <= kSteepest)) {
    fail("states: expected a rise to the far cortex from 1 to ", kSteepest, ", found ", rules.rise);
  }
}

void StateRecogniser::Trace::add(double depth_mm, double density_g_cm3) noexcept {
  if (count_ == 0) begin_mm_ = depth_mm;
  // A step that is longer than a place fills several.
  const double wanted = (depth_mm - begin_mm_) / kTraceMm;
  if (wanted - static_cast<double>(count_) > static_cast<double>(kPlaces)) {
    count_ = 0;
    begin_mm_ = depth_mm;
    add(depth_mm, density_g_cm3);
    return;
  }
  while (static_cast<double>(count_) <= wanted) density_g_cm3_[count_++ % kPlaces] = density_g_cm3;
}

double StateRecogniser::Trace::rose_over_mm(double level_g_cm3, double hold_mm) const noexcept {
  const std::size_t kept = std::min(count_, kPlaces);
  std::size_t rose = count_;
  std::size_t below = 0;
  const auto held = static_cast<std::size_t>(std::ceil(hold_mm / kTraceMm));
  for (std::size_t back = 1; back <= kept; ++back) {
    if (density_g_cm3_[(count_ - back) % kPlaces] >= level_g_cm3) {
      rose = count_ - back;
      below = 0;
    } else if (rose < count_ && ++below > held) {
      break;
    }
  }
  return begin_mm_ + static_cast<double>(std::min(rose, count_ - 1)) * kTraceMm;
}

StateRecogniser::StateRecogniser(const StateRules& rules) : rules_(rules), cancellous_g_cm3_(rules.cancellous_g_cm3) {
  check_state_rules(rules);
}

bool StateRecogniser::enter(DrillState next, double since_mm, double hold_mm) noexcept {
  // A billionth forgives the rounding of depths, so that a hold of ten steps is one of ten steps.
  if (!(deepest_mm_ - since_mm >= hold_mm - 1e-9)) return false;
  state_ = next;
  begin_mm_ = since_mm;
  return true;
}

/// From the entry's cortex into cancellous bone.
void StateRecogniser::leave_entry(const TipMeets& tip) noexcept {
  entry_cortex_g_cm3_ = std::max(entry_cortex_g_cm3_, tip.density_g_cm3);
  const double level_g_cm3 = 0.5 * (entry_cortex_g_cm3_ + rules_.cancellous_g_cm3);
  constexpr double kCortexOverCancellous = 2.0;  // of entries, where bone is thick and dense; 2.5 to 8 in real CTs
  const bool has_cortex =
      entry_cortex_g_cm3_ >= std::min(kCortexOverCancellous * rules_.cancellous_g_cm3, rules_.cortical_g_cm3);
  below_.update(tip.depth_mm, !has_cortex || tip.density_g_cm3 < level_g_cm3);
  // At the surface CT numbers rise over the width of the CT's blur: bone does not begin as cortex at once.
  const double since_mm = std::max(below_.since_mm, begin_mm_);
  if (!below_.is_on) return;
  if (!enter(DrillState::cancellous, since_mm, has_cortex ? rules_.hold_mm : rules_.no_cortex_mm)) return;
  // What is left of the entry's cortex is dense as well, but not rising.
  rising_ = cortical_ = {true, begin_mm_};
}

void StateRecogniser::learn_cancellous(const TipMeets& tip, double way_mm) noexcept {
  constexpr double kOverMm = 5.0;
  learned_mm_ = std::min(learned_mm_ + way_mm, kOverMm);
  if (learned_mm_ > 0.0) cancellous_g_cm3_ += way_mm / learned_mm_ * (tip.density_g_cm3 - cancellous_g_cm3_);
}

/// From cancellous bone into the far cortex, which there is where little bone is left ahead.
void StateRecogniser::approach_far_side(const TipMeets& tip) noexcept {
  const bool is_known = !std::isnan(tip.ahead_mm);
  const bool is_near = !is_known || tip.ahead_mm < rules_.near_mm;
  const double least_g_cm3 = is_known ? rules_.rise * cancellous_g_cm3_ : rules_.cortical_g_cm3;
  far_cortex_g_cm3_ = is_near ? std::max(far_cortex_g_cm3_, tip.density_g_cm3) : 0.0;
  cortical_.update(tip.depth_mm, is_near && tip.density_g_cm3 >= least_g_cm3);
  rising_.update(tip.depth_mm, is_near && tip.density_g_cm3 >= 0.5 * (cancellous_g_cm3_ + least_g_cm3));
  if (!is_known) {
    if (cortical_.is_on && cortical_.since_mm > begin_mm_ &&
        enter(DrillState::inner_cortical, cortical_.since_mm, rules_.hold_mm))
      return;
  } else if (far_cortex_g_cm3_ >= least_g_cm3) {
    // How dense that cortex is, and that it was no strut, is known where the bone ends.
    constexpr double kEndMm = 0.5;
    if (tip.ahead_mm < kEndMm) {
      const double since_mm = trace_.rose_over_mm(0.5 * (cancellous_g_cm3_ + far_cortex_g_cm3_), rules_.hold_mm);
      if (enter(DrillState::inner_cortical, std::max(begin_mm_, since_mm), rules_.hold_mm)) return;
    }
  }
  if (state_ == DrillState::cancellous) {
    if (rising_.is_on && rising_.since_mm > begin_mm_) {
      enter(DrillState::transitional, rising_.since_mm, rules_.hold_mm);
    }
  } else if (!rising_.is_on) {
    enter(DrillState::cancellous, rising_.since_mm, rules_.hold_mm);
  }
}

DrillState StateRecogniser::update(const TipMeets& tip) noexcept {
  // The hole behind the deepest tip tells nothing any more. A density that is not a number is none.
  if (!(tip.depth_mm > deepest_mm_) || !std::isfinite(tip.depth_mm)) return state_;
  const double way_mm = std::isfinite(deepest_mm_) ? tip.depth_mm - deepest_mm_ : 0.0;
  deepest_mm_ = tip.depth_mm;
  TipMeets is = tip;
  if (!std::isfinite(is.density_g_cm3)) is.density_g_cm3 = 0.0;
  trace_.add(is.depth_mm, is.density_g_cm3);
  contact_.update(is.depth_mm, is.density_g_cm3 >= rules_.contact_g_cm3);
  switch (state_) {
    case DrillState::initial:
      if (contact_.is_on && enter(DrillState::outer_cortical, contact_.since_mm, rules_.hold_mm)) {
        below_ = {true, begin_mm_};
      }
      break;
    case DrillState::outer_cortical:
      leave_entry(is);
      break;
    case DrillState::cancellous:
      approach_far_side(is);
      // The far cortex does not count as cancellous bone.
      if (!(tip.ahead_mm < rules_.near_mm) && !rising_.is_on) learn_cancellous(is, way_mm);
      break;
    case DrillState::transitional:
      approach_far_side(is);
      break;
    case DrillState::inner_cortical:
      break;
  }
  return state_;
}

}  // namespace spinaltap
