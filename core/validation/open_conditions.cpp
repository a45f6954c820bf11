#include "core/validation/open_conditions.h"

#include <cmath>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/base/quasi_random.h"

namespace spinaltap {
namespace {

double evenly(const MeasuredRange& range, double share) { return lerp(range.low, range.high, share); }

double by_logarithm(const MeasuredRange& range, double share) {
  return range.low == range.high ? range.low : std::exp(lerp(std::log(range.low), std::log(range.high), share));
}

MeasuredRange range_of(const std::optional<double>& stated, const MeasuredRange& open) {
  return stated ? MeasuredRange{*stated, *stated} : open;
}

MeasuredRange densities_of(const DrillingMeasurement& row, const OpenConditions& open) {
  switch (row.tissue) {
    case MeasuredTissue::cortical:
      return range_of(row.density_g_cm3, open.cortical_g_cm3);
    case MeasuredTissue::cancellous:
      return range_of(row.density_g_cm3, open.cancellous_g_cm3);
    case MeasuredTissue::vertebra:
      return range_of(row.density_g_cm3, open.vertebra_g_cm3);
    default:
      return range_of(row.density_g_cm3, open.bone_g_cm3);
  }
}

}  // namespace

std::string why_not_predicted(const DrillingMeasurement& row) {
  if (row.process == MeasuredProcess::awl) return "an awl does not cut";
  if (row.process == MeasuredProcess::ultrasonic) return "ultrasonic, not drilled alone";
  const bool is_made = row.tissue == MeasuredTissue::artificial || row.tissue == MeasuredTissue::foam;
  if (is_made && !row.density_g_cm3) return "made for tests, its density is not stated";
  return {};
}

std::vector<DrillingCondition> conditions_of(const DrillingMeasurement& row, const OpenConditions& open) {
  if (const std::string why = why_not_predicted(row); !why.empty()) fail("measurement of ", row.source, ": ", why);
  const MeasuredRange densities_g_cm3 = densities_of(row, open);
  const MeasuredRange diameters_mm = range_of(row.diameter_mm, open.diameter_mm);
  const MeasuredRange speeds_rpm = row.rpm.value_or(open.rpm),
                      feeds_mm_min = row.feed_mm_min.value_or(open.feed_mm_min);
  std::vector<DrillingCondition> conditions;
  for (int n = 0; n < open.samples; ++n) {
    int dimension = 0;
    const auto next = [&] { return sobol_uniform(open.seed, static_cast<std::uint32_t>(n), dimension++); };
    DrillingCondition one;
    one.density_g_cm3 = by_logarithm(densities_g_cm3, next());
    const double feed_mm_min = by_logarithm(feeds_mm_min, next());
    const double diameter_mm = by_logarithm(diameters_mm, next());
    one.rpm = by_logarithm(speeds_rpm, next());
    one.feed_mm_per_turn = feed_mm_min / one.rpm;
    const double web_mm = row.web_mm.value_or(by_logarithm(open.web_share, next()) * diameter_mm);
    const double wear_mm = evenly(open.wear_mm, next());
    const double point_deg = evenly(range_of(row.point_angle_deg, open.point_angle_deg), next());
    const double helix_deg = evenly(range_of(row.helix_deg, open.helix_deg), next());
    one.depth_mm = evenly(open.depth_mm, next());
    constexpr double kLengthMm = 50.0;
    one.bit = twist_drill(diameter_mm, kLengthMm, point_deg, web_mm);
    one.bit.helix_deg = helix_deg;
    one.bit.wear_mm = wear_mm;
    conditions.push_back(one);
  }
  return conditions;
}

}  // namespace spinaltap
