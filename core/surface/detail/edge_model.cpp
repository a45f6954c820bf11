#include "core/surface/detail/edge_model.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace spinaltap {
namespace {

/// Mean square of what the model leaves of all profiles but the worst tenth, HU²: those bend too much, or belong to two
/// bones, and whether they are described at all would decide. What the model does not describe counts as a large miss.
/// Densities far from those of vertebrae need better evidence.
double misfit(std::span<const EdgeProfile> profiles, const EdgeModel& model, const GridGeometry& geometry,
              double reach_mm) {
  constexpr double kLargeMissHu = 150.0;
  constexpr double kUsualHu = 1250.0;  // compact bone of vertebrae
  constexpr std::size_t kWorstTenth = 10;
  std::vector<double> squares(profiles.size());
  tbb::parallel_for(std::size_t{0}, profiles.size(), [&](std::size_t i) {
    const std::optional<EdgeFit> fit = fit_edge(profiles[i], model, geometry, reach_mm);
    squares[i] = std::pow(fit ? std::min(fit->rms_hu, kLargeMissHu) : kLargeMissHu, 2);
  });
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / kWorstTenth);
  double sum = 0.0;  // in order: the same at any thread count
  for (const double square : squares) sum += square;
  const double unusual = std::log(model.cortex_hu / kUsualHu);
  return sum / static_cast<double>(squares.size()) * (1.0 + unusual * unusual);
}

}  // namespace

EdgeModel estimate_edge_model(std::span<const EdgeProfile> profiles, const GridGeometry& geometry, double reach_mm) {
  constexpr std::size_t kMax = 1000;
  constexpr double kLowestHu = 600.0, kHighestHu = 2400.0;
  EdgeModel model;
  model.blur_in_slice_mm = std::max(geometry.spacing_mm.x(), geometry.spacing_mm.y());
  model.blur_across_mm = geometry.spacing_mm.z();
  const double smallest_mm = 0.3 * geometry.spacing_mm.minCoeff();
  const double largest_mm = 3.0 * geometry.spacing_mm.maxCoeff();
  std::vector<EdgeProfile> some;
  for (std::size_t i = 0; i < profiles.size(); i += std::max<std::size_t>(1, profiles.size() / kMax)) {
    if (fit_edge(profiles[i], model, geometry, reach_mm)) some.push_back(profiles[i]);
  }
  if (some.empty()) return model;
  // Hooke & Jeeves 1961, "Direct search", in the logarithms of the three numbers. More blur and a denser cortex look
  // much alike: the moves along what has helped follow that valley, which moves along single numbers do not.
  using Logs = Eigen::Array3d;
  const Logs lowest = Logs(smallest_mm, smallest_mm, kLowestHu).log();
  const Logs highest = Logs(largest_mm, largest_mm, kHighestHu).log();
  const auto model_of = [&](const Logs& logs) {
    const Logs numbers = logs.max(lowest).min(highest).exp();
    return EdgeModel{numbers[0], numbers[1], numbers[2]};
  };
  struct Place {
    Logs logs;
    double misfit;
  };
  const auto look_at = [&](const Logs& logs) {
    return Place{logs.max(lowest).min(highest), misfit(some, model_of(logs), geometry, reach_mm)};
  };
  const auto better_around = [&](Place place, const Logs& step) {
    for (int number = 0; number < 3; ++number) {
      for (const double side : {1.0, -1.0}) {
        Logs next = place.logs;
        next[number] += side * step[number];
        const Place found = look_at(next);
        if (!(found.misfit < place.misfit)) continue;
        place = found;
        break;
      }
    }
    return place;
  };
  constexpr double kFirstStep = 0.24;
  constexpr double kLastStep = 0.01;
  Place best = look_at(Logs(model.blur_in_slice_mm, model.blur_across_mm, model.cortex_hu).log());
  Logs step(kFirstStep, kFirstStep, 0.5 * kFirstStep);
  while (step[0] > kLastStep) {
    const Place before = best;
    best = better_around(best, step);
    if (!(best.misfit < before.misfit)) {
      step *= 0.5;
      continue;
    }
    for (Place from = before;;) {
      const Place ahead = better_around(look_at(2.0 * best.logs - from.logs), step);
      if (!(ahead.misfit < best.misfit)) break;
      from = best;
      best = ahead;
    }
  }
  model = model_of(best.logs);
  return model;
}

}  // namespace spinaltap
