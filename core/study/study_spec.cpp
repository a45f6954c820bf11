#include "core/study/study_spec.h"

#include <limits>

namespace spinaltap {

FactorValues base_values(const StudySpec& spec) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool pushes = spec.tool_operator.kind == StudyOperator::Kind::push;
  FactorValues values{};
  const auto set = [&](StudyFactor factor, double value) { values.at(static_cast<std::size_t>(factor)) = value; };
  set(StudyFactor::bit_diameter_mm, spec.path.bit.diameter_mm);
  set(StudyFactor::push_n, pushes ? spec.tool_operator.push_n : kNone);
  set(StudyFactor::feed_mm_s, pushes ? kNone : spec.tool_operator.feed_mm_s);
  set(StudyFactor::tremor_mm, spec.tool_operator.tremor_mm);
  set(StudyFactor::density_scale, 1.0);
  set(StudyFactor::force_scale, 1.0);
  return values;
}

}  // namespace spinaltap
