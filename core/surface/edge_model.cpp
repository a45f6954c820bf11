#include "core/surface/edge_model.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace spinaltap {
namespace {

/// Mean square of what the model leaves, HU²; profiles that it does not describe count as a large miss. A cortex that
/// is thin everywhere tells thickness times density, hardly either of them: there what is usual for a cortex decides.
double misfit(std::span<const EdgeProfile> profiles, const EdgeModel& model, const GridGeometry& geometry,
              double reach_mm) {
  constexpr double kLargeMissHu = 150.0;
  constexpr double kUsualHu = 1250.0;  // compact bone of vertebrae
  std::vector<double> squares(profiles.size());
  tbb::parallel_for(std::size_t{0}, profiles.size(), [&](std::size_t i) {
    const std::optional<EdgeFit> fit = fit_edge(profiles[i], model, geometry, reach_mm);
    squares[i] = std::pow(fit ? std::min(fit->rms_hu, kLargeMissHu) : kLargeMissHu, 2);
  });
  double sum = 0.0;  // in order: the same at any thread count
  for (const double square : squares) sum += square;
  const double unusual = std::log(model.cortex_hu / kUsualHu);
  return sum / static_cast<double>(profiles.size()) * (1.0 + unusual * unusual);
}

}  // namespace

EdgeModel estimate_edge_model(std::span<const EdgeProfile> profiles, const GridGeometry& geometry, double reach_mm) {
  constexpr std::size_t kMost = 1000;
  constexpr int kRounds = 6;
  constexpr double kLowestHu = 600.0, kHighestHu = 2400.0;
  EdgeModel model;
  model.blur_in_slice_mm = std::max(geometry.spacing_mm.x(), geometry.spacing_mm.y());
  model.blur_across_mm = geometry.spacing_mm.z();
  const double smallest_mm = 0.3 * geometry.spacing_mm.minCoeff();
  const double largest_mm = 3.0 * geometry.spacing_mm.maxCoeff();
  std::vector<EdgeProfile> some;
  for (std::size_t i = 0; i < profiles.size(); i += std::max<std::size_t>(1, profiles.size() / kMost)) {
    if (fit_edge(profiles[i], model, geometry, reach_mm)) some.push_back(profiles[i]);
  }
  if (some.empty()) return model;
  double best = misfit(some, model, geometry, reach_mm);
  double step = 1.3;
  for (int round = 0; round < kRounds; ++round, step = 1.0 + 0.6 * (step - 1.0)) {
    for (double EdgeModel::*const number :
         {&EdgeModel::blur_in_slice_mm, &EdgeModel::blur_across_mm, &EdgeModel::cortex_hu}) {
      const bool is_density = number == &EdgeModel::cortex_hu;
      const double factor = is_density ? 1.0 + 0.5 * (step - 1.0) : step;
      for (const double change : {factor, 1.0 / factor}) {
        constexpr int kMostMoves = 4;
        for (int move = 0; move < kMostMoves; ++move) {
          EdgeModel next = model;
          next.*number = std::clamp(next.*number * change, is_density ? kLowestHu : smallest_mm,
                                    is_density ? kHighestHu : largest_mm);
          const double squares = misfit(some, next, geometry, reach_mm);
          if (!(squares < best)) break;
          best = squares;
          model = next;
        }
      }
    }
  }
  return model;
}

}  // namespace spinaltap
