#include "core/study/study_spec.h"

#include <limits>

namespace spinaltap {

FactorValues base_values(const StudySpec& spec) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool pushes = spec.hand.kind == StudyHand::Kind::push;
  FactorValues values{};
  const auto set = [&](StudyFactor factor, double value) { values.at(static_cast<std::size_t>(factor)) = value; };
  set(StudyFactor::bit_diameter_mm, spec.path.bit.diameter_mm);
  set(StudyFactor::push_n, pushes ? spec.hand.push_n : kNone);
  set(StudyFactor::feed_mm_s, pushes ? kNone : spec.hand.feed_mm_s);
  set(StudyFactor::tremor_mm, spec.hand.tremor_mm);
  set(StudyFactor::density_scale, 1.0);
  return values;
}

}  // namespace spinaltap
