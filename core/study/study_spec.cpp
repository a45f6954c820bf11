#include "core/study/study_spec.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/tool/tool_speed.h"

namespace spinaltap {

std::string_view name_of(StudyKind kind) { return kind == StudyKind::drilling ? "drilling" : "geometry"; }

std::vector<StudyScrew> screws_of(const StudySpec& spec) {
  std::vector<StudyScrew> screws;
  for (std::size_t bone = 0; bone < spec.bones.size(); ++bone) {
    for (std::size_t path = 0; path < spec.bones[bone].paths.size(); ++path) screws.push_back({bone, path});
  }
  return screws;
}

StudyScrew screw_at(const StudySpec& spec, std::size_t n) {
  std::size_t path = n;
  for (std::size_t bone = 0; bone < spec.bones.size(); ++bone) {
    if (path < spec.bones[bone].paths.size()) return {bone, path};
    path -= spec.bones[bone].paths.size();
  }
  fail("study: expected more than ", n, " screws, found ", n - path);
}

StudyGround ground_of(const std::vector<StudyBone>& bones, bool has_errors, std::optional<DrawnPer> registration) {
  StudyGround ground;
  ground.patients.clear();
  for (const StudyBone& bone : bones) ground.patients.insert(ground.patients.end(), bone.paths.size(), bone.patient);
  ground.has_errors = has_errors;
  ground.has_registration = registration.has_value();
  if (registration) ground.registration_per = *registration;
  return ground;
}

StudyGround ground_of(const StudySpec& spec) {
  return ground_of(spec.bones, spec.errors.has_value(),
                   spec.registration ? std::optional(spec.registration->per) : std::nullopt);
}

std::vector<std::string> speed_warnings(const StudySpec& spec) {
  if (spec.kind != StudyKind::drilling) return {};
  std::vector<double> feeds_mm_s;
  if (spec.tool_operator.kind == StudyOperator::Kind::feed) {
    feeds_mm_s.push_back(spec.tool_operator.feed_mm_s);
    for (const FactorDistribution& factor : spec.design.distributions) {
      if (factor.factor != StudyFactor::feed_mm_s) continue;
      feeds_mm_s.insert(feeds_mm_s.end(), factor.levels.begin(), factor.levels.end());
      if (factor.kind == FactorDistribution::Kind::uniform) feeds_mm_s.insert(feeds_mm_s.end(), {factor.a, factor.b});
      if (factor.kind == FactorDistribution::Kind::normal) feeds_mm_s.push_back(factor.a);
    }
  }
  std::vector<std::string> warnings;
  for (const StudyScrew& screw : screws_of(spec)) {
    for (const std::string& line : speed_warnings(path_of(spec, screw).bit, feeds_mm_s, spec.options.spindle.rpm)) {
      if (std::ranges::find(warnings, line) == warnings.end()) warnings.push_back(line);
    }
  }
  return warnings;
}

FactorValues base_values(const StudySpec& spec, const DrillPath& path) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool drills = spec.kind == StudyKind::drilling;
  const bool pushes = spec.tool_operator.kind == StudyOperator::Kind::push;
  FactorValues values{};
  const auto set = [&](StudyFactor factor, bool is_there, double value) {
    values.at(static_cast<std::size_t>(factor)) = is_there ? value : kNone;
  };
  set(StudyFactor::bit_diameter_mm, drills, path.bit.diameter_mm);
  set(StudyFactor::push_n, drills && pushes, spec.tool_operator.push_n);
  set(StudyFactor::feed_mm_s, drills && !pushes, spec.tool_operator.feed_mm_s);
  set(StudyFactor::tremor_mm, drills, spec.tool_operator.tremor_mm);
  set(StudyFactor::density_scale, drills, 1.0);
  set(StudyFactor::force_scale, drills, 1.0);
  set(StudyFactor::entry_error_scale, spec.errors.has_value(), 1.0);
  set(StudyFactor::direction_error_scale, spec.errors.has_value(), 1.0);
  set(StudyFactor::registration_scale, spec.registration.has_value(), 1.0);
  return values;
}

bool applies(const StudySpec& spec, StudyFactor factor) {
  return !std::isnan(base_values(spec, DrillPath{}).at(static_cast<std::size_t>(factor)));
}

}  // namespace spinaltap
