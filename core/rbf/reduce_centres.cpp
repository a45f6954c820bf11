#include "core/rbf/reduce_centres.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/rbf/detail/choose_centres.h"
#include "core/rbf/detail/rbf_solver.h"
#include "core/rbf/rbf_field.h"

namespace spinaltap::detail {

ReducedFit reduce_centres(RadialKernel kernel, std::span<const Vec3> points_mm, std::span<const double> values_mm,
                          double tolerance_mm, double accuracy_mm, const Progress& progress) {
  constexpr double kFieldShare = 0.1;
  constexpr double kSafety = 2.5;  // the sums' error anywhere, of that at the places where it was measured
  const std::size_t count = points_mm.size();
  ReducedFit fit;
  fit.centres = first_centres(kernel, points_mm);
  std::vector<bool> is_centre(count, false);
  for (const std::uint32_t i : fit.centres) is_centre[i] = true;
  std::vector<double> difference_mm(count);
  double first_out = 0.0;
  for (std::vector<double> weights;;) {
    ++fit.rounds;
    weights.resize(fit.centres.size(), 0.0);  // new centres start from nothing
    RbfSolver solver(kernel, pick(points_mm, fit.centres));
    RbfSolution solution = solver.solve(pick(values_mm, fit.centres), accuracy_mm, weights);
    fit.iterations += solution.iterations;
    fit.model = std::move(solution.model);
    weights = fit.model.weights;

    const RbfField field = RbfField::for_values(fit.model, kFieldShare * tolerance_mm);
    field.evaluate(points_mm, difference_mm, {});
    const double max_mm = tolerance_mm - kSafety * field.value_error_mm();
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < count; ++i) {
      difference_mm[i] = std::abs(difference_mm[i] - values_mm[i]);
      if (!is_centre[i] && difference_mm[i] > max_mm) out.push_back(i);
    }
    if (fit.rounds == 1) first_out = static_cast<double>(out.size());
    progress.report("reducing centres", out.empty() ? 1.0 : 1.0 - static_cast<double>(out.size()) / (first_out + 1.0));
    if (out.empty()) return fit;
    std::stable_sort(out.begin(), out.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return difference_mm[a] > difference_mm[b]; });
    for (const std::uint32_t i : spread_worst(points_mm, out, fit.centres.size())) {
      fit.centres.push_back(i);
      is_centre[i] = true;
    }
  }
}

ReducedFit reduce_centres_in_slabs(RadialKernel kernel, std::span<const Vec3> points_mm,
                                   std::span<const double> values_mm, std::size_t slabs, double tolerance_mm,
                                   double accuracy_mm, const Progress& progress) {
  std::vector<std::uint32_t> by_height(points_mm.size());
  for (std::uint32_t i = 0; i < by_height.size(); ++i) by_height[i] = i;
  std::stable_sort(by_height.begin(), by_height.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return points_mm[a].z() < points_mm[b].z(); });
  ReducedFit whole;
  for (std::size_t slab = 0; slab < slabs; ++slab) {
    const auto begin = static_cast<std::ptrdiff_t>(by_height.size() * slab / slabs);
    const auto end = static_cast<std::ptrdiff_t>(by_height.size() * (slab + 1) / slabs);
    const std::vector<std::uint32_t> members(by_height.begin() + begin, by_height.begin() + end);
    const ReducedFit part = [&] {
      try {
        return reduce_centres(kernel, pick(points_mm, members), pick(values_mm, members), tolerance_mm, accuracy_mm,
                              progress);
      } catch (const Cancelled&) {
        throw;
      } catch (const Error& error) {
        fail(error.what(), " (in slab ", slab + 1, " of ", slabs, ")");
      }
    }();
    for (const std::uint32_t i : part.centres) whole.centres.push_back(members[i]);
    whole.rounds = std::max(whole.rounds, part.rounds);
    whole.iterations += part.iterations;
  }
  RbfSolver solver(kernel, pick(points_mm, whole.centres));
  RbfSolution solution = solver.solve(pick(values_mm, whole.centres), accuracy_mm, {}, progress);
  whole.iterations += solution.iterations;
  whole.model = std::move(solution.model);
  return whole;
}

}  // namespace spinaltap::detail
