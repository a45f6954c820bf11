#include "vdb/sim/label_warnings.h"

#include <algorithm>
#include <array>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/segment/mask_shape.h"
#include "vdb/sim/bake_levels.h"

namespace spinaltap {
namespace {

/// So that whoever takes the bone looks at it first.
constexpr double kSevere = 0.9;

void add(LevelWarnings& warnings, std::string text) {
  warnings.warnings.push_back(std::move(text));
  warnings.severity = std::max(warnings.severity, kSevere);
}

}  // namespace

// The figures behind these limits: docs/label-maps.md, "Does the map go with the CT?"
LevelWarnings warnings_of_edges(const LabelEdges& edges, double step_mm, Level level) {
  constexpr double kMinOnEdge = 0.42;
  constexpr double kMinOnEdgeOfSacrum = 0.30;  // maps end it where its parts and the hips begin
  constexpr double kClearlyMore = 0.15;
  constexpr std::array<const char*, 3> kTurns{"left to right", "front to back", "top to bottom"};
  LevelWarnings warnings;
  if (edges.places == 0) return warnings;
  const double min_on_edge = level == Level::kSacrum ? kMinOnEdgeOfSacrum : kMinOnEdge;
  Eigen::Index turn = 0;
  const double mirrored = edges.on_edge_mirrored.maxCoeff(&turn);
  if (mirrored >= min_on_edge && mirrored > edges.on_edge + kClearlyMore) {
    add(warnings, joined("the label looks mirrored, ", kTurns[static_cast<std::size_t>(turn)], ": ",
                         percent_text(mirrored), " of its edge would lie on edges of bone, ",
                         percent_text(edges.on_edge), " do as it is; check the map's orientation"));
    return warnings;
  }
  if (!(edges.on_edge >= min_on_edge)) {
    add(warnings, joined("only ", percent_text(edges.on_edge), " of the label's edge lie on edges of bone, expected ",
                         percent_text(min_on_edge),
                         " and more: a map of another CT or patient, or placed far from where it belongs"));
    return warnings;
  }
  const double max_moved_mm = std::max(0.5, 0.1 + 0.4 * step_mm);
  const double moved_mm = edges.moved_mm.norm();
  if (!(moved_mm <= max_moved_mm)) {
    const Vec3& by_mm = edges.moved_mm;
    add(warnings, joined("the label looks moved by ", fixed_text(moved_mm, 1), " mm, (", fixed_text(by_mm.x(), 1), ", ",
                         fixed_text(by_mm.y(), 1), ", ", fixed_text(by_mm.z(), 1),
                         ") patient LPS, from the bone that the CT shows, expected up to ", fixed_text(max_moved_mm, 1),
                         " mm; check the map's place"));
  }
  return warnings;
}

LevelWarnings warnings_of_label(const CtVolume& ct, const BoneMask& mask, Level level,
                                std::span<const std::string> of_place, const Progress& progress) {
  LevelWarnings warnings =
      warnings_of_edges(find_label_edges(ct, mask, progress), ct.geometry.spacing_mm.maxCoeff(), level);
  for (const std::string& warning : of_place) add(warnings, "the label map: " + warning);
  const bool is_vertebra = level != Level::kNone && level != Level::kSacrum;
  for (LevelWarning& one : check_shape(measure_shape(mask), is_vertebra && !reaches_border(mask))) {
    warnings.warnings.push_back("the label: " + std::move(one.text));
    warnings.severity = std::max(warnings.severity, one.severity);
  }
  return warnings;
}

void warn_of_border(const BoneMask& mask, LevelWarnings& warnings) {
  if (!reaches_border(mask)) return;
  add(warnings, "cut by the CT's border: part of it may be missing");
}

}  // namespace spinaltap
