#include "core/grading/detail/instrument_body.h"

#include <optional>

#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

InstrumentBody body_behind(const DrillPath& path, InstrumentPart part, const BodyBehind& body) {
  return {part, BitProfile(body.outline), (body.pose.tip_mm - path.entry_mm).dot(path.direction())};
}

}  // namespace

std::vector<InstrumentBody> instrument_bodies(const DrillPath& path, double opening_mm) {
  constexpr double kWayInMm = 60.0;  // beyond it nothing of a vertebra lies
  constexpr double kBluntMm = 1e-3;
  std::vector<InstrumentBody> bodies;
  const DrillBit tool = path.screw ? path.screw->outline() : path.bit;
  const DrillBit way_in{tool.diameter_mm, kWayInMm, kBluntMm, BitShape::tapered_screw, tool.diameter_mm};
  bodies.push_back({InstrumentPart::way_in, BitProfile(way_in), -opening_mm});
  const auto add = [&](InstrumentPart part, const std::optional<BodyBehind>& behind) {
    if (behind) bodies.push_back(body_behind(path, part, *behind));
  };
  add(InstrumentPart::head, head_of(path));
  add(InstrumentPart::driver, driver_of(path));
  return bodies;
}

InstrumentBody screw_body(const DrillPath& path) {
  return {InstrumentPart::tool, BitProfile(path.screw.value().outline()), path.length_mm()};
}

InstrumentBody screw_head(const DrillPath& path) {
  return body_behind(path, InstrumentPart::head, head_of(path).value());
}

PathLine::PathLine(const DrillPath& path) : entry_mm_(path.entry_mm), direction_(PathCurve(path).direction_at(0.0)) {}

}  // namespace spinaltap
