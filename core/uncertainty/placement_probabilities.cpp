#include "core/uncertainty/placement_probabilities.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/grading/fast_breach.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

void check_probability_options(const ProbabilityOptions& options) {
  constexpr int kMax = 1 << 24;
  if (options.draws < 1 || options.draws > kMax) {
    fail("probabilities of grades: expected 1 to ", kMax, " draws, found ", options.draws);
  }
}

std::vector<double> lattice_of(double max, double step, const char* what) {
  constexpr double kMost = 200.0;
  if (!(max > 0.0 && step > 0.0 && std::isfinite(max) && max / step <= kMost)) {
    fail("breach map: expected ", what, " above 0, with at most ", kMost, " steps to each side, found ", max, " by ",
         step);
  }
  const int steps = static_cast<int>(std::floor(max / step + 1e-9));
  std::vector<double> errors;
  for (int n = -steps; n <= steps; ++n) errors.push_back(n * step);
  return errors;
}

Probability probability_of(std::size_t met, std::size_t draws) {
  return {static_cast<double>(met) / static_cast<double>(draws), wilson_interval(met, draws)};
}

}  // namespace

GradeProbabilities grade_probabilities(const WallDistance& walls, const DrillPath& path, const PlacementErrors& errors,
                                       const ProbabilityOptions& options, const Progress& progress) {
  check_errors(errors);
  check_path(path);
  check_turns(path.bit, "errors of placement");
  breach_mm(walls, path, options.grade);  // rejects options without sense
  const ErrorFrame frame = error_frame(walls.landmarks(), path);
  return grade_probabilities(
      walls, [&](std::uint32_t index) { return erred_path(path, frame, draw_error(errors, options.seed, index)); },
      options, progress);
}

GradeProbabilities grade_probabilities(const WallDistance& walls, const ErredPath& erred,
                                       const ProbabilityOptions& options, const Progress& progress) {
  check_probability_options(options);
  const BreachField field(walls, options.grade);
  const auto draws = static_cast<std::size_t>(options.draws);
  std::vector<double> breaches_mm(draws);
  std::vector<std::uint8_t> into_canal(draws, 0);
  ProgressCounter counter(progress, "grading erred paths", draws);
  tbb::parallel_for(std::size_t{0}, draws, [&](std::size_t n) {
    const FoundBreaches found = FastBreach(field, erred(static_cast<std::uint32_t>(n))).find();
    breaches_mm[n] = found.larger().breach_mm;
    into_canal[n] = found.canal.breach_mm > 0.0 ? 1 : 0;
    counter.add();
  });

  GradeProbabilities probabilities;
  probabilities.draws = options.draws;
  probabilities.seed = options.seed;
  std::array<std::size_t, 5> met{};
  std::size_t canal = 0;
  double sum_mm = 0.0;
  for (std::size_t n = 0; n < draws; ++n) {
    ++met[static_cast<std::size_t>(gertzbein_robbins(breaches_mm[n]))];
    canal += into_canal[n];
    sum_mm += breaches_mm[n];
  }
  for (std::size_t n = 0; n < met.size(); ++n) probabilities.grades[n] = probability_of(met[n], draws);
  probabilities.acceptable = probability_of(met[0] + met[1], draws);
  probabilities.canal = probability_of(canal, draws);
  probabilities.mean_breach_mm = sum_mm / static_cast<double>(draws);
  std::sort(breaches_mm.begin(), breaches_mm.end());
  probabilities.p95_breach_mm = quantile(breaches_mm, 0.95);
  return probabilities;
}

BreachMap breach_map(const WallDistance& walls, const DrillPath& path, const BreachMapOptions& options,
                     const Progress& progress) {
  check_turns(path.bit, "errors of placement");
  breach_mm(walls, path, options.grade);  // rejects paths and options without sense
  BreachMap map;
  map.shift_mm.errors = lattice_of(options.max_shift_mm, options.shift_step_mm, "shifts (mm)");
  map.turn_deg.errors = lattice_of(options.max_turn_deg, options.turn_step_deg, "turns (degrees)");
  const ErrorFrame frame = error_frame(walls.landmarks(), path);
  const std::size_t shifts = map.shift_mm.errors.size() * map.shift_mm.errors.size();
  const std::size_t turns = map.turn_deg.errors.size() * map.turn_deg.errors.size();
  map.shift_mm.breach_mm.resize(shifts);
  map.turn_deg.breach_mm.resize(turns);
  const BreachField field(walls, options.grade);
  ProgressCounter counter(progress, "mapping breaches", shifts + turns);
  tbb::parallel_for(std::size_t{0}, shifts + turns, [&](std::size_t n) {
    const bool is_shift = n < shifts;
    BreachLattice& lattice = is_shift ? map.shift_mm : map.turn_deg;
    const std::size_t place = is_shift ? n : n - shifts;
    const double medial = lattice.errors[place % lattice.errors.size()];
    const double cranial = lattice.errors[place / lattice.errors.size()];
    const PlacementError error =
        is_shift ? PlacementError{medial, cranial, 0.0, 0.0, 0.0} : PlacementError{0.0, 0.0, 0.0, medial, cranial};
    FastBreach fast(field, erred_path(path, frame, error));
    const double breach_mm = fast.find().larger().breach_mm;
    lattice.breach_mm[place] = breach_mm > 0.0 ? breach_mm : -fast.clearance_mm();
    counter.add();
  });
  return map;
}

}  // namespace spinaltap
