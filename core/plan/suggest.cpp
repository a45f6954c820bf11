#include "core/plan/suggest.h"

#include <tbb/parallel_for.h>

#include <sstream>

#include "core/base/error.h"
#include "core/plan/detail/way_search.h"

namespace spinaltap {
namespace {

void check_options(std::span<const PedicleScrew> screws, const SuggestOptions& options) {
  if (screws.empty()) fail("suggesting paths: expected one screw or more");
  for (const PedicleScrew& screw : screws) check_screw(screw);
  check_bit(options.bit);
  const auto within = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("suggesting paths: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  within(options.margin_mm, 0.0, 5.0, "a margin around the screw (mm)");
  within(options.front_margin_mm, 0.0, 30.0, "a margin ahead of the tip (mm)");
  within(options.widest_share, 0.1, 1.0, "a share of the pedicle's width");
  within(options.furthest_share, 0.2, 1.0, "a share of the body's depth");
  within(options.most_turn_deg, 0.0, 45.0, "a turn from the pedicle's axis (degrees)");
  const SuggestWeights& weights = options.weights;
  for (const double weight : {weights.length, weights.diameter, weights.clearance, weights.canal, weights.endplates,
                              weights.density, weights.along_axis}) {
    within(weight, 0.0, 100.0, "weights");
  }
}

Suggestion suggest_side(const WallDistance& walls, const HuSampler& hu, const Material& material,
                        std::span<const PedicleScrew> screws, const SuggestOptions& options, double side,
                        const Progress& progress) {
  constexpr std::size_t kMostRefined = 6;
  Suggestion suggestion;
  suggestion.side = side > 0.0 ? "left" : "right";
  detail::WaySearch search(walls, hu, screws, options, side);
  const std::vector<detail::ScrewedWay> ways = search.find(kMostRefined, progress);
  for (const detail::ScrewedWay& way : ways) {
    SuggestedPath best;
    best.path = way.path;
    best.grade = grade_path(walls, hu, material, way.path, options.grade);
    if (best.grade.grade != Grade::A) continue;
    best.safe = safe_zone(walls, way.path);
    best.score = way.score;
    best.angles = path_angles(way.path.direction(), walls.landmarks().axes, side > 0.0);
    best.ways_looked_at = search.ways_looked_at();
    suggestion.best = best;
    return suggestion;
  }
  std::ostringstream why;
  why.precision(3);
  why << "no screw of the table keeps " << options.margin_mm << " mm of bone around it on any straight way of "
      << search.ways_looked_at() << " through the " << suggestion.side << " pedicle, which is "
      << search.pedicle().width_mm << " mm wide";
  suggestion.refusal = why.str();
  return suggestion;
}

}  // namespace

std::vector<Suggestion> suggest_paths(const WallDistance& walls, const HuSampler& hu, const Material& material,
                                      std::span<const PedicleScrew> screws, const SuggestOptions& options,
                                      const Progress& progress) {
  check_options(screws, options);
  std::vector<Suggestion> sides(2);
  tbb::parallel_for(0, 2, [&](int n) {
    sides[static_cast<std::size_t>(n)] =
        suggest_side(walls, hu, material, screws, options, n == 0 ? 1.0 : -1.0, progress);
  });
  return sides;
}

}  // namespace spinaltap
